#include "common/io/session_log.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "common/io/build_info.h"
#include "common/io/log_json.h"
#include "common/io/log_layout.h"
#include "common/io/log_records.h"
#include "common/io/mcap_writer.h"

namespace mortise {
namespace {

using log_json::Gap;

// Ticks are collected for so long, or until there are so many, before the writer takes them.
constexpr auto kCollect = std::chrono::milliseconds(50);
constexpr std::size_t kWakeTicks = 64;
// Ticks that may stay with the caller while the writer has the queue, which it never has for long.
constexpr std::size_t kMostKeptBack = 16;

// Time between two records of /statistics, on the clock of the log.
constexpr std::uint64_t kStatisticsPeriod_ns = 1'000'000'000;

class FileWriter final : public SessionLogWriter {
 public:
  FileWriter(std::unique_ptr<McapWriter> mcap, const LogHeader& header, const LogOptions& options);
  ~FileWriter() override { static_cast<void>(close()); }

  void record(TickRecord record) override;
  Status flush() override;
  Status close() override;
  std::uint64_t dropped_ticks() const override { return dropped_.load(); }
  std::uint64_t bytes_written() const override { return mcap_->bytes_written(); }
  std::size_t queued_ticks() const override;
  Status status() const override;
  Status begin();

 private:
  struct Item {
    Gap gap_before;  ///< ticks == 0: none
    TickRecord tick;
  };
  void write_header(const LogHeader& header);
  void take_kept_back();
  void queue(TickRecord record);
  void run();
  void write(const Item& item);
  void write(const TickRecord& tick);
  void write_gap(const Gap& gap);
  void write_statistics();
  void message(std::uint16_t channel, std::span<const std::byte> data);
  void message(std::uint16_t channel, const std::string& text);
  void remember_error();
  void settle_chunk();

  // Written by the writer thread alone once it runs.
  std::unique_ptr<McapWriter> mcap_;
  LogOptions options_;
  std::uint16_t decisions_ = 0, increments_ = 0, poses_ = 0, clashes_ = 0, ticks_ = 0,
                statistics_ = 0, gaps_ = 0;
  std::uint64_t time_ns_ = 0, statistics_time_ns_ = 0;
  bool has_time_ = false;
  log_json::CounterSums sums_;
  std::uint64_t ticks_in_chunk_ = 0;  ///< written, but not yet in the file
  std::uint32_t chunks_settled_ = 0;

