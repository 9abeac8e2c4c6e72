#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/plain_text.h"
#include "common/base/ranges.h"
#include "common/base/result.h"
#include "common/messages/channel.h"
#include "mortise.h"  // generated from mortise.idl

/// The one door between wire values and ours. All that comes in is checked here and trusted behind:
/// finite, in range, known enum values, bounded lengths, ids that are not none. What goes out is
/// clipped to the same bounds (texts) or taken as it is.
namespace mortise {

/// Nothing that people assemble lies further from the origin of the world, mm.
inline constexpr double kMaxCoordinate_mm = kLongest_mm;
/// A quaternion or direction further from unit length than this was not made by us.
inline constexpr double kUnitNormAllowance = 1e-6;
inline constexpr std::size_t kMaxName_bytes =
    kMostName_bytes;                                 ///< names of parts, users, faces, hashes
inline constexpr std::size_t kMaxText_bytes = 1024;  ///< sentences
inline constexpr std::size_t kMaxSequence = 65536;   ///< entries of one sample

// ---- client to server

wire::IncrementBatch to_wire(const IncrementBatch& batch);

/// Of a batch, each with its own refusal at the door; the client is left to the caller, who knows
/// the sender. Fails when the batch as a whole is none: without a user (nobody can be told), empty,
/// too long, or not in rising sequence.
Result<std::vector<ReceivedIncrement>> from_wire(const wire::IncrementBatch& batch);

struct Request {
  enum class Kind : std::uint8_t {
    kUnknown = 0,
    kJoin = 1,
    kLeave = 2,
    kCommand = 3,
    kSnapshot = 4,
    kUpload = 5
  };
  Kind kind = Kind::kUnknown;
  Command command;  ///< kLeave: only the user
  std::uint64_t nonce = 0;
  std::string name, role;
  UploadPiece piece;
};
wire::Request to_wire(const Request& request);
Result<Request> from_wire(const wire::Request& request);

// ---- server to clients

wire::Answers to_wire(std::span<const JoinReply> joins, std::span<const Reply> replies,
                      std::span<const RefusedIncrement> refused,
                      std::span<const Decision> decisions = {},
                      std::span<const StandingChange> standing = {},
                      std::span<const UploadState> uploads = {});
struct Answers {
  std::vector<JoinReply> joins;
  std::vector<Reply> replies;
  std::vector<RefusedIncrement> refused;
  std::vector<Decision> decisions;
  std::vector<StandingChange> standing;
  std::vector<UploadState> uploads;
};
Result<Answers> from_wire(const wire::Answers& answers);
Result<JoinReply> from_wire(const wire::JoinReply& reply);
Result<Reply> from_wire(const wire::Reply& reply);
Result<RefusedIncrement> from_wire(const wire::RefusedIncrement& refused);
Result<UploadState> from_wire(const wire::UploadState& upload);

wire::PartPose to_wire(const PartPose& pose);
Result<PartPose> from_wire(const wire::PartPose& pose);
wire::Ack to_wire(const Ack& ack);
Result<Ack> from_wire(const wire::Ack& ack);
/// One chunk; keyframe is left to the caller, who knows the topic.
Result<PoseBatch> from_wire(const wire::PoseBatch& batch);

wire::Decision to_wire(const Decision& decision);
Result<Decision> from_wire(const wire::Decision& decision);
wire::StandingChange to_wire(const StandingChange& change);
Result<StandingChange> from_wire(const wire::StandingChange& change);

wire::Verdict to_wire(const Verdict& verdict);
Result<Verdict> from_wire(const wire::Verdict& verdict);
wire::ClashEvent to_wire(const ClashEvent& event);
Result<ClashEvent> from_wire(const wire::ClashEvent& event);
/// All events of a batch that are right; malformed counts the others.
std::vector<ClashEvent> events_from_wire(const wire::EventBatch& batch, std::uint64_t& malformed);

wire::PartInfo to_wire(const PartInfo& part);
Result<PartInfo> from_wire(const wire::PartInfo& part);
wire::PartNote to_wire(const PartNote& note);
Result<PartNote> from_wire(const wire::PartNote& note);
wire::Remark to_wire(const Remark& remark);
Result<Remark> from_wire(const wire::Remark& remark);
wire::UserInfo to_wire(const UserInfo& user);
Result<UserInfo> from_wire(const wire::UserInfo& user);
/// One chunk of a snapshot.
Result<Snapshot> from_wire(const wire::Snapshot& chunk);

wire::Feature to_wire(const FeatureInfo& feature);
Result<FeatureInfo> from_wire(const wire::Feature& feature);
Result<FeatureSet> from_wire(const wire::FeatureSet& set);
/// One chunk of a table.
Result<FeatureTable> from_wire(const wire::Features& chunk);

wire::Pulse to_wire(const SessionPulse& pulse, std::uint64_t pose_serial);
Result<SessionPulse> from_wire(const wire::Pulse& pulse);

/// Whether a text may pass: at most `limit` bytes of UTF-8 without control characters.
bool text_ok(const std::string& text, std::size_t limit);

/// First `limit` bytes of a text, made such as may pass: no character is cut, what may not pass is
/// '?' or U+FFFD.
std::string clip(const std::string& text, std::size_t limit);

}  // namespace mortise
