#include "common/io/log/session_log.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <thread>

#include "common/io/build_info.h"
#include "common/io/log/log_file.h"
#include "common/io/scenario/scene_load.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;
using log_json::Gap;

// The writer looks so often for ticks, or is woken when there are so many. Chosen: three ticks of
// 60 Hz at once.
constexpr auto kCollect = std::chrono::milliseconds(50);
constexpr std::size_t kWakeTicks = 64;
// Ticks that may stay with the caller while the writer has the queue, which it never has for long.
constexpr std::size_t kMostKeptBack = 16;
// Records that are kept for their memory: more than come between two looks.
constexpr std::size_t kMostSpare = 16;
// Ticks that the queue has room for from the beginning, two minutes of a stuck disk.
constexpr std::size_t kMostReserved = 8192;

void empty(TickRecord& record) {
  record.tick = 0;
  record.meshes.clear();
  record.decisions.clear();
  record.increments.clear();
  record.report = {};  // came with the record, and no one fills it again
  record.state = {};
}

class FileWriter final : public SessionLogWriter {
 public:
  FileWriter(std::unique_ptr<LogFile> file, const LogHeader& header, const LogOptions& options);
  ~FileWriter() override { static_cast<void>(close()); }

  void record(TickRecord record) override;
  TickRecord spare() override;
  bool wants_state() const override { return wants_state_.load(std::memory_order_relaxed); }
  Status take_name() override;
  Status flush() override;
  Status close() override;
  std::uint64_t dropped_ticks() const override { return dropped_.load(); }
  std::uint64_t bytes_written() const override { return bytes_.load(); }
  std::size_t queued_ticks() const override;
  std::uint64_t flushed_tick() const override { return flushed_tick_.load(); }
  Status status() const override;

 private:
  struct Item {
    Gap gap_before;  ///< ticks == 0: none
    TickRecord tick;
  };
  void take_kept_back();
  void queue(TickRecord& record);
  void run();
  void write(const Item& item);
  void write_meshes(const TickRecord& tick);
  void write_state(const TickRecord& tick);
  void rotate(Checkpoint state);
  void remember_error();
  void settle_chunk();
  void count_bytes();

  // Of the writer thread alone once it runs.
  std::unique_ptr<LogFile> file_;
  LogHeader header_;
  LogOptions options_;
  std::vector<SolidPtr> meshes_;  ///< added to those of the header since
  SessionStatistics statistics_;  ///< of all ticks so far; only where files are rotated
  StepCounters counters_;
  std::uint64_t written_tick_ = 0;    ///< the last
  std::uint64_t ticks_in_chunk_ = 0;  ///< written, but not yet in the file
  std::uint32_t chunks_settled_ = 0;
  std::uint64_t bytes_before_ = 0;  ///< of the files before this one
  std::optional<Error> rotate_error_;
  std::mutex names_mutex_;         ///< file_ as it is replaced, and:
  std::vector<fs::path> unnamed_;  ///< files before this one that have no name yet

  std::atomic<std::uint64_t> bytes_ = 0;
  std::atomic<bool> wants_state_ = false;
  std::atomic<std::uint64_t> flushed_tick_ = 0;
  std::vector<TickRecord> kept_back_, own_spare_;  ///< of the thread that records

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::size_t wake_ticks_ = 1;  ///< as many wake the writer before its time
  std::vector<Item> queue_;
  std::vector<TickRecord> spare_;
  Gap gap_;  ///< dropped since the last queued tick
  bool closing_ = false;
  std::uint64_t flushes_asked_ = 0, flushes_done_ = 0;
  std::condition_variable flushed_;
  std::optional<Error> error_;
  std::atomic<std::uint64_t> dropped_ = 0;
  std::thread thread_;
};

FileWriter::FileWriter(std::unique_ptr<LogFile> file, const LogHeader& header,
                       const LogOptions& options)
    : file_(std::move(file)), header_(header), options_(options) {
  wake_ticks_ = std::clamp<std::size_t>(options.queue_ticks / 2, 1, kWakeTicks);
  if (header_.begin) statistics_ = std::move(header_.begin->statistics);
  statistics_.keep_ended_rows(SessionStatistics::kMostEndedRows);
  counters_ = statistics_.counters();
  header_.begin.reset();
  count_bytes();
  // Grown while a disk is stuck, they would hold up the tick.
  queue_.reserve(std::min(options.queue_ticks, kMostReserved));
  kept_back_.reserve(kMostKeptBack);
  thread_ = std::thread([this] { run(); });
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
  queue(record);
}

