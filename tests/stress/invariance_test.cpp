// What must not change the answer: frame, order, direction of time, cutting of ticks, finer meshes.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/effort.h"
#include "tests/support/numbers.h"

namespace mortise::stress {
namespace {

FirstContact solve(const Case& c) {
  thread_local CcdScratch scratch;
  const FloatGuard guard("invariance");
  return first_contact(query_of(c), scratch);
}

bool meets(const FirstContact& c) { return c.state != ContactState::kFree; }

// Two answers to one question agree when at the earlier of their times the parts are within the
// accuracy: neither lies farther before the truth. Measured in accuracies.
void expect_agreement(Sweep& sweep, const Case& c, const FirstContact& x, const FirstContact& y,
                      const std::string& label) {
  if (!meets(x) && !meets(y)) return sweep.measured(0.0, 1.0, label);
  ASSERT_NE(x.state, ContactState::kUndecided) << label;
  ASSERT_NE(y.state, ContactState::kUndecided) << label;
  Oracle oracle(c);
  const double t = std::min(meets(x) ? x.t_contact : 1.0, meets(y) ? y.t_contact : 1.0);
  const Real gap = oracle.gap_mm(t, 100.0L * oracle.accuracy_mm());
  sweep.measured(static_cast<double>(std::max<Real>(gap, 0)) / oracle.accuracy_mm(), 1.0, label);
  // One free, the other not: the parts must pass within the accuracy without meeting.
  if (meets(x) != meets(y)) {
    EXPECT_FALSE(std::isfinite(oracle.first_seen(1.0, 200))) << label;
  }
}

template <class F>
void compare(const char* name, std::uint64_t first_seed, int cases, F other) {
  Sweep sweep(name);
  int contacts = 0;
  for (int i = 0; i < cases; ++i) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
    const Case c = random_case(seed);
    const FirstContact here = solve(c);
    contacts += here.state == ContactState::kContact;
    std::mt19937_64 random(seed);
    expect_agreement(sweep, c, here, other(c, random),
                     std::string(name) + " " + std::to_string(seed));
  }
  EXPECT_GT(contacts, cases / 3);
}

TEST(Invariance, OfTheFrame) {
  compare("same answer: scene moved", 1'100'000, test::effort(150),
          [](const Case& c, auto& random) {
            return solve(
                moved(c, {rotation_exp(random_turn(random, kPi)), random_vector(random, 100.0)}));
          });
}

Case exchanged(const Case& c) {
  Case s = c;
  std::swap(s.a, s.b);
  std::swap(s.motion_a, s.motion_b);
  return s;
}

TEST(Invariance, OfOrder) {
  compare("same answer: A and B exchanged", 1'110'000, test::effort(150),
          [](const Case& c, auto&) { return solve(exchanged(c)); });
}

TEST(Invariance, OfFinerMeshes) {
  compare("same answer: meshes refined", 1'120'000, test::effort(100), [](const Case& c, auto&) {
    Case s = c;
    s.a = testing::solid(refined(c.a->mesh()));
    s.b = testing::solid(refined(refined(c.b->mesh())));
    return solve(s);
  });
}

Motion piece(const Motion& m, double from, double to) {
  return same_path(m, m.pose_at(from), m.pose_at(to), m.reference_P);
}

TEST(Invariance, OfCuttingTheTick) {
  for (const int pieces : {2, 3, 7}) {
    const std::string name = "same answer: tick in " + std::to_string(pieces);
    compare(name.c_str(), 1'130'000, test::effort(60), [&](const Case& c, auto&) {
      FirstContact last;
      for (int k = 0; k < pieces; ++k) {
        Case s = c;
        const double from = static_cast<double>(k) / pieces, to = (k + 1.0) / pieces;
        s.motion_a = piece(c.motion_a, from, to);
        s.motion_b = piece(c.motion_b, from, to);
        last = solve(s);
        // A cut within the accuracy of the contact: found at the start of the next piece.
        last.t_contact = from + last.t_contact / pieces;
        if (meets(last)) break;
      }
      return last;
    });
  }
}

// Between the start and the contact nothing is touched backward, either; the whole way back is free
// where the way there was.
TEST(Invariance, BackwardInTime) {
  Sweep sweep("time reversed (mm)");
  int contacts = 0, frees = 0;
  for (int i = 0; i < test::effort(200); ++i) {
    const std::uint64_t seed = 1'140'000 + static_cast<std::uint64_t>(i);
    const Case c = random_case(seed);
    const FirstContact forward = solve(c);
    Oracle oracle(c);
    double t_end = 1.0;
    if (forward.state == ContactState::kContact) {
      // Back to where they are well apart.
      t_end =
          forward.t_contact - 4.0 * oracle.accuracy_mm() / static_cast<double>(oracle.speed_mm());
      while (t_end > 0.0 && !(oracle.gap_mm(t_end, 1) > 2.0L * oracle.accuracy_mm())) t_end -= 0.01;
      if (t_end <= 0.0) continue;
      ++contacts;
    } else if (forward.state == ContactState::kFree) {
      // Half a turn may come back another way.
      if (std::max(c.motion_a.w_W.norm(), c.motion_b.w_W.norm()) > 3.14) continue;
      if (!(oracle.gap_mm(1.0, 1) > 2.0L * oracle.accuracy_mm())) continue;
      ++frees;
    } else {
      continue;
    }
    Case back = c;
    back.motion_a = piece(c.motion_a, t_end, 0.0);
    back.motion_b = piece(c.motion_b, t_end, 0.0);
    const FirstContact answer = sweep.ask(back, "backward " + std::to_string(seed), 24);
    // On the way the distance may fall below the accuracy without a contact; then both may say so.
    if (answer.state == ContactState::kContact) {
      EXPECT_LE(oracle.gap_mm(t_end * (1.0 - answer.t_contact), 1), oracle.accuracy_mm()) << seed;
    }
  }
  EXPECT_GT(contacts, 60);
  EXPECT_GT(frees, 20);
}

TEST(Invariance, TranslationOfOneIsTheOppositeOfTheOther) {
  Sweep sweep("same answer: relative translation");
  int contacts = 0;
  for (int i = 0; i < test::effort(80); ++i) {
    const std::uint64_t seed = 1'150'000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    Case c = random_case(seed);
    const Pose a0 = c.motion_a.X_W0, b0 = c.motion_b.X_W0;
    const Vec3 v = -1.8 * a0.p + random_vector(random, 1.0);
    const auto go = [](const Pose& X, const Vec3& by) {
      return linear_motion(X, {X.q, X.p + by}, Vec3::Zero());
    };
    c.motion_a = go(a0, v);
    c.motion_b = still_motion(b0);
    const FirstContact one = solve(c);
    contacts += one.state == ContactState::kContact;
    for (const double share : {0.0, 0.5, 4.0}) {
      Case s = c;
      s.motion_a = go(a0, share * v);
      s.motion_b = go(b0, (share - 1.0) * v);
      expect_agreement(sweep, c, one, solve(s),
                       "share " + std::to_string(share) + ", " + std::to_string(seed));
    }
  }
  EXPECT_GT(contacts, 40);
}

TEST(Invariance, OfRepetitionToTheLastBit) {
  CcdScratch scratch;
  for (std::uint64_t seed = 1'160'000; seed < 1'160'060; ++seed) {
    const Case c = random_case(seed);
    const FirstContact x = first_contact(query_of(c), scratch), y = solve(c);
    EXPECT_EQ(x.state, y.state);
    EXPECT_EQ(x.t_contact, y.t_contact);
    EXPECT_EQ(x.distance_mm, y.distance_mm);
    EXPECT_EQ(x.triangle_a, y.triangle_a);
    EXPECT_EQ(x.point_a_W, y.point_a_W);
    EXPECT_EQ(x.work.box_tests, y.work.box_tests);
  }
}

// The comparison can fail: an answer a thousandth of the tick early, one late.
TEST(Invariance, DisagreementIsSeen) {
  int early = 0, contacts = 0;
  for (std::uint64_t seed = 1'170'000; seed < 1'170'060; ++seed) {
    Case c = random_case(seed);
    c.accuracy_mm = kAccuracyDefault_mm;
    const FirstContact x = solve(c);
    if (x.state != ContactState::kContact || x.t_contact < 0.01) continue;
    ++contacts;
    Oracle oracle(c);
    early += oracle.gap_mm(0.99 * x.t_contact, 1) > oracle.accuracy_mm();
  }
  EXPECT_GE(early, contacts * 9 / 10);
}

}  // namespace
}  // namespace mortise::stress
