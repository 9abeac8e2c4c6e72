// A single flipped bit in what a log needs at its front leaves the log what it was.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "common/io/log/log_chain.h"
#include "common/io/log/mcap_format.h"
#include "common/io/log/mcap_reader.h"
#include "common/io/log/replay.h"
#include "common/io/log/session_log_recover.h"
#include "common/io/log/tick_sequence.h"
#include "tests/support/effort.h"
#include "tests/support/test_folder.h"
#include "tests/unit/io/log_samples.h"
#include "tests/unit/io/random_session.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

std::string all_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Where the first chunk with ticks begins; a file that continues another one has two before it.
std::size_t front_of(const std::string& bytes, int chunks_before) {
  for (std::size_t at = mcap::kMagic.size(); at + mcap::kRecordHeaderBytes < bytes.size();) {
    std::uint64_t length = 0;
    for (std::size_t i = 8; i > 0; --i)
      length = length << 8 | static_cast<unsigned char>(bytes[at + i]);
    if (bytes[at] == mcap::kChunk && chunks_before-- == 0) return at;
    at += mcap::kRecordHeaderBytes + length;
  }
  return 0;
}

void flip(std::string& bytes, std::size_t at) {
  bytes[at] = static_cast<char>(bytes[at] ^ (1 << (at * 5 % 8)));
}

void expect_as_written(const SessionLog& log, const SessionLog& whole, std::size_t at) {
  std::string notes;
  for (const std::string& note : log.notes) notes += "\n" + note;
  SCOPED_TRACE("byte " + std::to_string(at) + notes);
  EXPECT_EQ(log.session, whole.session);
  EXPECT_EQ(log.scenario_name, whole.scenario_name);
  EXPECT_EQ(log.scenario_yaml, whole.scenario_yaml);
  EXPECT_EQ(log.mesh_of_part, whole.mesh_of_part);
  EXPECT_EQ(log.meshes.size(), whole.meshes.size());
  EXPECT_EQ(log.imports.size(), whole.imports.size());
  EXPECT_EQ(log.build_fingerprint, whole.build_fingerprint);
  EXPECT_EQ(log.chain.previous, whole.chain.previous);
  EXPECT_EQ(log.chain.part, whole.chain.part);
  EXPECT_EQ(log.begin.has_value(), whole.begin.has_value());
  EXPECT_EQ(log.gaps.size(), whole.gaps.size());
  ASSERT_EQ(log.ticks.size(), whole.ticks.size());
  for (std::size_t i = 0; i < log.ticks.size(); ++i) {
    EXPECT_EQ(log.ticks[i].report.state_hash, whole.ticks[i].report.state_hash);
    EXPECT_EQ(log.ticks[i].increments.size(), whole.ticks[i].increments.size());
    EXPECT_EQ(log.ticks[i].decisions.size(), whole.ticks[i].decisions.size());
    EXPECT_EQ(log.ticks[i].report.events.size(), whole.ticks[i].report.events.size());
  }
}

TEST(LogDamage, NoBitOfTheFrontCostsAnything) {
  const test::TestFolder folder;
  const fs::path file = folder.path() / "whole.mcap", damaged = folder.path() / "damaged.mcap";
  ASSERT_TRUE(test::write_sample(file, 30));
  const std::string bytes = all_of(file);
  const auto whole = read_session_log(file);
  ASSERT_TRUE(whole) << whole.error().text;
  const std::size_t front = front_of(bytes, 0);
  ASSERT_GT(front, 2000U);
  for (std::size_t at = 0; at < front; ++at) {
    std::string flipped = bytes;
    flip(flipped, at);
    std::ofstream(damaged, std::ios::binary) << flipped;
    const auto log = read_session_log(damaged);
    ASSERT_TRUE(log) << at << ": " << log.error().text;
    expect_as_written(*log, *whole, at);
    if (HasFailure()) break;
  }
}

/// A session in two files, of which the second one begins with the state of the first.
class LogDamageInChains : public testing::Test {
 protected:
  void SetUp() override {
    for (std::size_t i = 1; i <= kTicks; ++i) {
      session_.tick();
      if (i % 10 == 0)
        session_.ticks.back().state = [bytes = encode_state(session_.scene.world)] {
          return bytes;
        };
    }
    auto writer =
        SessionLogWriter::create(folder_.path() / "s.mcap", session_.header, {.rotate_bytes = 1});
    ASSERT_TRUE(writer) << writer.error().text;
    for (const TickRecord& tick : session_.ticks) {
      (*writer)->record(tick);
      ASSERT_TRUE((*writer)->flush());
    }
    ASSERT_TRUE((*writer)->close());
    ASSERT_TRUE(fs::exists(second_));
    fs::remove(folder_.path() / "s_p0003.mcap");
    bytes_ = all_of(second_);
  }

