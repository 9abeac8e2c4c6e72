// Mutated logs: the reader gives a log or one line of error, never a crash, and never a tick that
// was not written.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <random>

#include "common/io/log/log_json.h"
#include "common/io/log/mcap_format.h"
#include "common/io/log/mcap_reader.h"
#include "common/io/log/mcap_writer.h"
#include "common/io/log/session_log_read.h"
#include "tests/fuzz/mutated.h"
#include "tests/fuzz/targets.h"
#include "tests/support/effort.h"
#include "tests/unit/io/log_samples.h"

namespace mortise {
namespace {

constexpr std::uint64_t kTicks = 120;

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string sample_log(bool compress) {
  const test::TemporaryFile file("fuzz_seed.mcap");
  const LogOptions options{.compress = compress, .chunk_bytes = 2048};
  return test::write_sample(file.path(), kTicks, options) ? bytes_of(file.path()) : "";
}

// The checksums would keep most mutations out of the decoders: this handler takes the bytes of the
// chunks apart without them. Uncompressed logs only.
std::string without_checksums(std::string bytes) {
  for (std::size_t at = mcap::kMagic.size(); at + mcap::kRecordHeaderBytes < bytes.size();) {
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < 8; ++i)
      length |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[at + 1 + i]))
                << (8 * i);
    const std::size_t content = at + mcap::kRecordHeaderBytes;
    const auto zero = [&](std::size_t from) { std::fill_n(bytes.begin() + from, 4, '\0'); };
    if (bytes[at] == mcap::kChunk) zero(content + 24);
    if (bytes[at] == mcap::kAttachment) zero(content + length - 4);
    if (bytes[at] == mcap::kDataEnd) break;
    at = content + length;
  }
  return bytes;
}

struct Outcome {
  std::size_t read = 0, refused = 0, lost_ticks = 0;
};

Outcome run(const std::string& seed_log, std::uint64_t seed, int count, bool checksums) {
  std::mt19937_64 random(seed);
  const test::TemporaryFile file("fuzz.mcap");
  Outcome outcome;
  for (int i = 0; i < count; ++i) {
    const std::string bytes = test::mutated(seed_log, random);
    std::ofstream(file.path(), std::ios::binary) << bytes;
    const auto log = read_session_log(file.path());
    if (!log) {
      ++outcome.refused;
      EXPECT_FALSE(log.error().text.empty());
      EXPECT_EQ(log.error().text.find('\n'), std::string::npos);
      continue;
    }
    ++outcome.read;
    std::uint64_t before = 0;
    for (const TickRecord& tick : log->ticks) {
      EXPECT_GT(tick.tick, before);
      before = tick.tick;
    }
    if (!checksums) continue;
    // With checksums a tick is either as it was written, or not there and then a gap or a note
    // says so.
    for (const TickRecord& tick : log->ticks) {
      EXPECT_LE(tick.tick, kTicks);
      EXPECT_EQ(tick.report.state_hash, test::sample_tick(tick.tick, 7).report.state_hash);
    }
    if (log->ticks.size() == kTicks) continue;
    ++outcome.lost_ticks;
    EXPECT_TRUE(!log->notes.empty() || !log->gaps.empty()) << "mutation " << i;
  }
  return outcome;
}

TEST(LogReaderFuzz, CompressedLogs) {
  const Outcome outcome = run(sample_log(true), 20'260'801, test::effort(2000), true);
  EXPECT_GT(outcome.read, 500u);
  EXPECT_GT(outcome.refused, 50u);
  EXPECT_GT(outcome.lost_ticks, 100u);
}

TEST(LogReaderFuzz, DecodersWithoutChecksums) {
  const std::string log = without_checksums(sample_log(false));
  const Outcome outcome = run(log, 77, test::effort(2500), false);
  EXPECT_GT(outcome.read, 500u);
  EXPECT_GT(outcome.refused, 50u);
}

