#include "common/io/log/session_log.h"
#include "common/io/log/session_log_read.h"
#include "common/io/log/session_log_recover.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <csignal>
#include <fstream>
#include <thread>

#include "common/io/build_info.h"
#include "common/io/log/log_json.h"
#include "common/io/log/log_records.h"
#include "common/io/mesh/obj_exact.h"
#include "tests/support/test_folder.h"
#include "tests/unit/io/log_samples.h"

namespace mortise {
namespace {

using test::sample_tick;
using test::SampleHeader;
using test::TemporaryFile;
using test::write_sample;

bool same_bits(const Vec3& a, const Vec3& b) {
  for (int k = 0; k < 3; ++k)
    if (std::bit_cast<std::uint64_t>(a[k]) != std::bit_cast<std::uint64_t>(b[k])) return false;
  return true;
}

void expect_same(const TickRecord& read, const TickRecord& written) {
  ASSERT_EQ(read.tick, written.tick);
  EXPECT_EQ(read.time_ns, written.time_ns);
  EXPECT_EQ(read.report.tick, written.report.tick);
  EXPECT_EQ(read.report.state_hash, written.report.state_hash);
  EXPECT_EQ(read.decisions, written.decisions);
  ASSERT_EQ(read.increments.size(), written.increments.size());
  for (std::size_t i = 0; i < read.increments.size(); ++i) {
    EXPECT_EQ(read.increments[i].user, written.increments[i].user);
    EXPECT_EQ(read.increments[i].part, written.increments[i].part);
    EXPECT_EQ(read.increments[i].seq, written.increments[i].seq);
    EXPECT_TRUE(same_bits(read.increments[i].translation_mm, written.increments[i].translation_mm));
    EXPECT_TRUE(same_bits(read.increments[i].rotation_rad, written.increments[i].rotation_rad));
  }
  ASSERT_EQ(read.report.moved.size(), written.report.moved.size());
  for (std::size_t i = 0; i < read.report.moved.size(); ++i) {
    EXPECT_EQ(read.report.moved[i].part, written.report.moved[i].part);
    EXPECT_EQ(read.report.moved[i].holder, written.report.moved[i].holder);
    const Pose &a = read.report.moved[i].X_WP, &b = written.report.moved[i].X_WP;
    EXPECT_LE((a.p - b.p).norm(), 1e-5);
    EXPECT_LE(a.q.angularDistance(b.q), 4e-6);
  }
  ASSERT_EQ(read.report.refused.size(), written.report.refused.size());
  for (std::size_t i = 0; i < read.report.refused.size(); ++i) {
    EXPECT_EQ(read.report.refused[i].seq, written.report.refused[i].seq);
    EXPECT_EQ(read.report.refused[i].reason, written.report.refused[i].reason);
  }
  ASSERT_EQ(read.report.events.size(), written.report.events.size());
  for (std::size_t i = 0; i < read.report.events.size(); ++i)
    EXPECT_EQ(log_json::first_difference(read.report.events[i], written.report.events[i]), "");
}

TEST(SessionLog, ReadsBackWhatWasWritten) {
  for (const bool compress : {true, false}) {
    const TemporaryFile file("round_trip.mcap");
    // Small chunks, so that records of one session lie in many of them.
    const Status written =
        write_sample(file.path(), 300, {.compress = compress, .chunk_bytes = 4096});
    ASSERT_TRUE(written) << written.error().text;
    const auto log = read_session_log(file.path());
    ASSERT_TRUE(log) << log.error().text;
    const SampleHeader sample;
    EXPECT_TRUE(log->complete);
    EXPECT_TRUE(log->gaps.empty());
    EXPECT_TRUE(log->notes.empty()) << log->notes.front();
    EXPECT_EQ(log->session, "sample");
    EXPECT_EQ(log->scenario_name, "sample.yaml");
    EXPECT_EQ(log->scenario_yaml, sample.header.scenario_yaml);
    EXPECT_EQ(log->engine_version, engine_version());
    EXPECT_EQ(log->build_fingerprint, build_fingerprint());
    EXPECT_EQ(log->mesh_of_part, sample.header.mesh_of_part);
    ASSERT_EQ(log->meshes.size(), 2u);
    EXPECT_EQ(mesh_hash(log->meshes[1].second), mesh_hash(sample.large));
    ASSERT_EQ(log->imports.size(), 3u);
    EXPECT_EQ(log->imports[2].file, "part2.stl");
    EXPECT_EQ(log->imports[2].quantum_mm, 1.0 / 3.0);
    EXPECT_EQ(log->imports[2].notes, sample.header.imports[2].notes);
    ASSERT_EQ(log->ticks.size(), 300u);
    for (std::size_t i = 0; i < 300; ++i) expect_same(log->ticks[i], sample_tick(i + 1, 7));
  }
}

TEST(SessionLog, InfiniteEndsAndRoundedTextSurvive) {
  ClashEvent event = sample_tick(5, 7).report.events.at(0);
  event.verdict.explanation = "not UTF-8: \xff";
  ClashEvent read;
  ASSERT_TRUE(log_json::decode(log_json::encode(event), read));
  EXPECT_EQ(read.verdict.gpd_mm.hi, std::numeric_limits<double>::infinity());
  EXPECT_EQ(std::bit_cast<std::uint64_t>(read.verdict.delta_mm.lo),
            std::bit_cast<std::uint64_t>(0.1 + 0.2));
  event.verdict.probability = kProbabilityUnknown;
  EXPECT_NE(log_json::encode(event).find("\"probability\":null"), std::string::npos);
  ASSERT_TRUE(log_json::decode(log_json::encode(event), read));
  EXPECT_EQ(read.verdict.probability, kProbabilityUnknown);
  EXPECT_FALSE(log_json::decode("{\"tick\": 1}", read));
  EXPECT_FALSE(log_json::decode("[[[[", read));
  ClashEvent other = event;
  other.verdict.margin_mm += 1e-16;
  EXPECT_NE(log_json::first_difference(event, other), "");
}

TEST(SessionLog, RecordsStaySmall) {
  Increment increment{UserId{60}, PartId{100}, 100'000, Vec3(1, 2, 3), Vec3(0.1, 0.2, 0.3)};
  const std::vector<Increment> increments(100, increment);
  EXPECT_LE(log_records::encode(200'000, std::span(increments)).size(), 100 * 60u);
  const std::vector<PartPose> poses(100, {PartId{100}, UserId{60}, Pose{}});
  EXPECT_LE(log_records::encode(200'000, std::span(poses)).size(), 100 * 40u);
}

TEST(SessionLog, RefusesToOverwrite) {
  const TemporaryFile file("twice.mcap");
  ASSERT_TRUE(write_sample(file.path(), 3));
  const Status again = write_sample(file.path(), 3);
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().text.find("exists already"), std::string::npos);
  EXPECT_TRUE(read_session_log(file.path())->complete);
}

TEST(SessionLog, AFullQueueIsCountedAndMarked) {
  const TemporaryFile file("full_queue.mcap");
  const SampleHeader sample;
  auto writer = SessionLogWriter::create(file.path(), sample.header, {.queue_ticks = 1});
  ASSERT_TRUE(writer);
  constexpr std::uint64_t kTicks = 20'000;
  for (std::uint64_t tick = 1; tick <= kTicks; ++tick) {
    if (tick == kTicks / 2) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    (*writer)->record(sample_tick(tick, 7));
  }
  const std::uint64_t dropped = (*writer)->dropped_ticks();
  ASSERT_TRUE((*writer)->close());
  ASSERT_GT(dropped, 0u) << "the queue never was full: this test shows nothing";
  const auto log = read_session_log(file.path());
  ASSERT_TRUE(log);
  EXPECT_EQ(log->ticks.size() + dropped, kTicks);
  // Every hole between two recorded ticks is a gap that the log names, and there are no others.
  std::size_t gap = 0;
  std::uint64_t before = 0;
  for (const TickRecord& tick : log->ticks) {
    if (tick.tick != before + 1) {
      ASSERT_LT(gap, log->gaps.size());
      EXPECT_EQ(log->gaps[gap].after_tick, before);
      EXPECT_EQ(log->gaps[gap].until_tick, tick.tick);
      ++gap;
    }
    before = tick.tick;
  }
  EXPECT_EQ(log->gaps.size(), gap + (before < kTicks ? 1 : 0));
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void write_bytes(const std::filesystem::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

TEST(SessionLog, AnyCutLeavesTheRestReadable) {
  const TemporaryFile file("cut.mcap");
  constexpr std::size_t kTicks = 100;
  ASSERT_TRUE(write_sample(file.path(), kTicks, {.chunk_bytes = 1024}));
  const std::uintmax_t size = std::filesystem::file_size(file.path());
  std::size_t least = kTicks;
  // Every byte of the last KB, then through the index far into the chunks.
  for (std::uintmax_t cut = 1; least > kTicks / 2; cut += cut < 1024 ? 1 : 13) {
    ASSERT_LT(cut, size);
    std::filesystem::resize_file(file.path(), size - cut);
    const auto log = read_session_log(file.path());
    ASSERT_TRUE(log) << cut << ": " << log.error().text;
    EXPECT_FALSE(log->complete);
    EXPECT_FALSE(log->notes.empty());
    EXPECT_LE(log->ticks.size(), least) << "a shorter file gave more ticks";
    least = std::min(least, log->ticks.size());
    for (std::size_t i = 0; i < log->ticks.size(); ++i) ASSERT_EQ(log->ticks[i].tick, i + 1);
  }
}

TEST(SessionLog, DamageInTheMiddleCostsOneChunkAndIsMarked) {
  const TemporaryFile file("middle.mcap"), repaired("middle_repaired.mcap");
  ASSERT_TRUE(write_sample(file.path(), 300, {.chunk_bytes = 2048}));
  std::string bytes = bytes_of(file.path());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  write_bytes(file.path(), bytes);
  const auto log = read_session_log(file.path());
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_TRUE(log->complete);
  EXPECT_FALSE(log->notes.empty());
  ASSERT_LE(log->gaps.size(), 1u);
  EXPECT_GT(log->ticks.size(), 200u);
  if (log->ticks.size() < 300) {
    ASSERT_EQ(log->gaps.size(), 1u);
    EXPECT_EQ(log->gaps[0].until_tick - log->gaps[0].after_tick - 1, 300 - log->ticks.size());
  }
  const auto recovery = recover_session_log(file.path(), repaired.path());
  ASSERT_TRUE(recovery) << recovery.error().text;
  const auto again = read_session_log(repaired.path());
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_TRUE(again->complete);
  EXPECT_TRUE(again->notes.empty());
  EXPECT_EQ(again->ticks.size(), log->ticks.size());
  ASSERT_EQ(again->gaps.size(), log->gaps.size());
  if (!log->gaps.empty()) {
    EXPECT_EQ(again->gaps[0].after_tick, log->gaps[0].after_tick);
    EXPECT_EQ(again->gaps[0].until_tick, log->gaps[0].until_tick);
  }
  EXPECT_EQ(again->meshes.size(), 2u);
  EXPECT_EQ(again->imports.size(), 3u);
  EXPECT_EQ(again->build_fingerprint, log->build_fingerprint);
}

// Child processes do not return into GoogleTest.
template <class Body>
pid_t in_child(const Body& body) {
  const pid_t child = ::fork();
  if (child == 0) {
    body();
    ::_exit(0);
  }
  return child;
}

TEST(SessionLog, WhatIsSaidToBeFlushedIsInTheFile) {
  const TemporaryFile file("flushed.mcap");
  const SampleHeader sample;
  auto writer = SessionLogWriter::create(file.path(), sample.header, {.flush_s = 1000.0});
  ASSERT_TRUE(writer) << writer.error().text;
  const auto record = [&](std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t tick = first; tick <= last; ++tick) (*writer)->record(sample_tick(tick, 7));
  };
  record(1, 50);
  EXPECT_EQ((*writer)->flushed_tick(), 0u);
  ASSERT_TRUE((*writer)->flush());
  EXPECT_EQ((*writer)->flushed_tick(), 50u);
  record(51, 60);
  EXPECT_EQ((*writer)->flushed_tick(), 50u);
  const auto log = read_session_log(file.path());
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_GE(log->ticks.size(), 50u);
}

TEST(SessionLog, ReadableAfterTheWriterWasKilled) {
  const TemporaryFile file("killed.mcap");
  const SampleHeader sample;
  const pid_t child = in_child([&] {
    auto writer = SessionLogWriter::create(file.path(), sample.header, {.flush_s = 0.05});
    if (!writer) ::_exit(1);
    for (std::uint64_t tick = 1;; ++tick) {
      (*writer)->record(sample_tick(tick, 7));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  ASSERT_GT(child, 0);
  // In the middle of it, however slow the machine is.
  for (int i = 0; i < 600; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    const auto so_far = read_session_log(file.path());
    if (so_far && so_far->ticks.size() > 150) break;
  }
  ASSERT_EQ(::kill(child, SIGKILL), 0);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  const auto log = read_session_log(file.path());
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_FALSE(log->complete);
  EXPECT_GT(log->ticks.size(), 100u);
  for (std::size_t i = 0; i < log->ticks.size(); ++i)
    expect_same(log->ticks[i], sample_tick(i + 1, 7));
}

TEST(SessionLog, AFullDiskIsSaidAndTheRestStaysReadable) {
  constexpr std::uint64_t kTicks = 2000;
  const TemporaryFile file("full_disk.mcap"), account("full_disk.txt");
  const SampleHeader sample;
  std::ofstream dropped_file(account.path());  // opened before the disk is "full"
  const pid_t child = in_child([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{60'000, 60'000};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(2);
    auto writer = SessionLogWriter::create(file.path(), sample.header,
                                           {.compress = false, .chunk_bytes = 8192});
    if (!writer) ::_exit(3);
    for (std::uint64_t tick = 1; tick <= kTicks; ++tick) (*writer)->record(sample_tick(tick, 7));
    const Status closed = (*writer)->close();
    dropped_file << (*writer)->dropped_ticks() << std::flush;
    const bool told = !closed && closed.error().text.find("cannot write") != std::string::npos;
    // Nobody is to wait for ticks that never will be on disk.
    const bool waits = (*writer)->flushed_tick() < kTicks;
    ::_exit(told && !waits && !(*writer)->status() ? 0 : 4);
  });
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  const auto log = read_session_log(file.path());
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_FALSE(log->complete);
  EXPECT_GT(log->ticks.size(), 20u);
  const std::uint64_t dropped = std::stoull("0" + bytes_of(account.path()));
  EXPECT_GE(log->ticks.size() + dropped, kTicks) << "ticks were lost in silence";
}

TEST(SessionLog, APipeIsNotWaitedFor) {
  const test::TestFolder folder;
  const auto pipe = folder.path() / "pipe.mcap";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_FALSE(read_session_log(pipe));
  EXPECT_FALSE(read_obj_exact(pipe, 1.0));
}

TEST(SessionLog, OtherFilesAreRefusedInOneLine) {
  const TemporaryFile file("other.mcap");
  EXPECT_FALSE(read_session_log(file.path()));
  write_bytes(file.path(), "");
  EXPECT_FALSE(read_session_log(file.path()));
  write_bytes(file.path(), "solid cube");
  const auto log = read_session_log(file.path());
  ASSERT_FALSE(log);
  EXPECT_EQ(log.error().code, Code::kInvalidInput);
  EXPECT_EQ(log.error().text.find('\n'), std::string::npos);
  EXPECT_FALSE(read_session_log(std::filesystem::temp_directory_path()));
}

}  // namespace
}  // namespace mortise
