// Mutated logs of a whole session, verified and restored: what is wrong is refused or told, and
// what is not told is what was played. Nothing takes long, whatever a log says.
#include <gtest/gtest.h>
#include <time.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>

#include "common/io/log/log_layout.h"
#include "common/io/log/mcap_format.h"
#include "common/io/log/mcap_reader.h"
#include "common/io/log/mcap_writer.h"
#include "common/io/log/replay.h"
#include "common/io/log/session_log_recover.h"
#include "server/restore.h"
#include "tests/fuzz/mutated.h"
#include "tests/support/effort.h"
#include "tests/unit/io/log_samples.h"
#include "tests/unit/io/random_session.h"

namespace mortise {
namespace {

constexpr std::uint64_t kPlayedTicks = 80;
constexpr double kMost_s = 15.0;

double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::string file_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

using Random = std::mt19937_64;

/// Records of a file, behind its first magic: where each begins, and where the next one does.
std::vector<std::pair<std::size_t, std::size_t>> records_in(const std::string& bytes) {
  std::vector<std::pair<std::size_t, std::size_t>> records;
  for (std::size_t at = mcap::kMagic.size(); at + mcap::kRecordHeaderBytes < bytes.size();) {
    std::uint64_t length = 0;
    for (std::size_t i = 8; i > 0; --i)
      length = length << 8 | static_cast<unsigned char>(bytes[at + i]);
    if (length > bytes.size() - at - mcap::kRecordHeaderBytes) break;
    records.emplace_back(at, at + mcap::kRecordHeaderBytes + length);
    at = records.back().second;
  }
  return records;
}

// Two records change places, or one goes, or is there twice.
std::string reordered(const std::string& bytes, Random& random) {
  const auto records = records_in(bytes);
  const auto [a_from, a_to] = records[random() % records.size()];
  const auto [b_from, b_to] = records[random() % records.size()];
  switch (random() % 3) {
    case 0:
      return bytes.substr(0, a_from) + bytes.substr(a_to);
    case 1:
      return bytes.substr(0, b_from) + bytes.substr(a_from, a_to - a_from) + bytes.substr(b_from);
    default:
      if (a_from >= b_from) return reordered(bytes, random);
      return bytes.substr(0, a_from) + bytes.substr(b_from, b_to - b_from) +
             bytes.substr(a_to, b_from - a_to) + bytes.substr(a_from, a_to - a_from) +
             bytes.substr(b_to);
  }
}

// One length says something else.
std::string lengthened(std::string bytes, Random& random) {
  const auto records = records_in(bytes);
  const std::size_t at = records[random() % records.size()].first;
  const std::uint64_t length = std::uint64_t{1} << random() % 64;
  for (std::size_t i = 0; i < 8; ++i) bytes[at + 1 + i] = static_cast<char>(length >> (8 * i));
  return bytes;
}

std::uint64_t absurd(Random& random) {
  const std::uint64_t power = std::uint64_t{1} << random() % 64;
  switch (random() % 3) {
    case 0:
      return power;
    case 1:
      return power - 1;
    default:
      return ~std::uint64_t{0} - random() % 3;
  }
}

/// A number in one message becomes absurd, or all ticks from one on are later by one, and all
/// checksums fit: what a hostile program writes.
class Forger {
 public:
  Forger(const std::filesystem::path& from, const std::filesystem::path& to, bool later,
         Random& random)
      : random_(random), later_by_(later ? absurd(random) : 0) {
    std::filesystem::remove(to);
    auto writer = McapWriter::create(to, {.profile = log_layout::kProfile, .library = "a forger"});
    EXPECT_TRUE(writer);
    out_ = std::move(*writer);
    std::uint64_t messages = 0;
    EXPECT_TRUE(scan_mcap(from, {.on_message = [&](const auto&, const auto&) { ++messages; }}));
    forged_ = random_() % messages;
    EXPECT_TRUE(scan_mcap(from, handler()));
    EXPECT_TRUE(out_->close());
  }

 private:
  McapHandler handler() {
    return {.on_schema =
                [this](const McapSchema& schema) {
                  schemas_[schema.id] = out_->add_schema(
                      schema.name, schema.encoding,
                      {reinterpret_cast<const char*>(schema.data.data()), schema.data.size()});
                },
            .on_channel =
                [this](const McapChannel& channel) {
                  channels_[channel.id] =
                      out_->add_channel(channel.topic, channel.message_encoding,
                                        schemas_[channel.schema], channel.metadata);
                },
            .on_message =
                [this](const McapChannel& channel, const McapMessage& message) {
                  const std::uint64_t seen = seen_++;
                  if (later_by_ == 0 && seen == forged_) return forge(channel, message);
                  if (later_by_ != 0 && seen >= forged_ && has_tick(channel))
                    return delay(channel, message);
                  out_->add_message(channels_[channel.id], message.log_time_ns, message.data);
                  if (out_->chunk_is_full()) out_->end_chunk();
                },
            .on_attachment =
                [this](const McapAttachment& attachment) {
                  out_->add_attachment(attachment.name, attachment.media_type, attachment.data,
                                       attachment.log_time_ns);
                },
            .on_metadata = [this](const std::string& name,
                                  const auto& values) { out_->add_metadata(name, values); }};
  }

