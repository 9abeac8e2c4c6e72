#include "server/tick_loop.h"
#include "common/session/world/decisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <memory>
#include <thread>

#include "common/messages/memory_channel.h"
#include "common/messages/mesh_bytes.h"
#include "tests/unit/server/small_world.h"

namespace mortise {
namespace {

using namespace mortise::testing;

/// Time passes only by sleeping, and by `tick_cost_ns` each time it is read inside a tick.
class FakeClock : public Clock {
 public:
  std::int64_t now_ns() override { return now_ns_ += cost_per_reading_ns_; }
  std::int64_t wall_ns() override { return now_ns_; }
  void sleep_until_ns(std::int64_t deadline_ns) override {
    now_ns_ = std::max(now_ns_, deadline_ns);
  }
  void pass(std::int64_t ns) { now_ns_ += ns; }
  void cost_per_reading_ns(std::int64_t ns) { cost_per_reading_ns_ = ns; }

 private:
  std::int64_t now_ns_ = 100 * kSecond_ns;
  std::int64_t cost_per_reading_ns_ = 0;
};

class FakeLog : public SessionLogWriter {
 public:
  void record(TickRecord record) override { records.push_back(std::move(record)); }
  Status close() override { return ok(); }
  std::uint64_t dropped_ticks() const override { return 0; }
  std::uint64_t bytes_written() const override { return 0; }
  Status status() const override { return ok(); }
  std::vector<TickRecord> records;
};

/// What a participant knows, kept from the raw channel in the way that any client would.
struct Participant {
  std::unique_ptr<ClientChannel> channel;
  UserId user;
  std::uint64_t seq = 0, command_seq = 0;
  std::map<PartId, Pose> poses;
  std::map<PartId, UserId> holders;
  std::map<ClashId, ClashEvent> open;
  std::uint64_t event_seq = 0;
  std::vector<ClashEvent> events;
  std::vector<Reply> replies;
  std::vector<RefusedIncrement> refused;
  std::vector<SessionPulse> pulses;
  std::vector<MeshBytes> meshes;
  std::vector<FeatureTable> features;
  std::size_t snapshots = 0, batches = 0;
  bool knows = false;

  void take() {
    ClientInput input = channel->take();
    for (const JoinReply& reply : input.join_replies) user = reply.user;
    for (const Snapshot& snapshot : input.snapshots) {
      ++snapshots;
      if (knows) continue;
      knows = true;
      event_seq = snapshot.event_seq;
      for (const PartInfo& part : snapshot.parts) {
        poses[part.part] = part.X_WP;
        holders[part.part] = part.holder;
      }
      for (const ClashEvent& clash : snapshot.open_clashes) open[clash.clash] = clash;
    }
    for (const ClashEvent& event : input.events) {
      if (!knows || event.seq <= event_seq) continue;
      EXPECT_EQ(event.seq, event_seq + 1) << "the live stream has a gap";
      event_seq = event.seq;
      events.push_back(event);
      if (event.kind == ClashEvent::Kind::kEnd) {
        open.erase(event.clash);
      } else {
        open[event.clash] = event;
      }
    }
    for (const PoseBatch& batch : input.poses) {
      ++batches;
      for (const PartPose& part : batch.parts) {
        poses[part.part] = part.X_WP;
        holders[part.part] = part.holder;
      }
    }
    replies.insert(replies.end(), input.replies.begin(), input.replies.end());
    refused.insert(refused.end(), input.refused.begin(), input.refused.end());
    pulses.insert(pulses.end(), input.pulses.begin(), input.pulses.end());
    for (MeshBytes& mesh : input.meshes) meshes.push_back(std::move(mesh));
    for (FeatureTable& table : input.features) features.push_back(std::move(table));
  }
  void grab(PartId part) { channel->send(Command{user, part, ++command_seq, CommandKind::kGrab}); }
  void release(PartId part) {
    channel->send(Command{user, part, ++command_seq, CommandKind::kRelease});
  }
  void move(PartId part, const Vec3& by) {
    channel->send(batch_of(Increment{user, part, ++seq, by, Vec3::Zero()}, 0));
  }
};

class TickLoopTest : public ::testing::Test {
 protected:
  void SetUp() override {
    world_.policy = Policy::kReport;
    server_ = hub_.open_server();
    loop_ = std::make_unique<TickLoop>(world_, *server_, clock_, &log_, TickLoopOptions{});
    loop_->open();
  }
  Participant join(const std::string& name) {
    Participant participant;
    participant.channel = hub_.open_client();
    participant.channel->join(1, name, "designer");
    tick();
    participant.take();
    EXPECT_TRUE(participant.user) << name;
    EXPECT_TRUE(participant.knows) << name << " got no snapshot";
    return participant;
  }
  void tick() {
    clock_.pass(kSecond_ns / 60);
    loop_->tick();
  }
  void expect_equal(const Participant& a, const Participant& b) {
    ASSERT_EQ(a.poses.size(), b.poses.size());
    for (const auto& [part, pose] : a.poses) {
      EXPECT_TRUE(identical(pose, b.poses.at(part))) << part.value;
      EXPECT_EQ(a.holders.at(part), b.holders.at(part));
    }
    ASSERT_EQ(a.open.size(), b.open.size());
    for (const auto& [id, clash] : a.open) {
      ASSERT_TRUE(b.open.contains(id));
      const ClashEvent& other = b.open.at(id);
      EXPECT_EQ(clash.verdict.collision_class, other.verdict.collision_class);
      EXPECT_EQ(clash.verdict.delta_mm, other.verdict.delta_mm);
      EXPECT_EQ(clash.part_a, other.part_a);
      EXPECT_EQ(clash.part_b, other.part_b);
      EXPECT_EQ(clash.begin_tick, other.begin_tick);
    }
    EXPECT_EQ(a.event_seq, b.event_seq);
  }

