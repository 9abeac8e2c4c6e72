// A checkpoint holds all that a session is: from any of them it goes on as if it had never stopped,
// bit for bit, to its end.
#include "common/io/state/checkpoint.h"
#include "common/io/state/state_fields.h"

#include <algorithm>
#include <cstring>

#include "common/io/log/log_checkpoint.h"
#include "common/session/memory/session_state.h"
#include "tests/support/ball_bed.h"
#include "tests/support/effort.h"
#include "tests/unit/io/random_session.h"
#include "tests/unit/session/report_digest.h"

namespace mortise {
namespace {

using test::BallBed;
using test::random_scene;
using test::RandomSession;

struct Saved {
  std::size_t ticks = 0;
  std::vector<std::byte> bytes;
};

bool same_counts(const StepCounters& x, const StepCounters& y) {
  return std::memcmp(&x, &y, sizeof x) == 0;  // nothing but whole numbers of eight bytes
}

struct Played {
  std::unique_ptr<RandomSession> session;
  std::vector<Saved> saved;
};

// Saved every so many ticks, by `shift` ticks earlier.
Played play(std::uint64_t seed, int ticks, int every, std::uint64_t shift = 0, bool edits = false) {
  Played played{std::make_unique<RandomSession>(seed, 3, edits), {}};
  for (int i = 1; i <= ticks; ++i) {
    played.session->tick();
    if ((static_cast<std::uint64_t>(i) + shift) % static_cast<std::uint64_t>(every) == 0)
      played.saved.push_back(
          {static_cast<std::size_t>(i), encode_state(played.session->scene.world)});
  }
  return played;
}

// Where the session that goes on from these bytes first differs; -1: nowhere.
int first_difference(const RandomSession& session, const Saved& saved, std::string& what) {
  auto scene = random_scene();
  for (const auto& [hash, mesh] : session.scene.world.shapes->meshes())
    scene->world.shapes->add(mesh.solid, 0.0);
  if (Status restored = restore_state(scene->world, saved.bytes); !restored) {
    what = restored.error().text;
    return 0;
  }
  if (encode_state(scene->world) != saved.bytes) {
    what = "its bytes are other ones";
    return 0;
  }
  Scratch scratch;
  for (std::size_t i = saved.ticks; i < session.ticks.size(); ++i) {
    const TickRecord& record = session.ticks[i];
    for (const Decision& decision : record.decisions) apply_decision(scene->world, decision);
    const StepReport report = step(scene->world, record.increments, scratch);
    if (digest(report) != digest(record.report)) what = "what is told";
    if (!same_counts(report.counters, record.report.counters)) what += " how it was worked out";
    if (!what.empty()) return static_cast<int>(record.tick);
  }
  if (encode_state(scene->world) == encode_state(session.scene.world)) return -1;
  what = "the last state";
  return static_cast<int>(session.ticks.size());
}

TEST(Checkpoint, FromEachOneRandomSessionsGoOnToTheSameEnd) {
  std::size_t accepted[kCommandKindCount] = {}, events = 0, waiting = 0, held = 0, slid = 0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::effort(16)); ++seed) {
    // In each after another tick.
    const Played played = play(seed, 160, 160, 5 + seed % 31 * 5);
    for (std::size_t k = 0; k < kCommandKindCount; ++k) accepted[k] += played.session->accepted[k];
    for (const TickRecord& record : played.session->ticks) {
      events += record.report.events.size();
      waiting += record.report.counters.pairs_waiting;
      held += record.report.counters.pairs_held_again;
      slid += record.report.counters.slid_parts;
    }
    for (const Saved& saved : played.saved) {
      std::string what;
      EXPECT_EQ(first_difference(*played.session, saved, what), -1)
          << "seed " << seed << ", checkpoint after tick " << saved.ticks << ": " << what;
    }
  }
  // Else it would show too little.
  EXPECT_GT(events, 200U);
  EXPECT_GT(waiting, 10U) << "work was never short";
  EXPECT_GT(held, 10U);
  EXPECT_GT(slid, 10U);
  for (const CommandKind kind :
       {CommandKind::kGrab, CommandKind::kRelease, CommandKind::kUndo, CommandKind::kRedo,
        CommandKind::kReset, CommandKind::kSetPolicy, CommandKind::kSetTolerance,
        CommandKind::kSetExclusion, CommandKind::kDropExclusion, CommandKind::kReview,
        CommandKind::kAddConstraint, CommandKind::kConsent, CommandKind::kWithdraw})
    EXPECT_GT(accepted[static_cast<std::size_t>(kind)], 0U) << static_cast<int>(kind);
}

