// First time within a distance, against the same oracles.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/effort.h"

namespace mortise::stress {
namespace {

// From below the accuracy to the size of the parts. A larger distance is reached no later.
TEST(Separation, FromNanometresToTheSizeOfTheParts) {
  const double distances[] = {1.0, 0.3, 0.1, 1e-2, 1e-4, 1e-6, 1e-8, 0.0};
  Sweep sweep("minimum separation 1e-8 ... 1 mm");
  for (int i = 0; i < test::effort(60); ++i) {
    const std::uint64_t seed = 600'000 + static_cast<std::uint64_t>(i);
    Case c = random_case(seed);
    c.check_contained = false;
    double last = 0.0;
    for (const double separation_mm : distances) {
      c.separation_mm = separation_mm;
      const FirstContact answer = sweep.ask(c, "separation " + std::to_string(separation_mm) +
                                                   ", random_case(" + std::to_string(seed) + ")");
      // Both answers lie within their accuracies before the truth.
      if (answer.state == ContactState::kContact) {
        const double slack = 2.0 * c.accuracy_mm / static_cast<double>(Oracle(c).speed_mm());
        EXPECT_GE(answer.t_contact, last - std::max(slack, 1e-12)) << seed;
        last = std::max(last, answer.t_contact);
      }
      if (answer.state == ContactState::kFree) last = 1.0;
    }
  }
  EXPECT_GT(sweep.contacts(), 150);
  EXPECT_GT(sweep.at_start(), 10);
}

}  // namespace
}  // namespace mortise::stress
