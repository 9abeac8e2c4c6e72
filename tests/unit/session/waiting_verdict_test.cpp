// What waits for work is told in the end: random sessions with little work a tick, and decisions in
// the middle of it, come to the verdicts that a fresh session gives for the parts as they stand.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>

#include "common/session/tick/tick_work.h"
#include "tests/support/shapes.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

// Pegs of Ø6 in bores of a plate each, their fit stated as tolerances of the peg.
struct Bores {
  SessionBuilder session;
  Scratch scratch;
  std::vector<UserId> users;
  std::vector<PartId> pegs;
  std::mt19937_64 random;

  Bores(Policy policy, std::uint64_t seed, int count = 5) : session(policy), random(seed) {
    session.world.tick_rate_hz = 1000.0;  // the least work that a tick may have
    for (int i = 0; i < 3; ++i)
      users.push_back(session.join(std::string("user").append(std::to_string(i))));
    const TriangleMesh plate =
        shapes::ring({.radius_mm = 3.0, .z0_mm = -4.0, .z1_mm = 4.0, .n = 16}, 8.0);
    const TriangleMesh peg = shapes::peg({.radius_mm = 3.0, .z0_mm = -5.0, .z1_mm = 5.0, .n = 16});
    for (int i = 0; i < count; ++i) {
      session.add("plate", plate, at(20.0 * i, 0, 0), false);
      pegs.push_back(session.add("peg", peg, at(20.0 * i, 0, 0.2), true));
      state_fit(i);
      session.grab(user_of(i), pegs.back());
    }
  }
  UserId user_of(int i) const { return users[static_cast<std::size_t>(i) % users.size()]; }
  double u() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); }

  // Clearance, transition or interference.
  void state_fit(int i) {
    const double middle_mm = 0.05 * (static_cast<double>(random() % 3) - 1.0);
    SurfaceBand& band = session.world.find(pegs[static_cast<std::size_t>(i)])->band;
    session.set_tolerance(pegs[static_cast<std::size_t>(i)], 0.02);
    band.faces[0].tolerance_mm = {middle_mm - 0.02, middle_mm + 0.02};
    band.largest_offset_mm = middle_mm + 0.02;
    note_surface(session.world, pegs[static_cast<std::size_t>(i)], PartId{}, Decision{});
  }
  void decide() {
    const int i = static_cast<int>(random() % pegs.size());
    const PartId peg = pegs[static_cast<std::size_t>(i)], plate{peg.value - 1};
    if (random() % 3 != 0) return state_fit(i);
    PairRule& rule = session.world.pair_rules[{plate, peg}];
    rule.excluded = !rule.excluded;
    note_surface(session.world, plate, peg, Decision{});
  }
  StepReport push() {
    std::vector<Increment> increments;
    for (int i = 0; i < static_cast<int>(pegs.size()); ++i) {
      const PartId peg = pegs[static_cast<std::size_t>(i)];
      if (random() % 4 == 0) continue;
      const double size_mm = random() % 2 ? 0.1 : 0.01;
      increments.push_back(
          session.push(user_of(i), peg, size_mm * Vec3(u(), u(), u()),
                       random() % 2 ? Vec3(0.002 * Vec3(u(), u(), u())) : Vec3::Zero()));
    }
    return play_tick(session.world, increments, scratch);
  }
  StepReport rest() { return play_tick(session.world, {}, scratch); }
};

// The worst class of every pair.
using Classes = std::map<std::pair<std::uint32_t, std::uint32_t>, CollisionClass>;
Classes classes_of(const World& world) {
  Classes classes;
  for (const ClashEvent& clash : snapshot_of(world).open_clashes) {
    CollisionClass& worst = classes[{clash.part_a.value, clash.part_b.value}];
    worst = std::max(worst, clash.verdict.collision_class);
  }
  return classes;
}

Classes afresh(const World& world) {
  World copy;
  copy.name = world.name;
  copy.policy = world.policy;
  copy.tick_rate_hz = world.tick_rate_hz;
  copy.evaluates = world.evaluates;
  copy.parts = world.parts;
  copy.pair_rules = world.pair_rules;
  Scratch scratch;
  play_tick(copy, {}, scratch);
  return classes_of(copy);
}

std::string text_of(const Classes& classes) {
  std::string text;
  for (const auto& [pair, of] : classes)
    text += std::to_string(pair.second) + ":" + std::to_string(static_cast<int>(of)) + " ";
  return text;
}

TEST(WaitingVerdict, AtRestEverybodyIsToldWhatAFreshSessionSays) {
  std::uint64_t waiting = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Bores play(Policy::kReport, seed);
    for (int i = 0; i < 40; ++i) {
      if (i % 5 == 2) play.decide();
      waiting += play.push().counters.pairs_waiting;
    }
    int ticks = 0;
    while (!play.session.world.state->owed.empty() && ticks < 400) ++ticks, play.rest();
    EXPECT_LT(ticks, 400) << "seed " << seed << ": something is owed for ever";
    EXPECT_EQ(text_of(classes_of(play.session.world)), text_of(afresh(play.session.world)))
        << "seed " << seed;
  }
  EXPECT_GT(waiting, 100U) << "nobody had to wait: nothing is shown";
}

// Under stop what held a part back stays told; but what is decided in the end is judged as the
// parts stand, whatever was told before.
TEST(WaitingVerdict, AfterADecisionWhatWasToldBeforeDoesNotStay) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Bores play(Policy::kStop, seed);
    for (int i = 0; i < 40; ++i) {
      if (i % 5 == 2) play.decide();
      play.push();
    }
    for (std::size_t i = 0; i < play.pegs.size(); ++i) play.state_fit(static_cast<int>(i));
    play.push();
    int ticks = 0;
    do ++ticks, play.rest();
    while (!play.session.world.state->owed.empty() && ticks < 400);
    EXPECT_LT(ticks, 400) << "seed " << seed << ": something is owed for ever";
    Classes told = classes_of(play.session.world), fresh = afresh(play.session.world);
    // A push after the decision may have met something that is not to be seen where it ended.
    for (const auto& [pair, of] : told)
      if (of == CollisionClass::kReal) fresh[pair] = std::max(fresh[pair], of);
    EXPECT_EQ(text_of(told), text_of(fresh)) << "seed " << seed;
  }
}

}  // namespace
}  // namespace mortise
