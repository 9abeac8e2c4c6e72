#include "idl/convert.h"

#include <algorithm>

#include "common/base/constants.h"
#include "idl/door.h"

namespace mortise {
bool text_ok(const std::string& text, std::size_t limit) {
  return text.size() <= limit && std::none_of(text.begin(), text.end(), [](char c) {
           const auto byte = static_cast<unsigned char>(c);
           return byte < 0x20 || byte == 0x7f;
         });
}

std::string clip(const std::string& text, std::size_t limit) {
  std::size_t size = std::min(text.size(), limit);
  // A byte 10xxxxxx continues a character: step back to its start.
  while (size > 0 && size < text.size() &&
         (static_cast<unsigned char>(text[size]) & 0xc0) == 0x80) {
    --size;
  }
  std::string out = text.substr(0, size);
  for (char& c : out) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) c = ' ';
  }
  return out;
}

wire::IncrementBatch to_wire(const IncrementBatch& batch) {
  wire::IncrementBatch out;
  out.kept_from(batch.kept_from);
  out.fresh_from(batch.fresh_from);
  for (const auto& [increment, sent_ns] : batch.increments) {
    out.user(increment.user.value);
    wire::Increment& entry = out.increments().emplace_back();
    entry.part(increment.part.value);
    entry.seq(increment.seq);
    entry.sent_ns(sent_ns);
    entry.translation_mm(triple(increment.translation_mm));
    entry.rotation_rad(triple(increment.rotation_rad));
  }
  return out;
}

namespace {

Refusal refusal_of(const wire::Increment& in) {
  const Vec3 translation_mm = vec3(in.translation_mm()), rotation_rad = vec3(in.rotation_rad());
  if (in.part() == 0) return Refusal::kUnknownPart;
  if (in.seq() == 0) return Refusal::kStale;
  if (!translation_mm.allFinite() || !rotation_rad.allFinite()) return Refusal::kNotFinite;
  if (!(rotation_rad.norm() <= kMaxRotationPerTick_rad)) return Refusal::kRotationTooLarge;
  if (!(translation_mm.norm() <= kMaxCoordinate_mm)) return Refusal::kJumpTooLarge;
  return Refusal::kNone;
}

}  // namespace

Result<std::vector<ReceivedIncrement>> from_wire(const wire::IncrementBatch& in) {
  const std::vector<wire::Increment>& entries = in.increments();
  const auto not_rising = [](const wire::Increment& a, const wire::Increment& b) {
    return a.seq() >= b.seq();
  };
  Door door("increments");
  door.need(in.user() != 0, "user");
  door.need(!entries.empty() && entries.size() <= kMaxBatchIncrements, "number");
  door.need(std::adjacent_find(entries.begin(), entries.end(), not_rising) == entries.end(), "seq");
  door.need(entries.empty() || in.kept_from() <= entries.front().seq(), "kept_from");
  if (!door.open()) return door.refusal();
  std::vector<ReceivedIncrement> out;
  out.reserve(entries.size());
  for (const wire::Increment& entry : entries) {
    ReceivedIncrement& r = out.emplace_back();
    r.increment.user = UserId{in.user()};
    r.increment.part = PartId{entry.part()};
    r.increment.seq = entry.seq();
    r.kept_from = in.kept_from();
    r.repeated = entry.seq() < in.fresh_from();
    r.at_door = refusal_of(entry);
    if (r.at_door != Refusal::kNone) continue;
    r.increment.translation_mm = vec3(entry.translation_mm());
    r.increment.rotation_rad = vec3(entry.rotation_rad());
    r.sent_ns = entry.sent_ns();
  }
  return out;
}

wire::Request to_wire(const Request& request) {
  wire::Request out;
  out.kind(static_cast<std::uint8_t>(request.kind));
  out.user(request.command.user.value);
  out.part(request.command.part.value);
  out.seq(request.command.seq);
  out.command(static_cast<std::uint8_t>(request.command.kind));
  out.nonce(request.nonce);
  out.name(clip(request.name, kMaxName_bytes));
  out.role(clip(request.role, kMaxName_bytes));
  out.after(request.command.after);
  details_to_wire(request.command.details, out);
  return out;
}

