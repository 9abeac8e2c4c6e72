#include "common/io/log/session_log_recover.h"

#include <set>
#include <utility>

#include "common/io/build_info.h"
#include "common/io/log/log_front.h"
#include "common/io/log/log_json.h"
#include "common/io/log/log_layout.h"
#include "common/io/log/mcap_reader.h"
#include "common/io/log/mcap_writer.h"
#include "common/io/log/replay.h"
#include "common/io/log/session_log_read.h"
#include "common/io/log/tick_sequence.h"

namespace mortise {
namespace {

// A copy record by record: what this program does not know (topics of a later version) survives.
class Copy {
 public:
  /// `read`: the same log. Ticks may be lost before the first one; that damage shows does not say.
  Copy(McapWriter& out, const SessionLog& read)
      : out_(out),
        begins_with_gap_(!read.gaps.empty() &&
                         read.gaps[0].after_tick == (read.begin ? read.begin->state.tick : 0)) {}

  McapHandler handler() {
    return {
        .on_schema = [this](const McapSchema& schema) { add(schema); },
        .on_channel = [this](const McapChannel& channel) { add(channel); },
        .on_message = [this](const McapChannel& channel,
                             const McapMessage& message) { add(channel, message); },
        .on_attachment = [this](const McapAttachment& attachment) { add(attachment); },
        .on_metadata = [this](const std::string& name, const auto& values) { add(name, values); },
        .on_loss = [this](const std::string& reason) { lost(reason); },
        .on_stray = [this](const std::string& reason) { lost(reason); }};
  }

  /// Marks what is missing at the end.
  void end(const McapScan& scan) {
    if (const auto stated = scan.stated.find(log_layout::kTicks); stated != scan.stated.end())
      cut_out(sequence_.missing_of(stated->second));
  }

 private:
  void add(const McapSchema& schema) {
    if (!schemas_.contains(schema.id))
      schemas_[schema.id] =
          out_.add_schema(schema.name, schema.encoding,
                          {reinterpret_cast<const char*>(schema.data.data()), schema.data.size()});
  }

  void add(const McapChannel& channel) {
    const auto schema = schemas_.find(channel.schema);
    const std::uint16_t number =
        out_.add_channel(channel.topic, channel.message_encoding,
                         schema == schemas_.end() ? 0 : schema->second, channel.metadata);
    channels_[channel.id] = number;
    if (channel.topic == log_layout::kGaps) gaps_channel_ = number;
  }

  // The front stands in a log twice, and seals are of the file that they stand in.
  void add(const McapAttachment& attachment) {
    if (!front_.insert(attachment.name).second) return;
    out_.add_attachment(attachment.name, attachment.media_type, attachment.data,
                        attachment.log_time_ns);
  }

  void add(const std::string& name, const log_front::Values& values) {
    if (name == log_layout::kSealMetadata || name == log_layout::kSignerMetadata) return;
    if (log_front::is_whole(values) && front_.insert(name).second) out_.add_metadata(name, values);
  }

  void add(const McapChannel& channel, const McapMessage& message) {
    time_ns_ = message.log_time_ns;
    is_front_ = is_front_ &&
                (channel.topic == log_layout::kCheckpoints || channel.topic == log_layout::kTotals);
    if (!is_front_) mark_gap();
    const bool ends_tick = channel.topic == log_layout::kTicks;
    if (ends_tick) cut_out(sequence_.missing_before(message.sequence));
    is_marked_ = is_marked_ && !ends_tick;
    out_.add_message(channels_[channel.id], time_ns_, message.data);
    if (ends_tick && out_.chunk_is_full()) out_.end_chunk();
  }

  void lost(const std::string& reason) {
    if (is_front_ && !begins_with_gap_) return;
    lost_ = reason;
    if (!is_front_) mark_gap();
  }

  void cut_out(std::uint64_t ticks) {
    if (ticks == 0 || is_marked_) return;
    lost_ = missing_text(ticks);
    mark_gap();
  }

  void mark_gap() {
    if (lost_.empty() || gaps_channel_ == 0) return;
    const std::string gap = log_json::encode(log_json::Gap{.reason = std::exchange(lost_, {})});
    is_marked_ = true;
    out_.add_message(gaps_channel_, time_ns_, std::as_bytes(std::span(gap)));
  }

  McapWriter& out_;
  bool begins_with_gap_;
  bool is_front_ = true;         ///< no record of a tick was there yet
  std::string lost_;             ///< why, until it is marked
  std::set<std::string> front_;  ///< names of what was copied
  std::map<std::uint16_t, std::uint16_t> schemas_, channels_;  // number there -> number here
  std::uint16_t gaps_channel_ = 0;
  std::uint64_t time_ns_ = 0;
  TickSequence sequence_;
  bool is_marked_ = false;  ///< since the last tick
};

// What was written is read as anybody would read it.
Status prove(const std::filesystem::path& file, Recovery& recovery) {
  const Result<SessionLog> log = read_session_log(file);
  if (!log) return log.error();
  if (log->ticks.empty() && !recovery.was_complete)
    return fail(Code::kInvalidInput, "no tick of the session is left");
  const Result<ReplayReport> report = verify(*log, 1);
  if (!report) return report.error();
  recovery.verified_to_tick = report->verified_to_tick;
  recovery.differs = report->difference.has_value();
  recovery.not_verified = report->difference ? "tick " + std::to_string(report->difference->tick) +
                                                   " differs: " + report->difference->what
                                             : report->not_verifiable;
  return ok();
}

}  // namespace

Result<Recovery> recover_session_log(const std::filesystem::path& damaged,
                                     const std::filesystem::path& new_file) {
  Result<SessionLog> readable = read_session_log(damaged);
  if (!readable) {
    const Result<McapScan> of_ours = scan_mcap(damaged, {});
    if (!of_ours || of_ours->profile != log_layout::kProfile) return readable.error();
    return Recovery{.not_replayable = readable.error().text};
  }
  auto created = McapWriter::create(
      new_file, {.profile = log_layout::kProfile, .library = "mortise " + engine_version()});
  if (!created) return created.error();
  McapWriter& out = **created;
  Copy copy(out, *readable);
  const Result<McapScan> scan = scan_mcap(damaged, copy.handler());
  if (!scan) return scan.error();
  copy.end(*scan);

  std::map<std::string, std::string> account = {{"was_complete", scan->complete ? "yes" : "no"},
                                                {"lost_chunks", std::to_string(scan->lost_chunks)}};
  for (std::size_t i = 0; i < readable->notes.size(); ++i)
    account["note/" + std::to_string(i + 1)] = readable->notes[i];
  out.add_metadata(log_layout::kRecoveryMetadata, account);
  if (const Status closed = out.close(); !closed) return closed.error();
  Recovery recovery{.ticks = readable->ticks.size(),
                    .messages = scan->messages,
                    .lost_chunks = scan->lost_chunks,
                    .was_complete = scan->complete,
                    .notes = std::move(readable->notes)};
  const std::string cut_off = cut_off_of(*readable);
  if (const Status whole = prove(new_file, recovery); !whole) {
    std::error_code ignored;
    std::filesystem::remove(new_file, ignored);
    recovery.not_replayable = damaged.string() + ": " + whole.error().text;
  }
  if (recovery.not_verified.empty()) recovery.not_verified = cut_off;
  return recovery;
}

}  // namespace mortise
