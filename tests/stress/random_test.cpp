// Random meshes, convex and not, on random ways; and that the judges can say no.
#include <gtest/gtest.h>

#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/effort.h"

namespace mortise::stress {
namespace {

constexpr std::uint64_t kFirstSeed = 1'000'000;

TEST(Random, NothingMissedLateOrInvented) {
  Sweep sweep("random meshes and motions");
  const int cases = test::effort(2500);
  for (int i = 0; i < cases; ++i) {
    const std::uint64_t seed = kFirstSeed + static_cast<std::uint64_t>(i);
    sweep.ask(random_case(seed), "random_case(" + std::to_string(seed) + ")");
  }
  EXPECT_GT(sweep.contacts(), cases / 4);
  EXPECT_GT(sweep.free(), cases / 10);
}

// The judges themselves: planted faults in right answers must be seen.
TEST(Judges, SeePlantedFaults) {
  CcdScratch scratch;
  int contacts = 0, late = 0, early = 0, missed = 0, witness = 0, frees = 0, invented = 0;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + 150; ++seed) {
    Case c = random_case(seed);
    c.accuracy_mm = kAccuracyDefault_mm;  // a coarse one would hide a small lateness
    const FirstContact right = first_contact(query_of(c), scratch);
    FirstContact wrong = right;
    if (right.state == ContactState::kFree) {
      ++frees;
      wrong.state = ContactState::kContact;
      wrong.t_contact = wrong.t_clear = 0.5;
      invented += judge(c, wrong, 48).invented;
    }
    if (right.state != ContactState::kContact || right.t_contact > 0.99) continue;
    ++contacts;
    wrong.t_contact = wrong.t_clear = right.t_contact + 1e-4;
    const Judgement after = judge(c, wrong, 48);
    late += after.late;
    wrong.t_contact = wrong.t_clear = 0.99 * right.t_contact;
    early += judge(c, wrong, 48).invented;
    wrong = right;
    wrong.state = ContactState::kFree;
    wrong.t_contact = wrong.t_clear = 1.0;
    missed += judge(c, wrong, 48).missed;
    wrong = right;
    wrong.point_a_W.x() += 1e-9;
    witness += judge(c, wrong, 48).wrong;
  }
  std::printf("%d contacts: late %d, early %d, missed %d, witness %d; %d free: invented %d\n",
              contacts, late, early, missed, witness, frees, invented);
  EXPECT_GT(contacts, 80);
  EXPECT_GE(late, contacts * 95 / 100);
  EXPECT_GE(early, contacts * 9 / 10);
  EXPECT_EQ(missed, contacts);
  EXPECT_EQ(witness, contacts);
  EXPECT_EQ(invented, frees);
}

}  // namespace
}  // namespace mortise::stress