  mutable std::mutex mutex_;
  std::vector<TickRecord> kept_back_;  ///< of the thread that records
  std::condition_variable wake_;
  std::size_t wake_ticks_ = 1;  ///< as many wake the writer before its time
  std::deque<Item> queue_;
  Gap gap_;  ///< dropped since the last queued tick
  bool closing_ = false;
  std::uint64_t flushes_asked_ = 0, flushes_done_ = 0;
  std::condition_variable flushed_;
  std::optional<Error> error_;
  std::atomic<std::uint64_t> dropped_ = 0;
  std::thread thread_;
};

FileWriter::FileWriter(std::unique_ptr<McapWriter> mcap, const LogHeader& header,
                       const LogOptions& options)
    : mcap_(std::move(mcap)), options_(options) {
  wake_ticks_ = std::clamp<std::size_t>(options.queue_ticks / 2, 1, kWakeTicks);
  write_header(header);
}

void FileWriter::write_header(const LogHeader& header) {
  using namespace log_layout;
  std::map<std::string, std::string> session = {
      {"format", kFormat}, {"session", header.session}, {"scenario_name", header.scenario_name}};
  for (std::size_t i = 0; i < header.mesh_of_part.size(); ++i)
    session["mesh_of_part/" + std::to_string(i + 1)] = header.mesh_of_part[i];
  mcap_->add_metadata(kSessionMetadata, session);
  mcap_->add_metadata(kBuildMetadata, build_info());
  mcap_->add_attachment(kScenarioAttachment, "application/yaml",
                        std::as_bytes(std::span(header.scenario_yaml)), 0);
  for (const auto& [hash, mesh] : header.meshes)
    mcap_->add_attachment(kMeshPrefix + hash, "application/x-mortise-mesh",
                          log_records::encode(*mesh), 0);
  for (std::size_t i = 0; i < header.imports.size(); ++i) {
    const std::string json = log_json::encode(header.imports[i]);
    mcap_->add_attachment(kImportPrefix + std::to_string(i + 1), "application/json",
                          std::as_bytes(std::span(json)), 0);
  }
  const auto binary = [&](const char* topic) {
    return mcap_->add_channel(topic, kBinary, 0, {{"layout", "session_log_format.md"}});
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
}

Status FileWriter::begin() {
  if (Status synced = mcap_->sync(); !synced) return synced.error();
  thread_ = std::thread([this] { run(); });
  return ok();
}

// Never waits: where the writer has the queue, the tick stays with the caller until the next one.
void FileWriter::record(TickRecord record) {
  if (record.tick == 0) record.tick = record.report.tick;
  std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock() && kept_back_.size() < kMostKeptBack) {
    kept_back_.push_back(std::move(record));
    return;
  }
  if (!lock.owns_lock()) lock.lock();
  take_kept_back();
  queue(std::move(record));
}

void FileWriter::take_kept_back() {
  for (TickRecord& record : kept_back_) queue(std::move(record));
  kept_back_.clear();
}

void FileWriter::queue(TickRecord record) {
  if (error_ || closing_ || queue_.size() >= options_.queue_ticks) {
    dropped_.fetch_add(1);
    if (gap_.ticks++ == 0) gap_.first_tick = record.tick;
    gap_.last_tick = record.tick;
    gap_.reason = "the queue to the disk was full";
    return;
  }
  queue_.push_back({std::exchange(gap_, {}), std::move(record)});
  // The writer collects for a while: to wake it in each tick would cost the tick more than all
  // else.
  if (queue_.size() == 1 || queue_.size() == wake_ticks_) wake_.notify_one();
}

void FileWriter::run() {
  using Clock = std::chrono::steady_clock;
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.flush_s));
  auto next_flush = Clock::now() + period;
  bool unflushed = false;
  std::deque<Item> items;
  std::unique_lock lock(mutex_);
  while (true) {
    const auto work = [&] { return closing_ || !queue_.empty() || flushes_asked_ > flushes_done_; };
    if (unflushed)
      wake_.wait_until(lock, next_flush, work);
    else
      wake_.wait(lock, work);
    const auto enough = [&] {
      return closing_ || queue_.size() >= wake_ticks_ || flushes_asked_ > flushes_done_;
    };
    if (!queue_.empty()) {
      const auto collected = Clock::now() + kCollect;
      wake_.wait_until(lock, unflushed ? std::min(collected, next_flush) : collected, enough);
    }
    items.swap(queue_);
    const bool closing = closing_;
    const std::uint64_t flushes = flushes_asked_;
    lock.unlock();
    unflushed = unflushed || !items.empty();
    for (const Item& item : items) write(item);
    items.clear();
    if (unflushed && (Clock::now() >= next_flush || flushes > flushes_done_)) {
      static_cast<void>(mcap_->sync());  // an error sticks and is taken below
      settle_chunk();
      unflushed = false;
      next_flush = Clock::now() + period;
    }
    lock.lock();
    remember_error();
    flushes_done_ = flushes;
    flushed_.notify_all();
    if (closing && queue_.empty()) return;
  }
}

// Ticks that went into a file that can no longer be written are lost like any other.
void FileWriter::remember_error() {
  if (error_ || !mcap_->error()) return;
  error_ = mcap_->error();
  dropped_.fetch_add(queue_.size());
  queue_.clear();
}

