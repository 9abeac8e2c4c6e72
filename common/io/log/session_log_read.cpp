#include "common/io/log/session_log_read.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/hash.h"
#include "common/base/in_quotes.h"
#include "common/io/log/log_checkpoint.h"
#include "common/io/log/log_front.h"
#include "common/io/log/log_json.h"
#include "common/io/log/log_layout.h"
#include "common/io/log/log_records.h"
#include "common/io/log/mcap_reader.h"
#include "common/io/log/tick_sequence.h"
#include "common/io/scenario/assembly_parts.h"

namespace mortise {
namespace {

using log_json::Gap;

// A log of this many ticks is four days at 60 a second: more is not a session.
constexpr std::size_t kMostTicks = 20'000'000;

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Adds the whole numbers of one record of /statistics. Other values are skipped: these are sums
// for people, nothing is decided by them.
void add_counts(const nlohmann::json& record, std::map<std::string, std::uint64_t>& sums) {
  if (!record.is_object()) return;
  for (const auto& [name, count] : record.items())
    if (count.is_number_unsigned() && name != "first_tick" && name != "last_tick")
      sums[name] += count.get<std::uint64_t>();
}

}  // namespace

std::int64_t last_time_ns(const SessionLog& log) {
  if (!log.ticks.empty()) return log.ticks.back().time_ns;
  return log.begin ? log.begin->time_ns : 0;
}

std::string cut_off_of(const SessionLog& log) {
  if (log.gaps.empty() || log.gaps.back().until_tick != 0 || !log.gaps.back().was_recorded)
    return {};
  return "ticks after " + std::to_string(log.gaps.back().after_tick) +
         " are missing: " + log.gaps.back().reason;
}

namespace {

/// Puts the records of a log together, tick by tick: a tick is taken when its end record comes.
class LogAssembler {
 public:
  explicit LogAssembler(const LogReading& reading) : reading_(reading) {}
  McapHandler handler() {
    return {.on_message = [this](const auto& c, const auto& m) { message(c, m); },
            .on_attachment = [this](const McapAttachment& a) { attachment(a); },
            .on_metadata = [this](const auto& name, const auto& v) { metadata(name, v); },
            .on_loss = [this](const std::string& what) { loss_in_file(what); },
            .on_stray = [this](const std::string& what) { loss(what); },
            .on_progress = reading_.on_progress};
  }
  Result<SessionLog> finish(const std::string& file, McapScan scan);

 private:
  void message(const McapChannel& channel, const McapMessage& message);
  void attachment(const McapAttachment& attachment);
  void metadata(const std::string& name, const std::map<std::string, std::string>& values);
  void loss(const std::string& what);
  void loss_in_file(const std::string& what);
  void end_tick(log_records::TickEnd end, std::int64_t time_ns, std::uint32_t sequence);
  TickRecord& open(std::uint64_t tick);
  void open_gap(std::string reason);
  void note(const std::string& what);
  void checkpoint(std::span<const std::byte> bytes, std::int64_t time_ns);
  void totals(std::span<const std::byte> bytes);
  std::uint64_t last_tick() const;