// Where parts come and go as well.
TEST(Checkpoint, OfEditedScenesTheyGoOnToTheSameEnd) {
  std::size_t accepted[kCommandKindCount] = {}, gone = 0, added = 0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::effort(4)); ++seed) {
    const Played played = play(seed, 120, 120, 5 + seed % 23 * 5, true);
    for (std::size_t k = 0; k < kCommandKindCount; ++k) accepted[k] += played.session->accepted[k];
    const std::vector<Part>& parts = played.session->scene.world.parts;
    gone += static_cast<std::size_t>(
        std::ranges::count_if(parts, [](const Part& part) { return !part.present; }));
    added += parts.size() - 8;
    for (const Saved& saved : played.saved) {
      std::string what;
      EXPECT_EQ(first_difference(*played.session, saved, what), -1)
          << "seed " << seed << ", checkpoint after tick " << saved.ticks << ": " << what;
    }
  }
  EXPECT_GT(gone, 3U);
  EXPECT_GT(added, 10U);
  for (const CommandKind kind : {CommandKind::kAddPart, CommandKind::kReplacePart,
                                 CommandKind::kRemovePart, CommandKind::kSetMoving})
    EXPECT_GT(accepted[static_cast<std::size_t>(kind)], 0U) << static_cast<int>(kind);
}

// Each thing that a checkpoint might leave out is missed by the comparison above.
TEST(Checkpoint, WhatIsLeftOutIsNoticed) {
  const Played played = play(3, 240, 40);
  const auto without = [&](const Saved& saved, const auto& forget) {
    auto scene = random_scene();
    EXPECT_TRUE(restore_state(scene->world, saved.bytes));
    forget(*scene->world.state);
    Saved poorer{saved.ticks, encode_state(scene->world)};
    std::string what;
    return first_difference(*played.session, poorer, what);
  };
  const std::pair<const char*, void (*)(SessionState&)> things[] = {
      {"memos", [](SessionState& state) { state.memos.clear(); }},
      {"what was saved of work", [](SessionState& state) { state.saved_work = 0; }},
      {"what was saved of tests", [](SessionState& state) { state.saved_tests = 0; }},
      {"identities", [](SessionState& state) { ++state.next_clash; }},
      {"open clashes", [](SessionState& state) { state.open.clear(); }},
      {"last movers", [](SessionState& state) {
         for (PartState& part : state.parts) part.last_user = {};
       }}};
  for (const auto& [name, forget] : things) {
    int noticed = 0;
    for (const Saved& saved : played.saved) noticed += without(saved, forget) >= 0 ? 1 : 0;
    EXPECT_GT(noticed, 0) << name;
  }
}

// In slices beside the ticks it comes to the same bytes as in one go.
TEST(Checkpoint, MadeBesideTheTicksItIsTheSame) {
  RandomSession session(7);
  CheckpointMaker maker;
  maker.begin(session.scene.world);
  std::vector<std::pair<StateDraft, std::vector<std::byte>>> made;
  for (int i = 0; i < 200; ++i) {
    session.tick();
    StateDraft draft = maker.after_tick(session.scene.world, i % 9 == 4);
    if (draft) made.emplace_back(std::move(draft), encode_state(session.scene.world));
  }
  ASSERT_GT(made.size(), 10U);
  for (std::size_t i = 0; i < made.size(); ++i) {
    if (i % 3 == 1) continue;  // lost on the way: the next one is whole again
    EXPECT_TRUE(made[i].first() == made[i].second) << i;
  }
}