  static constexpr std::size_t kTicks = 25;
  test::RandomSession session_{10};
  test::TestFolder folder_;
  const fs::path first_ = folder_.path() / "s.mcap", second_ = folder_.path() / "s_p0002.mcap";
  std::string bytes_;
};

TEST_F(LogDamageInChains, NoBitOfTheFrontOfALaterFileCostsAnything) {
  const auto whole = read_session_log(second_);
  ASSERT_TRUE(whole) << whole.error().text;
  ASSERT_TRUE(whole->begin);
  const std::size_t front = front_of(bytes_, 2);
  const std::size_t step = std::max<std::size_t>(1, front / 400 / test::effort(1));
  for (std::size_t at = 0; at < front; at += step) {
    std::string flipped = bytes_;
    flip(flipped, at);
    std::ofstream(second_, std::ios::binary) << flipped;
    const auto log = read_session_log(second_);
    ASSERT_TRUE(log) << at << ": " << log.error().text;
    expect_as_written(*log, *whole, at);
    EXPECT_EQ(chain_from(first_).size(), 2U) << at;
    if (HasFailure()) break;
  }
}

/// What is read so is computed again and agrees; and so is what recover makes of it.
TEST_F(LogDamageInChains, TheRestIsComputedAgain) {
  const std::size_t front = front_of(bytes_, 2);
  for (std::size_t at = 9; at < front; at += front / 8) {
    SCOPED_TRACE(at);
    std::string flipped = bytes_;
    flip(flipped, at);
    std::ofstream(second_, std::ios::binary) << flipped;
    const auto log = read_session(first_);
    ASSERT_TRUE(log) << log.error().text;
    const auto report = verify(*log, 1);
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_FALSE(report->difference);
    EXPECT_EQ(report->not_verifiable, "");
    const fs::path out = folder_.path() / "recovered.mcap";
    const auto recovery = recover_session_log(second_, out);
    ASSERT_TRUE(recovery) << recovery.error().text;
    EXPECT_EQ(recovery->not_replayable, "");
    EXPECT_EQ(recovery->not_verified, "");
    fs::remove(out);
  }
}

/// A tick that is lost behind the front stays a gap, with a damaged front and without.
TEST_F(LogDamageInChains, ALostFirstTickIsNotTakenForTheFront) {
  const test::TemporaryFile file("first_tick.mcap");
  ASSERT_TRUE(test::write_sample(file.path(), 60, {.chunk_bytes = 512}));
  std::string bytes = all_of(file.path());
  const std::size_t chunk = front_of(bytes, 0);
  flip(bytes, chunk + 60);
  for (const bool front_too : {false, true}) {
    if (front_too) flip(bytes, mcap::kMagic.size() + 3);  // the length of the header
    std::ofstream(file.path(), std::ios::binary) << bytes;
    const auto log = read_session_log(file.path());
    ASSERT_TRUE(log) << log.error().text;
    ASSERT_LT(log->ticks.size(), 60U);
    ASSERT_EQ(log->gaps.size(), 1U);
    EXPECT_EQ(log->gaps[0].after_tick, 0U);
  }
}

// Where the chunks of a log begin, and behind the last of them its end of data.
std::vector<std::size_t> chunks_of(const std::string& bytes) {
  std::vector<std::size_t> chunks;
  while (const std::size_t at = front_of(bytes, static_cast<int>(chunks.size())))
    chunks.push_back(at);
  return chunks;
}

// The size of the record there.
std::size_t record_size(const std::string& bytes, std::size_t at) {
  std::uint64_t length = 0;
  for (std::size_t i = 8; i > 0; --i)
    length = length << 8 | static_cast<unsigned char>(bytes[at + i]);
  return mcap::kRecordHeaderBytes + length;
}

