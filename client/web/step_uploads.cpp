#include "client/web/step_uploads.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <mutex>
#include <thread>
#include <utility>

#include "common/messages/names.h"

namespace mortise::web {
namespace {

constexpr std::size_t kMostFiles = 4;  // of all pages, in memory

std::string ending_of(const std::string& name) {
  std::string ending = std::filesystem::path(name).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

}  // namespace

/// Between the thread that reads and the one that waits for it.
struct StepUploads::Reading {
  std::mutex mutex;
  std::optional<Result<BroughtAssembly>> result;
};

bool StepUploads::takes(const std::string& name) const {
  const std::string ending = ending_of(name);
  return read_ && (ending == ".step" || ending == ".stp");
}

void StepUploads::begin(const Sender& sender, const std::string& name,
                        std::vector<std::byte> bytes) {
  files_.push_back({sender, name, std::move(bytes), nullptr, std::nullopt, {}, 0, false});
  if (files_.size() > kMostFiles)
    return refuse(files_.back(), "other STEP files are being read: try again when they are there");
  tell_parts(files_.back());  // is read
}

void StepUploads::leave(Viewer& viewer) {
  for (File& file : files_)
    if (file.sender.viewer == &viewer) file.ended = true;
}

void StepUploads::turn() {
  // One that is being read is waited for, also where nobody wants it any more: one at a time.
  while (!files_.empty() && files_.front().ended && !files_.front().reading) files_.pop_front();
  if (files_.empty()) return;
  File& file = files_.front();
  if (!file.assembly && !file.reading) return begin_to_read(file);
  if (!file.reading) return;
  std::optional<Result<BroughtAssembly>> result;
  {
    const std::lock_guard lock(file.reading->mutex);
    result = std::move(file.reading->result);
  }
  if (!result) return;
  file.reading.reset();
  if (file.ended) return;
  if (!*result) return refuse(file, result->error().text);
  file.assembly = std::move(**result);
  send_next(file);
}

void StepUploads::begin_to_read(File& file) {
  file.reading = std::make_shared<Reading>();
  std::thread([reading = file.reading, read = read_, name = file.name,
               bytes = std::exchange(file.bytes, {})] {
    Result<BroughtAssembly> result = read(name, bytes);
    const std::lock_guard lock(reading->mutex);
    reading->result = std::move(result);
  }).detach();
}

void StepUploads::send_next(File& file) {
  BroughtAssembly& assembly = *file.assembly;
  tell_parts(file);
  const std::size_t next = file.hashes.size();
  if (next == assembly.meshes.size()) {
    file.ended = true;
    return;
  }
  file.upload = client_.upload(file.sender.user, file.name + ".mmsh", 1.0,
                               std::exchange(assembly.meshes[next], {}));
  if (file.upload == 0) refuse(file, "its sender is not in the session any more");
}

bool StepUploads::tell(const UploadState& state) {
  const auto file = std::ranges::find_if(
      files_, [&](const File& f) { return f.upload == state.upload && f.upload != 0; });
  if (file == files_.end()) return false;
  if (file->ended) return true;
  if (state.refusal != Refusal::kNone) {
    refuse(*file, state.text);
  } else if (state.ready) {
    file->hashes.push_back(state.mesh_hash);
    send_next(*file);
  }
  return true;
}

void StepUploads::refuse(File& file, const std::string& text) {
  if (!file.ended)
    file.sender.viewer->say(text_of({{"type", "upload"},
                                     {"id", file.sender.id},
                                     {"state", "refused"},
                                     {"refusal", name_of(Refusal::kUnreadableMesh)},
                                     {"text", text}}));
  file.ended = true;
}

void StepUploads::tell_parts(const File& file) {
  static const BroughtAssembly kNone;
  const BroughtAssembly& assembly = file.assembly ? *file.assembly : kNone;
  const bool all = file.assembly && file.hashes.size() == assembly.meshes.size();
  Json told = {{"type", "upload"},
               {"id", file.sender.id},
               {"state", all ? "ready" : "parts"},
               {"done", file.hashes.size()},
               {"of", assembly.meshes.size()}};
  if (all) {
    std::string text;
    for (const std::string& note : assembly.notes) text += (text.empty() ? "" : "; ") + note;
    told["text"] = text;
    told["parts"] = Json::array();
    for (const BroughtAssembly::Place& place : assembly.places) {
      const Pose& X = place.X_WP;
      told["parts"].push_back({{"name", place.name},
                               {"mesh", file.hashes[place.mesh]},
                               {"p", {X.p.x(), X.p.y(), X.p.z()}},
                               {"q", {X.q.x(), X.q.y(), X.q.z(), X.q.w()}}});
    }
  }
  file.sender.viewer->say(text_of(told));
}

}  // namespace mortise::web