TickRecord FileWriter::spare() {
  if (own_spare_.empty()) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (lock.owns_lock()) own_spare_.swap(spare_);
  }
  if (own_spare_.empty()) return {};
  TickRecord record = std::move(own_spare_.back());
  own_spare_.pop_back();
  return record;
}

void FileWriter::take_kept_back() {
  for (TickRecord& record : kept_back_) queue(record);
  kept_back_.clear();
}

// Takes it where it is let in; a record is large, and moving it costs the tick.
void FileWriter::queue(TickRecord& record) {
  if (error_ || closing_ || queue_.size() >= options_.queue_ticks) {
    dropped_.fetch_add(1);
    if (gap_.ticks++ == 0) gap_.first_tick = record.tick;
    gap_.last_tick = record.tick;
    gap_.reason = "the queue to the disk was full";
    return;
  }
  queue_.push_back({gap_.ticks > 0 ? std::exchange(gap_, {}) : Gap{}, std::move(record)});
  // The writer comes by itself: to wake it in each tick would cost the tick more than all else.
  if (queue_.size() == wake_ticks_) wake_.notify_one();
}

void FileWriter::run() {
  using Clock = std::chrono::steady_clock;
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.flush_s));
  auto next_flush = Clock::now() + period;
  bool unflushed = false;
  std::vector<Item> items;
  std::vector<TickRecord> used;
  items.reserve(queue_.capacity());
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait_for(lock, kCollect, [&] {
      return closing_ || queue_.size() >= wake_ticks_ || flushes_asked_ > flushes_done_;
    });
    items.swap(queue_);
    const bool closing = closing_;
    const std::uint64_t flushes = flushes_asked_;
    lock.unlock();
    unflushed = unflushed || !items.empty();
    for (const Item& item : items) write(item);
    if (!unflushed) next_flush = Clock::now() + period;
    if (unflushed && (Clock::now() >= next_flush || flushes > flushes_done_)) {
      static_cast<void>(file_->sync());  // an error sticks and is taken below
      settle_chunk();
      flushed_tick_.store(written_tick_);
      unflushed = false;
      next_flush = Clock::now() + period;
    }
    for (Item& item : items) {
      if (used.size() >= kMostSpare) break;
      empty(item.tick);
      used.push_back(std::move(item.tick));
    }
    items.clear();
    count_bytes();
    lock.lock();
    if (spare_.empty()) spare_.swap(used);
    remember_error();
    flushes_done_ = flushes;
    flushed_.notify_all();
    if (closing && queue_.empty()) return;
  }
}

// Ticks that went into a file that can no longer be written are lost like any other.
void FileWriter::remember_error() {
  if (!error_) error_ = file_->mcap().error() ? file_->mcap().error() : rotate_error_;
  if (!error_) return;
  dropped_.fetch_add(queue_.size());
  queue_.clear();
  flushed_tick_.store(std::numeric_limits<std::uint64_t>::max());
}

void FileWriter::write(const Item& item) {
  written_tick_ = item.tick.tick;
  if (file_->mcap().error() || rotate_error_) {
    dropped_.fetch_add(1);
    return;
  }
  file_->set_time(item.tick.time_ns);
  if (item.gap_before.ticks > 0) file_->write_gap(item.gap_before);
  write_meshes(item.tick);
  file_->write(item.tick);
  accumulate(counters_, item.tick.report.counters);
  if (options_.rotate_bytes > 0) {
    statistics_.forget_users(item.tick.decisions);
    statistics_.add(item.tick.report);
  }
  ++ticks_in_chunk_;
  if (item.tick.state) write_state(item.tick);
  if (file_->mcap().chunk_is_full()) {
    file_->end_chunk();
    settle_chunk();
  }
}

void FileWriter::write_meshes(const TickRecord& tick) {
  for (const SolidPtr& solid : tick.meshes) {
    if (std::ranges::any_of(header_.meshes, [&](auto& m) { return m.first == solid->hash(); }))
      continue;
    file_->write(solid->hash(), solid->mesh());
    header_.meshes.emplace_back(solid->hash(), &solid->mesh());  // of the next file as well
    meshes_.push_back(solid);
  }
}

void FileWriter::write_state(const TickRecord& tick) {
  Checkpoint state{tick.tick, tick.report.state_hash, build_fingerprint(),
                   {},        tick.state(),           counters_};
  file_->write(state);
  const bool is_full =
      options_.rotate_bytes > 0 && file_->mcap().bytes_written() >= options_.rotate_bytes;
  if (is_full) rotate(std::move(state));
}