// One at rest has nothing to copy; what it leaves behind must not lose what the next ones copy.
TEST(Checkpoint, MadeAtOnceAfterOnesAtRestItIsTheSame) {
  RandomSession session(7);
  World& world = session.scene.world;
  CheckpointMaker maker;
  maker.begin(world);
  Scratch scratch;
  int made = 0;
  const auto checkpoint = [&] {
    StateDraft draft = maker.after_tick(world, true);
    while (!draft) {
      step(world, {}, scratch);
      draft = maker.after_tick(world, true);
    }
    EXPECT_TRUE(draft() == encode_state(world)) << "checkpoint " << ++made;
  };
  for (int round = 0; round < 8; ++round) {
    for (int i = 0; i < 15; ++i) session.tick();
    checkpoint();
    for (int i = 0; i < 4; ++i) {  // at rest
      step(world, {}, scratch);
      checkpoint();
    }
  }
}

// Among more pairs than a tick copies, of which most change while it is made: it is made in many
// ticks, has the bytes of the state of its last one, and the session goes on from it.
TEST(Checkpoint, MadeInManySlicesItIsTheSameAndGoesOnTheSame) {
  for (const int still : {0, 5, 7}) {
    BallBed bed(10, still);
    CheckpointMaker maker;
    maker.begin(bed.world());
    std::vector<std::vector<std::byte>> whole;
    std::vector<StateDraft> drafts;
    int due_at = 0, longest = 0;
    for (int i = 1; i <= 420; ++i) {
      bed.tick();
      ASSERT_GT(bed.pairs(), 3U * 256U);
      const bool due = i % 140 == 1;
      if (due) due_at = i;
      StateDraft draft = maker.after_tick(bed.world(), due);
      if (!draft) continue;
      longest = std::max(longest, i - due_at);
      drafts.push_back(std::move(draft));
      whole.push_back(encode_state(bed.world()));
    }
    ASSERT_EQ(drafts.size(), 3U) << still;
    EXPECT_GT(longest, 1) << "it was made in one slice";
    for (std::size_t i = 0; i < drafts.size(); ++i) {
      SCOPED_TRACE(still);
      const std::vector<std::byte> bytes = drafts[i]();
      ASSERT_TRUE(bytes == whole[i]) << i;
      BallBed next(10, still);
      ASSERT_TRUE(restore_state(next.world(), bytes));
      EXPECT_TRUE(encode_state(next.world()) == bytes) << i;
    }
    // From the end of the session: another bed that is restored and goes on beside it.
    const std::vector<std::byte> end = encode_state(bed.world());
    BallBed next(10, still);
    ASSERT_TRUE(restore_state(next.world(), end));
    next.go_on_from(bed);
    for (int i = 0; i < 20; ++i) {
      const StepReport &told = bed.tick(), &again = next.tick();
      ASSERT_EQ(digest(told), digest(again)) << i;
      ASSERT_TRUE(same_counts(told.counters, again.counters)) << i;
    }
    EXPECT_TRUE(encode_state(next.world()) == encode_state(bed.world()));
  }
}

TEST(Checkpoint, BytesThatAreNoStateOfTheSceneAreRefused) {
  const Played played = play(5, 60, 60);
  const std::vector<std::byte>& whole = played.saved.front().bytes;
  std::mt19937_64 random(1);
  std::size_t refused = 0;
  auto loaded = random_scene();
  for (int i = 0; i < 600; ++i) {
    std::vector<std::byte> bytes = whole;
    if (i % 2 == 0) {
      bytes.resize(random() % bytes.size());
    } else {
      for (int flips = 0; flips < 3; ++flips)
        bytes[random() % bytes.size()] ^= std::byte{static_cast<unsigned char>(1 + random() % 255)};
    }
    // A copy shares what is stated of tolerances: what one has made of it is met by the next.
    if (i % 20 == 0) loaded = random_scene();
    ASSERT_TRUE(loaded);
    World world = loaded->world;
    const Status restored = restore_state(world, bytes);
    if (!restored) {
      ++refused;
      EXPECT_FALSE(restored.error().text.empty());
      continue;
    }
    // What passes for a state can be computed with.
    Scratch scratch;
    for (int tick = 0; tick < 2; ++tick) step(world, {}, scratch);
  }
  EXPECT_GT(refused, 300U);
}