  LogReading reading_;
  SessionLog log_;
  std::optional<TickRecord> tick_;  ///< records seen, end not yet
  std::vector<ClashEvent> events_;  ///< of the tick whose end record comes next
  std::optional<LogGap> gap_;       ///< seen, first tick after it not yet
  bool gap_at_front_ = false;       ///< perhaps no tick was lost in it
  std::string format_;
  std::map<std::uint64_t, std::string> mesh_of_part_;
  std::map<std::uint64_t, ImportReport> imports_;
  bool has_session_ = false, has_scenario_ = false;
  std::uint64_t part_told_ = 0;  ///< by the session's record; 0: not told
  std::uint64_t bad_records_ = 0;
  TickSequence sequence_;
};

void LogAssembler::note(const std::string& what) { log_.notes.push_back(what); }

void LogAssembler::open_gap(std::string reason) {
  if (gap_ && !gap_at_front_) return;
  gap_at_front_ = false;
  gap_ = LogGap{last_tick(), 0, std::move(reason)};
}

std::uint64_t LogAssembler::last_tick() const {
  if (!log_.ticks.empty()) return log_.ticks.back().tick;
  return log_.begin ? log_.begin->state.tick : 0;
}

void LogAssembler::loss(const std::string& what) {
  tick_.reset();  // its other half is gone
  events_.clear();
  open_gap(what);
}

// Before the first tick: what the front says stands in the file again, so the log may be whole.
void LogAssembler::loss_in_file(const std::string& what) {
  const bool at_front = (!gap_ || gap_at_front_) && bad_records_ == 0 && log_.ticks.empty() &&
                        !tick_ && events_.empty();
  loss(what);
  gap_at_front_ = at_front;
}

// It stands behind its tick, or at the front of a file. A damaged one is no loss: the ticks are
// still there.
void LogAssembler::checkpoint(std::span<const std::byte> bytes, std::int64_t time_ns) {
  Checkpoint state;
  const std::uint64_t tick = log_.ticks.empty() ? 0 : log_.ticks.back().tick;
  const bool is_begin = log_.ticks.empty() && bad_records_ == 0 && part_told_ != 1;
  if (!log_records::decode(bytes, state, is_begin || reading_.keep_checkpoints > 0) ||
      (!is_begin &&
       (state.tick != tick || state.state_hash != log_.ticks.back().report.state_hash)))
    return note("the checkpoint " +
                (is_begin ? std::string("at the front") : "after tick " + std::to_string(tick)) +
                " is damaged or of another layout, and left out");
  if (is_begin && log_.begin) return;  // it stands there twice
  if (is_begin) {
    if (gap_at_front_) gap_.reset();
    log_.begin = LogBegin{std::move(state), {}, time_ns};
    return;
  }
  log_.checkpoints.push_back(std::move(state));
  if (log_.checkpoints.size() > reading_.keep_checkpoints) {
    Checkpoint& old = log_.checkpoints[log_.checkpoints.size() - 1 - reading_.keep_checkpoints];
    old.bytes = {};
  }
}

void LogAssembler::totals(std::span<const std::byte> bytes) {
  if (!log_.begin || !log_records::decode(bytes, log_.begin->statistics))
    note("the sums of what was before this file are damaged or of another layout, and left out");
}

TickRecord& LogAssembler::open(std::uint64_t tick) {
  if (tick_ && tick_->tick != tick) {
    loss("tick " + std::to_string(tick_->tick) + " has no end record");
  }
  if (!tick_) {
    tick_.emplace();
    tick_->tick = tick;
  }
  return *tick_;
}

void LogAssembler::end_tick(log_records::TickEnd end, std::int64_t time_ns,
                            std::uint32_t sequence) {
  TickRecord& record = open(end.tick);
  if (const std::uint64_t missing = sequence_.missing_before(sequence); missing > 0)
    open_gap(missing_text(missing));
  if (log_.ticks.empty() && log_.chain.part > 1 && !log_.begin)
    open_gap("it goes on from " + log_.chain.previous +
             ", and the state that it begins with is missing or damaged");
  // All records of a tick stand before this one: if it is the first of its kind, none was lost.
  if (gap_at_front_ && sequence == 1) gap_.reset();
  const std::uint64_t before = last_tick();
  const bool follows = end.tick > before && end.tick - before <= kMostIdleTicks;
  if (!follows || log_.ticks.size() >= kMostTicks) {
    open_gap(follows ? "more ticks than a session has"
                     : "tick " + std::to_string(end.tick) + " does not follow tick " +
                           std::to_string(before));
    tick_.reset();
    events_.clear();
    return;
  }
  record.time_ns = time_ns;
  record.report.tick = end.tick;
  record.report.state_hash = end.state_hash;
  record.report.refused = std::move(end.refused);
  record.report.events = std::exchange(events_, {});
  if (gap_) {
    gap_->until_tick = end.tick;
    log_.gaps.push_back(*std::exchange(gap_, {}));
  }
  log_.ticks.push_back(std::move(record));
  tick_.reset();
}

void LogAssembler::message(const McapChannel& channel, const McapMessage& message) {
  using namespace log_layout;
  const auto time_ns =
      static_cast<std::int64_t>(std::min<std::uint64_t>(message.log_time_ns, INT64_MAX));
  const auto take = [&](auto record, auto&& use) {
    if (log_records::decode(message.data, record))
      use(std::move(record));
    else if (++bad_records_; true)
      loss("a record of " + channel.topic + " is not readable");
  };
  if (channel.topic == kDecisions) {
    take(log_records::Decisions{},
         [&](auto r) { open(r.tick).decisions = std::move(r.decisions); });
  } else if (channel.topic == kIncrements) {
    take(log_records::Increments{},
         [&](auto r) { open(r.tick).increments = std::move(r.increments); });
  } else if (channel.topic == kPoses) {
    take(log_records::Poses{}, [&](auto r) { open(r.tick).report.moved = std::move(r.poses); });
  } else if (channel.topic == kTicks) {
    take(log_records::TickEnd{},
         [&](auto r) { end_tick(std::move(r), time_ns, message.sequence); });
  } else if (channel.topic == kClashes) {
    ClashEvent event;
    if (log_json::decode(text_of(message.data), event))
      events_.push_back(std::move(event));
    else if (++bad_records_; true)
      loss("a record of " + channel.topic + " is not readable");
  } else if (channel.topic == kStatistics) {
    add_counts(nlohmann::json::parse(text_of(message.data), nullptr, false), log_.counted);
    if (log_json::TickTimes times; log_json::decode(text_of(message.data), times))
      log_.times.push_back(times);
  } else if (channel.topic == kCheckpoints) {
    checkpoint(message.data, time_ns);
  } else if (channel.topic == kTotals) {
    totals(message.data);
  } else if (channel.topic == kGaps) {
    Gap gap;
    const bool is_read = log_json::decode(text_of(message.data), gap);
    open_gap(is_read && gap.ticks == 0 ? gap.reason  // not known how many
             : is_read                 ? std::to_string(gap.ticks) + " ticks from " +
                             std::to_string(gap.first_tick) + " on were not recorded: " + gap.reason
                       : "a gap that does not say why");
  }
}

void LogAssembler::attachment(const McapAttachment& attachment) {
  using namespace log_layout;
  const std::string& name = attachment.name;
  if (name == kScenarioAttachment && !has_scenario_) {
    log_.scenario_yaml = text_of(attachment.data);
    has_scenario_ = true;
  } else if (name.starts_with(kMeshPrefix)) {
    const std::string hash = name.substr(std::string_view(kMeshPrefix).size());
    if (std::ranges::find(log_.meshes, hash, [](const auto& m) { return m.first; }) !=
        log_.meshes.end())
      return;
    TriangleMesh mesh;
    if (!log_records::decode(attachment.data, mesh) || mesh_hash(mesh) != hash)
      note("mesh " + hash + " is damaged and left out");
    else
      log_.meshes.emplace_back(hash, std::move(mesh));
  } else if (name.starts_with(kAssemblyPrefix)) {
    const std::string hash = name.substr(std::string_view(kAssemblyPrefix).size());
    if (content_hash(attachment.data) != hash)
      note("the assembly is damaged and left out");
    else
      log_.assembly.assign(attachment.data.begin(), attachment.data.end());
  } else if (name.starts_with(kImportPrefix)) {
    const std::uint64_t part =
        std::strtoull(name.c_str() + std::string_view(kImportPrefix).size(), nullptr, 10);
    if (!log_json::decode(text_of(attachment.data), imports_[part]))
      note("import report of part " + std::to_string(part) + " is damaged");
  }
}

void LogAssembler::metadata(const std::string& name,
                            const std::map<std::string, std::string>& values) {
  const auto value = [&](const std::string& key) {
    const auto found = values.find(key);
    return found == values.end() ? std::string() : found->second;
  };
  if (name == log_layout::kSealMetadata) {
    log_.last_seal = value("sha256");
    return;
  }
  if (!log_front::is_whole(values)) return note("the record " + name + " is damaged and left out");
  if (name == log_layout::kSessionMetadata) {
    has_session_ = true;
    part_told_ = std::strtoull(value("part").c_str(), nullptr, 10);
    format_ = value("format");
    log_.session = value("session");
    log_.scenario_name = value("scenario_name");
    constexpr std::string_view kPart = "mesh_of_part/";
    for (const auto& [key, hash] : values)
      if (key.starts_with(kPart))
        mesh_of_part_[std::strtoull(key.c_str() + kPart.size(), nullptr, 10)] = hash;
  } else if (name == log_layout::kChainMetadata) {
    log_.chain.previous = value("previous");
    log_.chain.part = std::strtoull(value("part").c_str(), nullptr, 10);
    log_.chain.previous_seal = value("previous_seal");
  } else if (name == log_layout::kBuildMetadata) {
    log_.engine_version = value("engine_version");
    log_.build_fingerprint = value("fingerprint");
  }
}

// Values by id 1, 2, 3 ... as a list; anything else is no list.
template <class Value>
bool as_list(std::map<std::uint64_t, Value>& values, std::vector<Value>& list) {
  std::uint64_t expected = 1;
  for (auto& [id, value] : values) {
    if (id != expected++) return false;
    list.push_back(std::move(value));
  }
  return true;
}

Result<SessionLog> LogAssembler::finish(const std::string& file, McapScan scan) {
  const auto bad = [&](const std::string& what) { return fail(Code::kInvalidInput, file + what); };
  if (scan.profile != log_layout::kProfile && !has_session_)
    return bad(": an MCAP file, but no session log: its profile is " + in_quotes(scan.profile));
  if (!has_session_) return bad(": the record that names the session is missing or damaged");
  if (std::find(std::begin(log_layout::kFormatsRead), std::end(log_layout::kFormatsRead),
                format_) == std::end(log_layout::kFormatsRead))
    return bad(": written in log format " + in_quotes(format_) +
               ", this program reads formats up to " + log_layout::kFormat);
  if (!has_scenario_) return bad(": the scenario is missing or damaged; nothing can be replayed");
  if (!as_list(mesh_of_part_, log_.mesh_of_part) || !as_list(imports_, log_.imports))
    return bad(": the list of parts is damaged");
  log_.complete = scan.complete;
  if (log_.begin && log_.chain.part < 2) {
    log_.chain.part = 2;
    note("it continues another file, and the record that says which one is damaged");
  }
  if (tick_ || !events_.empty())
    open_gap(tick_ ? "tick " + std::to_string(tick_->tick) + " has no end record"
                   : "the last tick has no end record");
  if (const auto stated = scan.stated.find(log_layout::kTicks); stated != scan.stated.end())
    if (const std::uint64_t missing = sequence_.missing_of(stated->second); missing > 0) {
      open_gap(missing_text(missing));
      gap_->was_recorded = true;
    }
  if (gap_) log_.gaps.push_back(*gap_);
  log_.notes.insert(log_.notes.end(), scan.notes.begin(), scan.notes.end());
  if (bad_records_ > 0) note(std::to_string(bad_records_) + " records are not readable");
  return std::move(log_);
}

}  // namespace

std::uint64_t most_idle_ticks(double rate_hz, std::int64_t from_ns, std::int64_t to_ns) {
  // Twice the ten minutes in which a server writes a record whatever its clock says.
  constexpr double kUntold_s = 1200.0;
  constexpr double kDay_s = 86'400.0;  // a longer pause is a damaged number
  const double told_s = (static_cast<double>(to_ns) - static_cast<double>(from_ns)) * 1e-9;
  return static_cast<std::uint64_t>(rate_hz * (std::clamp(told_s, 0.0, kDay_s) + kUntold_s));
}

Result<ScenarioReading> scenario_of(const SessionLog& log) {
  Result<ScenarioReading> reading = read_scenario_text(log.scenario_yaml, log.scenario_name);
  if (!reading || !reading->scenario.assembly) return reading;
  if (log.assembly.empty())
    return fail(Code::kInvalidInput, "the assembly of the scenario is missing from the log");
  add_assembly(*reading, log.assembly);
  return reading;
}

Result<SessionLog> read_session_log(const std::filesystem::path& file, const LogReading& reading) {
  LogAssembler assembler(reading);
  Result<McapScan> scan = scan_mcap(file, assembler.handler());
  if (!scan) return scan.error();
  return assembler.finish(file.string(), std::move(*scan));
}

}  // namespace mortise