  MemoryHub hub_;
  World world_ = small_world();
  FakeClock clock_;
  FakeLog log_;
  std::unique_ptr<ServerChannel> server_;
  std::unique_ptr<TickLoop> loop_;
};

TEST_F(TickLoopTest, AJoinBringsSnapshotAndMeshOncePerContent) {
  Participant anna = join("anna");
  EXPECT_EQ(anna.poses.size(), 3U);
  ASSERT_EQ(anna.meshes.size(), 1U) << "three parts share one mesh";
  EXPECT_EQ(anna.meshes[0].hash, world_.parts[0].solid->hash());
  const auto mesh = mesh_from_bytes(anna.meshes[0].bytes);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->points_mm.size(), 8U);
  EXPECT_EQ(mesh->triangles, world_.parts[0].solid->mesh().triangles);
}

TEST_F(TickLoopTest, FeaturesAreToldAtOnceAndAgainWhenMeshesWereLookedAt) {
  Participant anna = join("anna");
  std::vector<FeatureTable> told = anna.features;
  // The cube is looked at by another thread; what it shows is told with the next tick.
  for (int i = 0; i < 2000 && (told.empty() || told.back().meshes_waiting > 0); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    tick();
    anna.take();
    told = anna.features;
  }
  ASSERT_FALSE(told.empty());
  ASSERT_EQ(told.back().meshes_waiting, 0U);
  ASSERT_EQ(told.back().sets.size(), 1U);
  EXPECT_EQ(told.back().sets[0].parts.size(), 3U);
  EXPECT_EQ(told.back().sets[0].features.size(), 6U) << "the faces of a cube";
  const std::size_t tables = told.size();
  for (int i = 0; i < 200; ++i) tick();
  Participant ben = join("ben");
  EXPECT_EQ(ben.features.size(), 1U) << "one table is kept for who comes late";
  anna.take();
  EXPECT_EQ(anna.features.size(), tables) << "what does not change is not told again";
}

TEST_F(TickLoopTest, MovesReachEveryoneWithHolderAndAck) {
  Participant anna = join("anna"), ben = join("ben");
  anna.grab(kRed);
  tick();
  anna.move(kRed, {0, 3, 0});
  anna.move(kRed, {0, 4, 0});
  tick();
  anna.take();
  ben.take();
  EXPECT_EQ(ben.poses[kRed].p.y(), 7.0);
  EXPECT_EQ(ben.holders[kRed], anna.user);
  ASSERT_EQ(anna.replies.size(), 1U);
  EXPECT_EQ(anna.replies[0].refusal, Refusal::kNone);
  EXPECT_EQ(loop_->inbox().counters().accepted, 2U);
}

TEST_F(TickLoopTest, NothingIsSentWhileNothingHappens) {
  Participant anna = join("anna");
  for (int i = 0; i < 30; ++i) tick();
  anna.take();
  EXPECT_EQ(anna.batches, 0U);
  const std::size_t snapshots = anna.snapshots;
  for (int i = 0; i < 240; ++i) {
    tick();
    anna.take();
  }
  EXPECT_LE(anna.snapshots, snapshots + 1) << "at most the one after the join";
  EXPECT_EQ(anna.pulses.size(), 4U);
  EXPECT_EQ(loop_->statistics().counters().first_contact_queries, 0U);
  EXPECT_EQ(loop_->statistics().counters().depth_queries, 0U);
}

TEST_F(TickLoopTest, ADrainIsToldAtOnceAndOnlyThen) {
  Participant anna = join("anna");
  for (int i = 0; i < 90; ++i) tick();
  anna.take();
  ASSERT_FALSE(anna.pulses.empty());
  EXPECT_FALSE(anna.pulses.back().draining);
  loop_->begin_drain();
  tick();
  anna.take();
  EXPECT_TRUE(anna.pulses.back().draining);
  const std::size_t before = anna.pulses.size();
  loop_->last_tick(false);
  anna.take();
  EXPECT_EQ(anna.pulses.size(), before + 1) << "also those who have come since";
}

TEST_F(TickLoopTest, TheEndIsTold) {
  Participant anna = join("anna");
  for (int i = 0; i < 90; ++i) tick();
  loop_->close();
  anna.take();
  ASSERT_FALSE(anna.pulses.empty());
  EXPECT_TRUE(anna.pulses.back().draining);
}

TEST_F(TickLoopTest, AKeyframeFollowsAChangeWithinASecond) {
  Participant anna = join("anna");
  for (int i = 0; i < 120; ++i) tick();
  anna.take();
  anna.grab(kRed);
  tick();
  anna.move(kRed, {0, 1, 0});
  const std::size_t before = anna.snapshots;
  for (int i = 0; i < 62; ++i) tick();
  anna.take();
  EXPECT_GE(anna.snapshots, before + 1);
}

TEST_F(TickLoopTest, ClashesBeginAndEndForAllAndALateJoinerKnowsTheSame) {
  Participant anna = join("anna"), ben = join("ben");
  anna.grab(kRed);
  ben.grab(kBlue);
  tick();
  for (int i = 0; i < 6; ++i) {
    anna.move(kRed, {-2, 0.1, 0});   // 20 -> 8: overlaps the wall by 2
    ben.move(kBlue, {1.9, 0, 0.2});  // -20 -> -8.6
    tick();
  }
  anna.take();
  ben.take();
  ASSERT_EQ(anna.open.size(), 2U);
  for (const auto& [id, clash] : anna.open) {
    EXPECT_EQ(clash.verdict.collision_class, CollisionClass::kReal);
  }

  // The late one joins while everything moves on.
  Participant late;
  late.channel = hub_.open_client();
  late.channel->join(1, "late", "observer");
  for (int i = 0; i < 20; ++i) {
    anna.move(kRed, {i < 5 ? -0.1 : 0.4, 0, 0});
    ben.move(kBlue, {i % 2 ? 0.1 : -0.1, 0, 0});
    tick();
    if (i % 3 == 0) late.take();
  }
  anna.take();
  ben.take();
  late.take();
  EXPECT_GE(anna.events.size(), 3U);
  EXPECT_EQ(anna.events.back().kind, ClashEvent::Kind::kEnd);
  expect_equal(anna, ben);
  expect_equal(anna, late);
  ASSERT_EQ(anna.events.size(), ben.events.size());
  for (std::size_t i = 0; i < anna.events.size(); ++i) {
    EXPECT_EQ(anna.events[i].clash, ben.events[i].clash);
    EXPECT_EQ(anna.events[i].verdict.delta_mm, ben.events[i].verdict.delta_mm);
  }
}

TEST_F(TickLoopTest, EveryTickIsInTheLogAndPlaysAgainToTheSameHashes) {
  World again = small_world();
  again.policy = Policy::kReport;
  Participant anna = join("anna");
  anna.grab(kRed);
  tick();
  for (int i = 0; i < 10; ++i) {
    anna.move(kRed, {-1.5, 0.2, 0.1});
    tick();
  }
  anna.release(kRed);
  tick();
  for (int i = 0; i < 5; ++i) tick();

  loop_->close();  // the last tick is handed over
  ASSERT_EQ(log_.records.size(), loop_->metrics().ticks);
  Scratch scratch;
  for (const TickRecord& record : log_.records) {
    for (const Decision& decision : record.decisions) apply_decision(again, decision);
    const StepReport report = step(again, record.increments, scratch);
    ASSERT_EQ(report.tick, record.tick);
    ASSERT_EQ(report.state_hash, record.report.state_hash) << "tick " << record.tick;
  }
  EXPECT_FALSE(again.find(kRed)->holder);
}

TEST_F(TickLoopTest, AKilledClientLosesItsPartAndTheSessionGoesOn) {
  Participant anna = join("anna");
  const ClientKey key = hub_.last_client();
  Participant ben = join("ben");
  anna.grab(kRed);
  tick();
  anna.move(kRed, {0, 1, 0});
  tick();
  hub_.kill(key);
  tick();
  tick();
  ben.take();
  EXPECT_FALSE(ben.holders[kRed]);
  EXPECT_EQ(loop_->inbox().counters().liveliness_lost, 1U);
  ben.grab(kRed);
  tick();
  ben.take();
  EXPECT_EQ(ben.holders[kRed], ben.user);
}

TEST_F(TickLoopTest, NonsenseIsRefusedWithAReasonAndTheSessionGoesOn) {
  Participant anna = join("anna"), ben = join("ben");
  anna.grab(kRed);
  tick();
  ben.move(kRed, {1, 0, 0});     // not the holder
  anna.move(kRed, {1e9, 0, 0});  // jump
  anna.channel->send(
      batch_of(Increment{anna.user, kRed, 1, {1, 0, 0}, Vec3::Zero()}, 0));  // replayed
  ben.channel->send(
      batch_of(Increment{anna.user, kRed, 9, {1, 0, 0}, Vec3::Zero()}, 0));  // foreign user
  anna.move(kRed, {0, 0, 2});
  tick();
  anna.take();
  ben.take();
  EXPECT_EQ(ben.poses[kRed].p, Vec3(20, 0, 2));
  EXPECT_EQ(loop_->inbox().counters().refused_in_all(), 4U);
  EXPECT_EQ(loop_->pulse().refused, 4U);
  EXPECT_FALSE(anna.refused.empty());
  EXPECT_FALSE(ben.refused.empty());
}

TEST_F(TickLoopTest, AJumpOfTheSendersClockChangesNoFigureAndNoMotion) {
  Participant anna = join("anna");
  anna.grab(kRed);
  tick();
  const std::int64_t hour_ns = 3600 * kSecond_ns;
  const std::int64_t jumps[] = {0,
                                hour_ns,
                                -hour_ns,
                                std::numeric_limits<std::int64_t>::min(),
                                std::numeric_limits<std::int64_t>::max(),
                                0};
  for (const std::int64_t jump_ns : jumps) {
    for (std::int64_t i = 1; i <= 3; ++i) {
      const Increment increment{anna.user, kRed, ++anna.seq, {0, 1, 0}, Vec3::Zero()};
      anna.channel->send(batch_of(increment, jump_ns == 0 ? clock_.now_ns() : jump_ns));
      tick();
    }
  }
  EXPECT_EQ(world_.find(kRed)->X_WP.p.y(), 18.0);
  EXPECT_EQ(loop_->inbox().counters().accepted, 18U);
  EXPECT_LT(loop_->metrics().delay.max_us(), 1e6);
}

TEST_F(TickLoopTest, DeadlinesAreAbsoluteAndOverloadIsCounted) {
  int ticks = 0;
  clock_.cost_per_reading_ns(0);
  loop_->run([&] { return ticks >= 60; }, [&] { ++ticks; });
  EXPECT_EQ(loop_->metrics().overloads, 0U);
  EXPECT_EQ(loop_->metrics().missed_deadlines, 0U);
  const double idle_s = loop_->seconds();
  EXPECT_NEAR(idle_s, 59.0 / 60.0, 1e-3);

  // Each tick takes 2.5 periods: of five deadlines two are kept, and lateness does not pile up.
  ticks = 0;
  loop_->run([&] { return ticks >= 10; },
             [&] {
               ++ticks;
               clock_.pass(5 * kSecond_ns / 120);
             });
  EXPECT_EQ(loop_->metrics().overloads, 10U);
  EXPECT_EQ(loop_->metrics().missed_deadlines, 15U);
  EXPECT_EQ(loop_->pulse().missed_deadlines, 15U) << "what clients are told";
  EXPECT_LE(loop_->metrics().lateness.max_us(), 1e6 / 60.0);
}

}  // namespace
}  // namespace mortise