// A hostile state may have a good hash. Whatever numbers it names, it is refused or computed with.
TEST(Checkpoint, NumbersWithoutSenseAreRefusedOrComputedWith) {
  const Played played = play(5, 120, 60);
  const std::uint64_t patterns[] = {
      0x7ff8000000000000, 0x7ff0000000000000, 0xfff0000000000000,  // no number, infinities
      0x7fe1ccf385ebc8a0, 0x0000000000000001, 0xbff0000000000000,  // 1e308, the least, -1
      0x42a6bcc41e900000, 0xffffffffffffffff, 0x7fffffffffffffff, 0x00000000ffffffff};
  std::mt19937_64 random(7);
  int computed = 0;
  auto loaded = random_scene();
  for (int i = 0; i < test::effort(400); ++i) {
    std::vector<std::byte> bytes = played.saved[random() % played.saved.size()].bytes;
    for (int places = 0; places < 2; ++places) {
      const std::uint64_t pattern = patterns[random() % std::size(patterns)];
      const std::size_t size = std::size_t{1} << random() % 4;
      std::memcpy(bytes.data() + random() % (bytes.size() - 8), &pattern, size);
    }
    if (i % 20 == 0) loaded = random_scene();
    ASSERT_TRUE(loaded);
    World world = loaded->world;
    if (!restore_state(world, bytes)) continue;
    ++computed;
    Scratch scratch;
    for (std::uint64_t tick = 1; tick <= 3; ++tick) {
      std::vector<Increment> increments;
      for (const Part& part : world.parts)
        if (part.moving && part.holder)
          increments.push_back({part.holder, part.id, (std::uint64_t{1} << 40) + tick,
                                Vec3(0.3, -0.2, -0.5), Vec3(0.01, 0, 0.02)});
      (void)step(world, increments, scratch);
    }
    (void)encode_state(world);
  }
  EXPECT_GT(computed, 20);
}

// Written by a program that did not count them: the last eight bytes of what is counted are
// missing.
TEST(Checkpoint, APairMayHaveWaitedForAnyNumberOfTicks) {
  for (const std::uint32_t waited : {0U, 1U, 254U, 255U, 256U, 70'000U, 4'294'967'295U}) {
    PairMemo::Effort effort{12, waited}, back;
    state_bytes::Writer out;
    out(effort);
    const std::vector<std::byte> bytes = out.take();
    EXPECT_EQ(bytes.size(), waited < 255 ? 5U : 9U) << "older files have a byte";
    state_bytes::Reader in(bytes);
    in(back);
    EXPECT_TRUE(in.at_end());
    EXPECT_EQ(back.waited, waited);
    EXPECT_EQ(back.wanted, 12U);
  }
}

TEST(CheckpointRecord, TotalsOfBeforeLackEventTimesAtLatest) {
  StepReport report;
  report.counters.event_times_at_latest = 3;
  report.counters.not_examined = 2;
  SessionStatistics totals;
  totals.add(report);
  const std::vector<std::byte> bytes = log_records::encode(totals);
  SessionStatistics read;
  ASSERT_TRUE(log_records::decode(bytes, read));
  EXPECT_TRUE(same_counts(read.counters(), totals.counters()));
  ASSERT_TRUE(log_records::decode(std::span(bytes).first(bytes.size() - 8), read));
  EXPECT_EQ(read.counters().event_times_at_latest, 0U);
  EXPECT_EQ(read.counters().not_examined, 2U);
  EXPECT_FALSE(log_records::decode(std::span(bytes).first(bytes.size() - 9), read));
}

}  // namespace
}  // namespace mortise
