#include "client/web/page_uploads.h"

#include "client/web/tokens.h"
#include "common/messages/names.h"

namespace mortise::web {
namespace {

// The largest file, 128 MB, takes two minutes over a link of 1 MB/s.
constexpr double kTicketHolds_s = 600.0;

}  // namespace

void PageUploads::refuse(Viewer& viewer, std::uint64_t id, Refusal refusal,
                         const std::string& text) {
  viewer.say(text_of({{"type", "upload"},
                      {"id", id},
                      {"state", "refused"},
                      {"refusal", name_of(refusal)},
                      {"text", text}}));
}

void PageUploads::ask(Viewer& viewer, LocalUser user, const UploadWish& wish, double now_s) {
  std::size_t of_page = 0, in_all = 0;
  for (const auto& [text, ticket] : tickets_) {
    of_page += ticket.viewer == &viewer ? 1 : 0;
    in_all += ticket.wish.bytes;
  }
  if (wish.bytes == 0)
    return refuse(viewer, wish.id, Refusal::kUnreadableMesh, "the file is empty");
  if (wish.bytes > limits_.upload_bytes) {
    return refuse(viewer, wish.id, Refusal::kUploadLimit,
                  "a file may have " + std::to_string(limits_.upload_bytes >> 20) + " MB");
  }
  if (of_page >= limits_.uploads_of_page || in_all + wish.bytes > limits_.upload_bytes_in_all) {
    return refuse(viewer, wish.id, Refusal::kUploadLimit,
                  "other files are on their way: try again when they are there");
  }
  const std::string ticket = make_tokens().designer;
  tickets_[ticket] = {&viewer, user, wish, now_s + kTicketHolds_s, false};
  viewer.say(text_of(
      {{"type", "upload"}, {"id", wish.id}, {"state", "open"}, {"path", "upload/" + ticket}}));
}

void PageUploads::leave(Viewer& viewer) {
  std::erase_if(tickets_, [&](const auto& row) { return row.second.viewer == &viewer; });
  std::erase_if(sent_, [&](const auto& row) { return row.second.viewer == &viewer; });
  step_.leave(viewer);
}

void PageUploads::turn(double now_s) {
  std::erase_if(tickets_, [&](const auto& row) {
    if (now_s < row.second.until_s) return false;
    refuse(*row.second.viewer, row.second.wish.id, Refusal::kUploadLimit,
           "the file did not come in time");
    return true;
  });
  step_.turn();
}

std::optional<std::size_t> PageUploads::begin_file(const std::string& ticket) {
  const auto found = tickets_.find(ticket);
  if (found == tickets_.end() || found->second.begun) return std::nullopt;
  found->second.begun = true;
  return found->second.wish.bytes;
}

Status PageUploads::take_file(const std::string& ticket, std::vector<std::byte> bytes) {
  const auto found = tickets_.find(ticket);
  if (found == tickets_.end()) return fail(Code::kInvalidInput, "nobody waits for this file");
  const Ticket taken = std::move(found->second);
  tickets_.erase(found);
  if (step_.takes(taken.wish.name)) {
    step_.begin({taken.viewer, taken.user, taken.wish.id}, taken.wish.name, std::move(bytes));
    return ok();
  }
  const std::uint64_t number =
      client_.upload(taken.user, taken.wish.name, taken.wish.unit_mm, std::move(bytes));
  if (number == 0) {
    refuse(*taken.viewer, taken.wish.id, Refusal::kUnknownUser,
           "not in the session yet, or not any more");
    return fail(Code::kInvalidInput, "its user is not in the session");
  }
  sent_[number] = {taken.viewer, taken.wish.id};
  return ok();
}

void PageUploads::drop_file(const std::string& ticket) {
  const auto found = tickets_.find(ticket);
  if (found == tickets_.end()) return;
  refuse(*found->second.viewer, found->second.wish.id, Refusal::kUploadLimit,
         "the file did not arrive whole");
  tickets_.erase(found);
}

void PageUploads::tell(const std::vector<UploadState>& states) {
  for (const UploadState& state : states) {
    if (step_.tell(state)) continue;
    const auto found = sent_.find(state.upload);
    if (found == sent_.end()) continue;
    const Sent sent = found->second;
    if (state.refusal != Refusal::kNone) {
      refuse(*sent.viewer, sent.id, state.refusal, state.text);
    } else {
      sent.viewer->say(text_of({{"type", "upload"},
                                {"id", sent.id},
                                {"state", state.ready ? "ready" : "sent"},
                                {"received", state.received},
                                {"mesh", state.mesh_hash},
                                {"text", state.text}}));
    }
    if (state.ready || state.refusal != Refusal::kNone) sent_.erase(found);
  }
}

}  // namespace mortise::web