void FileWriter::write(const Item& item) {
  if (mcap_->error()) {
    dropped_.fetch_add(1);
    return;
  }
  const auto time_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(item.tick.time_ns, 0));
  time_ns_ = std::max(time_ns_, time_ns);  // a clock that was set back does not turn the log
  if (!has_time_) statistics_time_ns_ = time_ns_;
  has_time_ = true;
  if (item.gap_before.ticks > 0) write_gap(item.gap_before);
  write(item.tick);
  if (time_ns_ - statistics_time_ns_ >= kStatisticsPeriod_ns) write_statistics();
  ++ticks_in_chunk_;
  if (mcap_->chunk_is_full()) {
    mcap_->end_chunk();
    settle_chunk();
  }
}

// The ticks of a chunk that the disk did not take are lost with it.
void FileWriter::settle_chunk() {
  const bool is_whole = mcap_->chunks_written() > chunks_settled_;
  if (mcap_->error() && !is_whole) dropped_.fetch_add(ticks_in_chunk_);
  chunks_settled_ = mcap_->chunks_written();
  ticks_in_chunk_ = 0;
}

void FileWriter::write(const TickRecord& tick) {
  if (!tick.decisions.empty())
    message(decisions_, log_records::encode(tick.tick, std::span(tick.decisions)));
  if (!tick.increments.empty())
    message(increments_, log_records::encode(tick.tick, std::span(tick.increments)));
  if (!tick.report.moved.empty())
    message(poses_, log_records::encode(tick.tick, std::span(tick.report.moved)));
  for (const ClashEvent& event : tick.report.events) message(clashes_, log_json::encode(event));
  message(ticks_, log_records::encode_end(tick.report, tick.tick));
  sums_.add(tick.report);
}

void FileWriter::write_gap(const Gap& gap) { message(gaps_, log_json::encode(gap)); }

void FileWriter::write_statistics() {
  if (!sums_.empty()) message(statistics_, sums_.encode());
  sums_ = {};
  statistics_time_ns_ = time_ns_;
}

void FileWriter::message(std::uint16_t channel, std::span<const std::byte> data) {
  mcap_->add_message(channel, time_ns_, data);
}
void FileWriter::message(std::uint16_t channel, const std::string& text) {
  message(channel, std::as_bytes(std::span(text)));
}

Status FileWriter::flush() {
  std::unique_lock lock(mutex_);
  take_kept_back();
  const std::uint64_t mine = ++flushes_asked_;
  wake_.notify_one();
  flushed_.wait(lock, [&] { return flushes_done_ >= mine || !thread_.joinable(); });
  if (error_) return *error_;
  return ok();
}

std::size_t FileWriter::queued_ticks() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

Status FileWriter::close() {
  {
    const std::lock_guard lock(mutex_);
    take_kept_back();
    closing_ = true;
    wake_.notify_one();
  }
  if (thread_.joinable()) {
    thread_.join();
    const std::lock_guard lock(mutex_);
    if (gap_.ticks > 0) write_gap(gap_);
    write_statistics();
    if (Status closed = mcap_->close(); !closed) error_ = closed.error();
    settle_chunk();
  }
  return status();
}

Status FileWriter::status() const {
  const std::lock_guard lock(mutex_);
  if (error_) return *error_;
  return ok();
}

}  // namespace

Result<std::unique_ptr<SessionLogWriter>> SessionLogWriter::create(
    const std::filesystem::path& file, const LogHeader& header, const LogOptions& options) {
  auto mcap = McapWriter::create(file, {.profile = log_layout::kProfile,
                                        .library = "mortise " + engine_version(),
                                        .compress = options.compress,
                                        .chunk_bytes = options.chunk_bytes});
  if (!mcap) return mcap.error();
  auto writer = std::make_unique<FileWriter>(std::move(mcap).value(), header, options);
  if (Status begun = writer->begin(); !begun) return begun.error();
  return std::unique_ptr<SessionLogWriter>(std::move(writer));
}

}  // namespace mortise