Result<Request> from_wire(const wire::Request& in) {
  Request request;
  request.kind = static_cast<Request::Kind>(in.kind());
  request.nonce = in.nonce();
  Door door("request");
  switch (request.kind) {
    case Request::Kind::kJoin:
      door.need(!in.name().empty() && text_ok(in.name(), kMaxName_bytes), "name");
      door.need(in.role() == "designer" || in.role() == "observer" || in.role() == "bot", "role");
      break;
    case Request::Kind::kLeave:
      door.need(in.user() != 0, "user");
      break;
    case Request::Kind::kCommand:
      door.need(in.user() != 0, "user");
      door.need(in.command() != 0 && in.command() < kCommandKindCount, "command");
      break;
    case Request::Kind::kSnapshot:
      break;
    default:
      door.need(false, "kind");
  }
  if (!door.open()) return door.refusal();
  if (request.kind == Request::Kind::kJoin) {
    request.name = in.name();
    request.role = in.role();
    return request;
  }
  request.command = {UserId{in.user()}, PartId{in.part()}, in.seq(),
                     static_cast<CommandKind>(in.command())};
  if (request.kind == Request::Kind::kCommand) {
    Result<Details> details = details_from_wire(in);
    if (!details) return details.error();
    request.command.details = std::move(*details);
    request.command.after = in.after();
  }
  return request;
}

Result<JoinReply> from_wire(const wire::JoinReply& in) {
  Door door("join reply");
  door.need(in.refusal() < kRefusalCount, "refusal");
  door.need((in.refusal() == 0) == (in.user() != 0), "user");
  door.name(in.client(), "client");
  door.text(in.text(), "text");
  if (!door.open()) return door.refusal();
  return JoinReply{in.client(), in.nonce(), UserId{in.user()}, static_cast<Refusal>(in.refusal()),
                   in.text()};
}

Result<Reply> from_wire(const wire::Reply& in) {
  Door door("reply");  // of no user: who asked has not joined
  door.need(in.refusal() < kRefusalCount, "refusal");
  door.text(in.text(), "text");
  if (!door.open()) return door.refusal();
  Reply reply;
  reply.user = UserId{in.user()};
  reply.part = PartId{in.part()};
  reply.seq = in.seq();
  reply.refusal = static_cast<Refusal>(in.refusal());
  reply.holder = UserId{in.holder()};
  reply.text = in.text();
  return reply;
}

Result<RefusedIncrement> from_wire(const wire::RefusedIncrement& in) {
  Door door("refused increment");
  door.need(in.reason() < kRefusalCount && in.reason() != 0, "reason");
  if (!door.open()) return door.refusal();
  return RefusedIncrement{UserId{in.user()}, PartId{in.part()}, in.seq(),
                          static_cast<Refusal>(in.reason())};
}

wire::Answers to_wire(std::span<const JoinReply> joins, std::span<const Reply> replies,
                      std::span<const RefusedIncrement> refused,
                      std::span<const Decision> decisions) {
  wire::Answers out;
  for (const Decision& decision : decisions) out.decisions().push_back(to_wire(decision));
  for (const JoinReply& reply : joins) {
    wire::JoinReply& entry = out.joins().emplace_back();
    entry.client(clip(reply.client, kMaxName_bytes));
    entry.nonce(reply.nonce);
    entry.user(reply.user.value);
    entry.refusal(static_cast<std::uint8_t>(reply.refusal));
    entry.text(clip(reply.text, kMaxText_bytes));
  }
  for (const Reply& reply : replies) {
    wire::Reply& entry = out.replies().emplace_back();
    entry.user(reply.user.value);
    entry.part(reply.part.value);
    entry.seq(reply.seq);
    entry.refusal(static_cast<std::uint8_t>(reply.refusal));
    entry.holder(reply.holder.value);
    entry.text(clip(reply.text, kMaxText_bytes));
  }
  for (const RefusedIncrement& refusal : refused) {
    wire::RefusedIncrement& entry = out.refused().emplace_back();
    entry.user(refusal.user.value);
    entry.part(refusal.part.value);
    entry.seq(refusal.seq);
    entry.reason(static_cast<std::uint8_t>(refusal.reason));
  }
  return out;
}

Result<Answers> from_wire(const wire::Answers& in) {
  Answers answers;
  if (Status read = read_all(in.joins(), answers.joins); !read) return read.error();
  if (Status read = read_all(in.replies(), answers.replies); !read) return read.error();
  if (Status read = read_all(in.refused(), answers.refused); !read) return read.error();
  if (Status read = read_all(in.decisions(), answers.decisions); !read) return read.error();
  return answers;
}

}  // namespace mortise