/// A whole chunk that was cut out leaves a file of whole records: its ticks are missed all the
/// same, by reading, by computing again, and in what recover makes of it.
TEST(LogDamage, AChunkThatWasCutOutIsMissed) {
  const test::TestFolder folder;
  const fs::path file = folder.path() / "whole.mcap", cut = folder.path() / "cut.mcap",
                 recovered = folder.path() / "recovered.mcap";
  test::RandomSession session(10);
  for (int i = 0; i < 60; ++i) session.tick();
  auto writer = SessionLogWriter::create(file, session.header, {.chunk_bytes = 512});
  ASSERT_TRUE(writer) << writer.error().text;
  for (const TickRecord& tick : session.ticks) (*writer)->record(tick);
  ASSERT_TRUE((*writer)->close());
  const std::string bytes = all_of(file);
  const std::vector<std::size_t> chunks = chunks_of(bytes);
  ASSERT_GT(chunks.size(), 3U);
  for (const std::size_t chunk : {std::size_t{0}, chunks.size() / 2, chunks.size() - 1}) {
    SCOPED_TRACE("chunk " + std::to_string(chunk) + " of " + std::to_string(chunks.size()));
    std::string rest = bytes;
    rest.erase(chunks[chunk], record_size(bytes, chunks[chunk]));
    std::ofstream(cut, std::ios::binary) << rest;
    const auto log = read_session_log(cut);
    ASSERT_TRUE(log) << log.error().text;
    ASSERT_LT(log->ticks.size(), 60U);
    ASSERT_EQ(log->gaps.size(), 1U);
    const LogGap& gap = log->gaps[0];
    EXPECT_EQ(gap.reason, missing_text(60 - log->ticks.size()));
    const auto report = verify(*log, 1);
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_EQ(report->verified_to_tick, gap.after_tick);
    EXPECT_NE(report->not_verifiable.find(gap.reason), std::string::npos);
    EXPECT_FALSE(report->difference);
    const auto recovery = recover_session_log(cut, recovered);
    ASSERT_TRUE(recovery) << recovery.error().text;
    EXPECT_EQ(recovery->verified_to_tick, gap.after_tick);
    EXPECT_NE(recovery->not_verified.find(gap.reason), std::string::npos);
    const auto again = read_session_log(recovered);
    ASSERT_TRUE(again) << again.error().text;
    ASSERT_EQ(again->gaps.size(), 1U);
    EXPECT_EQ(again->gaps[0].reason, gap.reason);
    fs::remove(recovered);
  }
}

std::string little(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i));
  return text;
}

std::string record(std::uint8_t opcode, std::uint64_t length, const std::string& content = {}) {
  return static_cast<char>(opcode) + little(length, 8) + content;
}

/// A file of very many chunks without a record, each with another record behind it that says so
/// many bytes less than the rest of the file, and at its end a footer that tells of an index.
std::string many_tiny_chunks(std::uint8_t opcode, std::uint64_t less) {
  constexpr std::size_t kUnits = 3000;
  const std::string magic(mcap::kMagic.begin(), mcap::kMagic.end());
  const std::string chunk =
      record(mcap::kChunk, mcap::kChunkFixedBytes, std::string(mcap::kChunkFixedBytes, '\0'));
  const std::string footer =
      record(mcap::kFooter, mcap::kFooterBytes, little(1, 8) + little(1, 8) + little(1, 4)) + magic;
  const bool is_whole = less == 0;  // an end of data of the right length
  const std::size_t unit = chunk.size() + mcap::kRecordHeaderBytes + (is_whole ? 4 : 0);
  const std::size_t total = magic.size() + kUnits * unit + footer.size();
  std::string bytes = magic;
  for (std::size_t i = 0; i < kUnits; ++i) {
    bytes += chunk;
    const std::size_t left = total - bytes.size() - mcap::kRecordHeaderBytes;
    bytes += is_whole ? record(opcode, 4, little(0, 4)) : record(opcode, left - less);
  }
  return bytes + footer;
}

/// Whatever the lengths of a hostile log say, it is read in a time that goes by its size.
TEST(LogDamage, ManyTinyChunksAndAbsurdLengthsAreReadInLinearTime) {
  const test::TestFolder folder;
  const fs::path file = folder.path() / "hostile.mcap";
  for (int opcode = 0; opcode <= mcap::kDataEnd + 1; ++opcode)
    for (const std::uint64_t less : {0, 1, 7, 29}) {
      if (less == 0 && opcode != mcap::kDataEnd) continue;
      SCOPED_TRACE(std::to_string(opcode) + ", " + std::to_string(less) + " less");
      const std::string bytes = many_tiny_chunks(static_cast<std::uint8_t>(opcode), less);
      std::ofstream(file, std::ios::binary) << bytes;
      const auto scan = scan_mcap(file, {});
      ASSERT_TRUE(scan) << scan.error().text;
      EXPECT_GE(scan->bytes_read, bytes.size() / 2) << "something else was read";
      EXPECT_LE(scan->bytes_read, 20 * bytes.size());
      EXPECT_FALSE(scan->complete);
    }
}

}  // namespace
}  // namespace mortise
