#include "common/io/log/log_file.h"

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "common/io/build_info.h"
#include "common/io/log/log_checkpoint.h"
#include "common/io/log/log_front.h"
#include "common/io/log/log_layout.h"
#include "common/io/log/log_records.h"
#include "common/io/log/output_file.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

// Time between two records of /statistics, on the clock of the log.
constexpr std::uint64_t kStatisticsPeriod_ns = 1'000'000'000;

constexpr const char* kStateSchema =
    "The state of the session after the tick, for the program that wrote it: session_log_format.md";

fs::path unfinished(const fs::path& file) { return file.string() + ".begun"; }

}  // namespace

fs::path next_in_chain(const fs::path& file) {
  std::string stem = file.stem().string();
  std::uint64_t part = 1;
  const std::size_t at = stem.rfind("_p");
  if (at != std::string::npos && at + 2 < stem.size() &&
      std::all_of(stem.begin() + static_cast<std::ptrdiff_t>(at) + 2, stem.end(),
                  [](unsigned char c) { return std::isdigit(c) != 0; })) {
    part = std::strtoull(stem.c_str() + at + 2, nullptr, 10);
    stem.resize(at);
  }
  char number[24];
  std::snprintf(number, sizeof number, "_p%04llu", static_cast<unsigned long long>(part + 1));
  return file.parent_path() / (stem + number + file.extension().string());
}

Result<std::unique_ptr<LogFile>> LogFile::create(const fs::path& file, const LogHeader& header,
                                                 const LogOptions& options) {
  std::error_code error;
  if (fs::exists(file, error))
    return fail(Code::kRuntime, file.string() +
                                    ": cannot create the log: it exists already, choose another "
                                    "name");
  if (is_begun(file) && !OutputFile::is_being_written(unfinished(file)))
    fs::remove(unfinished(file), error);  // of a start that was cut short
  auto mcap = McapWriter::create(unfinished(file), {.profile = log_layout::kProfile,
                                                    .library = "mortise " + engine_version(),
                                                    .compress = options.compress,
                                                    .chunk_bytes = options.chunk_bytes});
  if (!mcap) return mcap.error();
  std::unique_ptr<LogFile> log(new LogFile(std::move(*mcap), file, options.signer));
  log->write_head(header);
  if (Status synced = log->sync(); !synced) return synced.error();
  if (options.named_later) return log;
  if (Status named = log->take_name(); !named) return named.error();
  return log;
}

bool LogFile::is_begun(const fs::path& file) {
  std::error_code error;
  return fs::exists(unfinished(file), error);
}

Status LogFile::take_name() {
  if (named_) return ok();
  if (Status status = name(path_); !status) return status;
  named_ = true;
  return ok();
}

Status LogFile::name(const fs::path& file) {
  std::error_code error;
  fs::rename(unfinished(file), file, error);
  if (error)
    return fail(Code::kRuntime, file.string() + ": cannot create the log: " + error.message());
  return ok();
}

void LogFile::remove_if_unnamed() {
  if (!named_) remove_unnamed(path_);
}

void LogFile::remove_unnamed(const fs::path& file) {
  std::error_code error;
  fs::remove(unfinished(file), error);
}

void LogFile::write_head(const LogHeader& header) {
  using namespace log_layout;
  log_front::write(*mcap_, header);
  if (signer_) mcap_->add_metadata(kSignerMetadata, {{"certificate", signer_->certificate()}});
  const auto binary = [&](const char* topic, std::uint16_t schema = 0) {
    return mcap_->add_channel(topic, kBinary, schema, {{"layout", "session_log_format.md"}});
  };
  const auto json = [&](const char* topic, const char* name, const std::string& schema) {
    return mcap_->add_channel(topic, kJson, mcap_->add_schema(name, "jsonschema", schema));
  };
  decisions_ = binary(kDecisions);
  increments_ = binary(kIncrements);
  poses_ = binary(kPoses);
  ticks_ = binary(kTicks);
  clashes_ = json(kClashes, "mortise.Clash", log_json::clash_schema());
  statistics_ = json(kStatistics, "mortise.Statistics", log_json::statistics_schema());
  gaps_ = json(kGaps, "mortise.Gap", log_json::gap_schema());
  checkpoints_ =
      binary(kCheckpoints, mcap_->add_schema("mortise.Checkpoint", kBinary, kStateSchema));
  totals_ = binary(kTotals);
  if (!header.begin) return add_seal(false);
  if (header.begin->time_ns > 0) set_time(header.begin->time_ns);
  // In two chunks: one that is damaged costs nothing.
  for (int copy = 0; copy < 2; ++copy) {
    write(header.begin->state);
    message(totals_, log_records::encode(header.begin->statistics));
    end_chunk();
  }
}

void LogFile::add_seal(bool is_last) {
  seal_ = mcap_->take_digest();
  std::map<std::string, std::string> seal = {
      {"number", std::to_string(++seals_)}, {"sha256", seal_}, {"last", is_last ? "yes" : "no"}};
  if (signer_) seal["signature"] = signer_->sign(seal_text(seals_, is_last, seal_));
  mcap_->add_seal(log_layout::kSealMetadata, seal);
}

void LogFile::end_chunk() {
  const std::uint32_t chunks = mcap_->chunks_written();
  mcap_->end_chunk();
  if (mcap_->chunks_written() > chunks) add_seal(false);
}

Status LogFile::sync() {
  end_chunk();
  return mcap_->sync();
}

Status LogFile::close(const LogHeader& header) {
  end_chunk();
  log_front::write(*mcap_, header);
  add_seal(true);
  return mcap_->close();
}

void LogFile::write(const std::string& mesh_hash, const TriangleMesh& mesh) {
  mcap_->add_attachment(log_layout::kMeshPrefix + mesh_hash, "application/x-mortise-mesh",
                        log_records::encode(mesh), time_ns_);
}

void LogFile::set_time(std::int64_t time_ns) {
  // A clock that was set back does not turn the log.
  time_ns_ = std::max(time_ns_, static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0)));
  if (!has_time_) statistics_time_ns_ = time_ns_;
  has_time_ = true;
}

void LogFile::write(const TickRecord& tick) {
  if (!tick.decisions.empty())
    message(decisions_, log_records::encode(tick.tick, std::span(tick.decisions)));
  if (!tick.increments.empty())
    message(increments_, log_records::encode(tick.tick, std::span(tick.increments)));
  if (!tick.report.moved.empty())
    message(poses_, log_records::encode(tick.tick, std::span(tick.report.moved)));
  for (const ClashEvent& event : tick.report.events) message(clashes_, log_json::encode(event));
  message(ticks_, log_records::encode_end(tick.report, tick.tick));
  sums_.add(tick.report, tick.step_ns);
  if (time_ns_ - statistics_time_ns_ >= kStatisticsPeriod_ns) write_statistics();
}

void LogFile::write(const Checkpoint& state) { message(checkpoints_, log_records::encode(state)); }

void LogFile::write_gap(const log_json::Gap& gap) { message(gaps_, log_json::encode(gap)); }

void LogFile::write_statistics() {
  if (!sums_.empty()) message(statistics_, sums_.encode());
  sums_ = {};
  statistics_time_ns_ = time_ns_;
}

void LogFile::message(std::uint16_t channel, std::span<const std::byte> data) {
  mcap_->add_message(channel, time_ns_, data);
}
void LogFile::message(std::uint16_t channel, const std::string& text) {
  message(channel, std::as_bytes(std::span(text)));
}

}  // namespace mortise