// The target of libFuzzer, here with mutations of our own. MORTISE_CORPUS=FOLDER writes its seeds.
TEST(LogReaderFuzz, TheTargetHoldsWhatItPromises) {
  const test::TemporaryFile file("fuzz_small.mcap");
  std::vector<std::string> seeds;
  for (const std::uint64_t ticks : {3, 12}) {
    const LogOptions options{.compress = false, .chunk_bytes = 1024};
    ASSERT_TRUE(test::write_sample(file.path(), ticks, options));
    seeds.push_back(without_checksums(bytes_of(file.path())));
    std::filesystem::remove(file.path());
  }
  if (const char* folder = std::getenv("MORTISE_CORPUS"))
    for (std::size_t i = 0; i < seeds.size(); ++i)
      std::ofstream(std::string(folder) + "/seed" + std::to_string(i), std::ios::binary)
          << seeds[i];
  const auto feed = [](const std::string& bytes) {
    return test::fuzz_log({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  };
  std::mt19937_64 random(12);
  std::size_t read = 0;
  for (const std::string& seed : seeds) {
    EXPECT_TRUE(feed(seed));
    for (int i = 0; i < test::effort(500); ++i) read += feed(test::mutated(seed, random));
  }
  EXPECT_GT(read, 100u);
}

// Shows that the test above notices: a tick that was changed with its checksum made good again is
// exactly what no reader can see, and the comparison with what was written must.
TEST(LogReaderFuzz, TheComparisonSeesAPlantedTick) {
  const test::TemporaryFile file("fuzz_planted.mcap");
  std::string bytes = without_checksums(sample_log(false));
  const std::uint64_t hash = test::sample_tick(60, 7).report.state_hash;
  const std::string_view needle(reinterpret_cast<const char*>(&hash), sizeof hash);
  const std::size_t at = bytes.find(needle);
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] + 1);
  std::ofstream(file.path(), std::ios::binary) << bytes;
  const auto log = read_session_log(file.path());
  ASSERT_TRUE(log);
  ASSERT_EQ(log->ticks.size(), kTicks);
  EXPECT_NE(log->ticks[59].report.state_hash, hash);
}

// A small file that expands to a large one costs no more than the limits say.
TEST(LogReaderFuzz, BombsAreRefused) {
  const test::TemporaryFile file("fuzz_bomb.mcap");
  {
    auto writer = McapWriter::create(file.path());
    ASSERT_TRUE(writer);
    const std::uint16_t channel = (*writer)->add_channel("/zeros", "none", 0);
    for (int i = 0; i < 4; ++i) {
      (*writer)->add_message(channel, 1, std::vector<std::byte>(1 << 20));
      (*writer)->end_chunk();
    }
    ASSERT_TRUE((*writer)->close());
  }
  ASSERT_LT(std::filesystem::file_size(file.path()), 4000u);
  std::vector<std::string> losses;
  std::uint64_t bytes = 0;
  const McapHandler handler{
      .on_message = [&](const McapChannel&, const McapMessage& m) { bytes += m.data.size(); },
      .on_loss = [&](const std::string& what) { losses.push_back(what); }};
  ASSERT_TRUE(scan_mcap(file.path(), handler));
  EXPECT_TRUE(losses.empty());
  EXPECT_EQ(bytes, 4u << 20);

  bytes = 0;
  ASSERT_TRUE(scan_mcap(file.path(), handler, {.chunk_bytes = 1 << 20}));
  EXPECT_EQ(losses.size(), 4u) << "one chunk is larger than allowed";
  EXPECT_EQ(bytes, 0u);

  losses.clear();
  ASSERT_TRUE(scan_mcap(file.path(), handler, {.expansion_floor_bytes = 3 << 20}));
  EXPECT_EQ(losses.size(), 2u) << "two chunks fit into the limit of all of them";
  EXPECT_EQ(bytes, 2u << 20);
}

TEST(LogReaderFuzz, DeepJsonDoesNotOverflowTheStack) {
  ClashEvent event;
  std::string deep(200'000, '[');
  EXPECT_FALSE(log_json::decode(deep, event));
  deep = "{\"tick\":";
  for (int i = 0; i < 100'000; ++i) deep += "{\"a\":";
  EXPECT_FALSE(log_json::decode(deep, event));
}

}  // namespace
}  // namespace mortise