// The old file is whole on disk before the next one is begun: a crash in between costs nothing that
// was written.
void FileWriter::rotate(Checkpoint state) {
  file_->write_statistics();
  const Status closed = file_->close(header_);
  settle_chunk();
  if (!closed) return;
  header_.chain = {file_->path().filename().string(), header_.chain.part + 1, file_->seal()};
  header_.begin =
      LogBegin{std::move(state), statistics_, static_cast<std::int64_t>(file_->time_ns())};
  LogOptions options;
  {
    const std::lock_guard lock(names_mutex_);
    options = options_;
  }
  options.named_later = true;  // whoever gives names does not wait for this file's disk
  auto next = LogFile::create(next_in_chain(file_->path()), header_, options);
  header_.begin.reset();
  const std::lock_guard lock(names_mutex_);
  Status begun = next ? ok() : Status(next.error());
  if (begun && !options_.named_later) begun = (*next)->take_name();
  if (!begun) {
    rotate_error_ = begun.error();
    return;
  }
  bytes_before_ += file_->mcap().bytes_written();
  if (options_.named_later) unnamed_.push_back(file_->path());
  file_ = std::move(*next);
  chunks_settled_ = file_->mcap().chunks_written();
}

// The ticks of a chunk that the disk did not take are lost with it.
void FileWriter::settle_chunk() {
  const McapWriter& mcap = file_->mcap();
  const bool is_whole = mcap.chunks_written() > chunks_settled_;
  if (mcap.error() && !is_whole) dropped_.fetch_add(ticks_in_chunk_);
  chunks_settled_ = mcap.chunks_written();
  ticks_in_chunk_ = 0;
}

void FileWriter::count_bytes() {
  const std::uint64_t bytes = file_->mcap().bytes_written();
  bytes_.store(bytes_before_ + bytes);
  wants_state_.store(options_.rotate_bytes > 0 && bytes >= options_.rotate_bytes,
                     std::memory_order_relaxed);
}

Status FileWriter::take_name() {
  const std::lock_guard lock(names_mutex_);
  options_.named_later = false;
  Status all = ok();
  const auto keep_first = [&](Status named) {
    if (all && !named) all = std::move(named);
  };
  for (const fs::path& file : unnamed_) keep_first(LogFile::name(file));
  unnamed_.clear();
  keep_first(file_->take_name());
  return all;
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
    if (!rotate_error_) {
      if (gap_.ticks > 0) file_->write_gap(gap_);
      file_->write_statistics();
      if (Status closed = file_->close(header_); !closed) error_ = closed.error();
      settle_chunk();
    }
    if (options_.named_later) file_->remove_if_unnamed();
    for (const fs::path& file : unnamed_) LogFile::remove_unnamed(file);
    count_bytes();
  }
  return status();
}

Status FileWriter::status() const {
  const std::lock_guard lock(mutex_);
  if (error_) return *error_;
  return ok();
}

}  // namespace

LogHeader log_header(const LoadedScene& scene, std::string session, std::string scenario_name,
                     std::string scenario_yaml) {
  LogHeader header{.session = std::move(session),
                   .scenario_name = std::move(scenario_name),
                   .scenario_yaml = std::move(scenario_yaml),
                   .meshes = {},
                   .mesh_of_part = scene.mesh_of_part,
                   .imports = scene.imports,
                   .assembly = scene.assembly};
  std::map<std::string, const TriangleMesh*> meshes;
  // Parts of the scenario as they began; what was added or replaced since is in the state that the
  // log begins with.
  for (const Part& part : scene.world.parts)
    meshes.emplace(part.solid->hash(), &part.solid->mesh());
  if (scene.world.shapes)
    for (const auto& [hash, mesh] : scene.world.shapes->meshes())
      meshes.emplace(hash, &mesh.solid->mesh());
  header.meshes.assign(meshes.begin(), meshes.end());
  return header;
}

Result<std::unique_ptr<SessionLogWriter>> SessionLogWriter::create(
    const std::filesystem::path& file, const LogHeader& header, const LogOptions& options) {
  auto log = LogFile::create(file, header, options);
  if (!log) return log.error();
  return std::unique_ptr<SessionLogWriter>(
      std::make_unique<FileWriter>(std::move(*log), header, options));
}

}  // namespace mortise
