#include "client/own_uploads.h"

#include <algorithm>
#include <utility>

#include "common/base/hash.h"

namespace mortise {

std::uint64_t OwnUploads::begin(LocalUser user, const std::string& name, double unit_mm,
                                std::vector<std::byte> bytes) {
  const std::uint64_t number = next_++;
  Upload& upload = uploads_[number];
  upload.user = user;
  upload.name = name;
  upload.hash = content_hash(bytes);
  upload.unit_mm = unit_mm;
  upload.bytes = std::move(bytes);
  send_some(number, upload);
  return number;
}

void OwnUploads::take(const std::vector<UploadState>& states, ClientUpdate& update) {
  for (const UploadState& state : states) {
    if (!users_.owns(state.user)) continue;
    update.uploads.push_back(state);
    const auto found = uploads_.find(state.upload);
    if (found == uploads_.end() || users_.id(found->second.user) != state.user) continue;
    Upload& upload = found->second;
    upload.received = std::max(upload.received, state.received);
    const bool ended = state.refusal != Refusal::kNone || state.ready;
    if (ended) uploads_.erase(found);
  }
}

void OwnUploads::send_what_is_due() {
  for (auto& [number, upload] : uploads_)
    if (users_.state(upload.user) == JoinState::kJoined) send_some(number, upload);
  std::erase_if(uploads_, [&](const auto& entry) {
    return users_.state(entry.second.user) == JoinState::kLeft;
  });
}

void OwnUploads::forget_server() {
  for (auto& [number, upload] : uploads_) upload.sent = upload.received = 0;
}

void OwnUploads::send_some(std::uint64_t number, Upload& upload) {
  while (upload.sent < upload.bytes.size() && upload.sent < upload.received + kUploadAhead_bytes) {
    const std::size_t size = std::min(kUploadPiece_bytes, upload.bytes.size() - upload.sent);
    const auto from = upload.bytes.begin() + static_cast<std::ptrdiff_t>(upload.sent);
    channel_.send(UploadPiece{users_.id(upload.user),
                              number,
                              upload.name,
                              upload.unit_mm,
                              upload.hash,
                              upload.bytes.size(),
                              upload.sent,
                              {from, from + static_cast<std::ptrdiff_t>(size)}});
    upload.sent += size;
  }
}

}  // namespace mortise