  static bool has_tick(const McapChannel& channel) {
    return channel.topic == log_layout::kDecisions || channel.topic == log_layout::kIncrements ||
           channel.topic == log_layout::kPoses || channel.topic == log_layout::kTicks;
  }
  void delay(const McapChannel& channel, const McapMessage& message) {
    ByteReader reader(message.data);
    ByteWriter bytes;
    bytes.varint(reader.varint() + later_by_);
    bytes.raw(reader.raw(reader.left()));
    out_->add_message(channels_[channel.id], message.log_time_ns, bytes.bytes());
  }

  // Its tick, its time, or eight of its bytes.
  void forge(const McapChannel& channel, const McapMessage& message) {
    std::uint64_t time_ns = message.log_time_ns;
    ByteWriter bytes;
    switch (random_() % 3) {
      case 0: {
        ByteReader reader(message.data);
        reader.varint();
        bytes.varint(absurd(random_));
        bytes.raw(reader.raw(reader.left()));
        break;
      }
      case 1:
        time_ns = absurd(random_);
        bytes.raw(message.data);
        break;
      default: {
        const std::size_t at = random_() % message.data.size();
        bytes.raw(message.data.first(at));
        bytes.u64(absurd(random_));
        if (at + 8 < message.data.size()) bytes.raw(message.data.subspan(at + 8));
      }
    }
    out_->add_message(channels_[channel.id], time_ns, bytes.bytes());
  }

  Random& random_;
  std::unique_ptr<McapWriter> out_;
  std::map<std::uint16_t, std::uint16_t> schemas_, channels_;
  std::uint64_t later_by_ = 0;  ///< 0: one message is forged
  std::uint64_t seen_ = 0, forged_ = 0;
};

/// What was played, and what is said of it once its log was changed.
class LogReplayFuzz : public testing::Test {
 protected:
  void SetUp() override {
    for (std::uint64_t i = 1; i <= kPlayedTicks; ++i) {
      session_.tick();
      states_[i] = encode_state(session_.scene.world);
      hashes_[i] = session_.ticks.back().report.state_hash;
      if (i % 25 == 0) session_.ticks.back().state = [bytes = states_[i]] { return bytes; };
    }
    auto writer = SessionLogWriter::create(whole_.path(), session_.header, {.chunk_bytes = 2048});
    ASSERT_TRUE(writer) << writer.error().text;
    for (const TickRecord& tick : session_.ticks) (*writer)->record(tick);
    ASSERT_TRUE((*writer)->close());
    bytes_ = file_bytes(whole_.path());
  }

  void write(const std::string& bytes) const {
    std::ofstream(changed_.path(), std::ios::binary) << bytes;
  }
  /// Of the changed file. Empty: all of it is refused, or told, or true.
  std::string what_is_wrong() {
    const double begun_s = cpu_s();
    std::string wrong = what_verify_hides();
    if (wrong.empty()) wrong = what_restore_hides();
    if (wrong.empty()) wrong = what_recover_hides();
    longest_s_ = std::max(longest_s_, cpu_s() - begun_s);
    return wrong;
  }
  std::size_t told_ = 0, unharmed_ = 0, refused_ = 0, restored_ = 0;
  double longest_s_ = 0.0;
  bool forged_ = false;
  test::RandomSession session_{4};
  const test::TemporaryFile whole_{"replay_fuzz_whole.mcap"}, changed_{"replay_fuzz.mcap"};
  std::string bytes_;

 private:
  std::string what_verify_hides() {
    const auto log = read_session_log(changed_.path());
    if (!log) return ++refused_, log.error().text.empty() ? "refused without a word" : "";
    std::string wrong;
    std::uint64_t last = 0;
    const auto report = verify(*log, 1, [&](const World& world, const StepReport& step) {
      if (step.tick > kPlayedTicks) return;
      if (is_as_played(world, step.state_hash)) last = step.tick;
    });
    if (!report) return ++refused_, report.error().text.empty() ? "refused without a word" : "";
    const bool told = report->difference || !report->not_verifiable.empty() ||
                      !log->notes.empty() || !log->gaps.empty();
    ++(told ? told_ : unharmed_);
    if (told) return wrong;
    if (report->ticks_compared != session_.ticks.size())
      return "ticks are missing, and nothing is said";
    if (last != kPlayedTicks || report->verified_to_tick != kPlayedTicks)
      return "verified, and it is another session";
    return wrong;
  }

  // What a server would go on with.
  std::string what_restore_hides() {
    const auto log = read_session_log(changed_.path(), {.keep_checkpoints = 2});
    if (!log) return "";
    auto at = scene_at_last_checkpoint(*log);
    if (!at) return at.error().text.empty() ? "not restored, without a word" : "";
    World& world = at->scene.world;
    const auto resumed = resume_from(*log, world, 1, false);
    if (!resumed) return resumed.error().text.empty() ? "not restored, without a word" : "";
    ++restored_;
    const bool told = !log->notes.empty() || !log->gaps.empty() || !at->notes.empty() ||
                      resumed->ticks_left_out > 0;
    if (!told && world.tick != kPlayedTicks)
      return "restored to tick " + std::to_string(world.tick) + ", and nothing is said";
    // Ticks without input may follow; what was played is as it was.
    if (world.tick != 0 && world.tick <= kPlayedTicks &&
        !is_as_played(world, state_hash(world, *world.state)))
      return "tick " + std::to_string(world.tick) + " is restored as another one";
    return "";
  }

  // What is called verified is what was played.
  std::string what_recover_hides() const {
    const test::TemporaryFile out("replay_fuzz_out.mcap");
    const auto recovery = recover_session_log(changed_.path(), out.path());
    if (!recovery || !recovery->not_replayable.empty()) return "";
    if (recovery->differs != !recovery->not_verified.empty() && recovery->differs)
      return "it differs, and nobody says where";
    const auto log = read_session_log(out.path());
    if (!log) return "recovered to what nobody can read";
    for (const TickRecord& tick : log->ticks)
      if (tick.tick <= recovery->verified_to_tick && tick.tick <= kPlayedTicks &&
          tick.report.state_hash != hashes_.at(tick.tick))
        return "tick " + std::to_string(tick.tick) + " is recovered as another one";
    return "";
  }

  // Who writes checksums that fit can say anything of what the hash of a tick does not cover.
  bool is_as_played(const World& world, std::uint64_t hash) {
    return forged_ ? hash == hashes_.at(world.tick) : encode_state(world) == states_[world.tick];
  }
  std::map<std::uint64_t, std::vector<std::byte>> states_;  ///< by tick
  std::map<std::uint64_t, std::uint64_t> hashes_;
};

TEST_F(LogReplayFuzz, WhatIsNotToldIsWhatWasPlayed) {
  write(bytes_);
  ASSERT_EQ(what_is_wrong(), "");
  ASSERT_EQ(unharmed_, 1U);
  ASSERT_EQ(restored_, 1U);
  Random random(20'261'126);
  for (int i = 0; i < test::effort(50); ++i) {
    forged_ = i % 5 > 2;
    switch (i % 5) {
      case 0:
        write(test::mutated(bytes_, random));
        break;
      case 1:
        write(reordered(bytes_, random));
        break;
      case 2:
        write(lengthened(bytes_, random));
        break;
      default:
        Forger(whole_.path(), changed_.path(), i % 5 == 4, random);
    }
    EXPECT_EQ(what_is_wrong(), "") << "mutation " << i;
    ASSERT_TRUE(!test::timed() || longest_s_ < kMost_s) << "mutation " << i;
  }
  RecordProperty("longest_ms", static_cast<int>(longest_s_ * 1e3));
  std::printf("%zu told, %zu refused, %zu unharmed; the longest took %.2f s\n", told_, refused_,
              unharmed_, longest_s_);
  EXPECT_GT(told_, 10U);
  EXPECT_GT(restored_, 5U);
}

/// The comparison sees what it is to see: a tick that was played otherwise, with good checksums.
TEST_F(LogReplayFuzz, APlantedLieIsSeen) {
  std::vector<TickRecord> ticks = session_.ticks;
  ticks.pop_back();
  std::filesystem::remove(changed_.path());
  auto writer = SessionLogWriter::create(changed_.path(), session_.header, {});
  ASSERT_TRUE(writer) << writer.error().text;
  for (const TickRecord& tick : ticks) (*writer)->record(tick);
  ASSERT_TRUE((*writer)->close());
  EXPECT_NE(what_is_wrong(), "") << "its last tick is gone";
}

}  // namespace
}  // namespace mortise
