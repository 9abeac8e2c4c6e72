// Sizes from a nanometre to a kilometre, places as far as ten kilometres from the origin.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/effort.h"

namespace mortise::stress {
namespace {

std::string label(const char* what, double by, std::uint64_t seed) {
  char text[96];
  std::snprintf(text, sizeof text, "%s %g of random_case(%llu)", what, by,
                static_cast<unsigned long long>(seed));
  return text;
}

TEST(Scale, FromNanometreToKilometre) {
  for (const double factor : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6}) {
    char name[32];
    std::snprintf(name, sizeof name, "scale %.0e", factor);
    Sweep sweep(name);
    const int cases = test::effort(40);
    for (int i = 0; i < cases; ++i) {
      const std::uint64_t seed = 2'000'000 + static_cast<std::uint64_t>(i);
      sweep.ask(scaled(random_case(seed), factor), label("scale", factor, seed));
    }
    EXPECT_GT(sweep.contacts(), cases / 3);
  }
}

// The size does not change the time, up to rounding: a power of two changes no bit.
TEST(Scale, PowersOfTwoChangeNoBit) {
  Sweep sweep("scale 2^k, same bits");
  CcdScratch scratch;
  for (int i = 0; i < test::effort(40); ++i) {
    const std::uint64_t seed = 2'100'000 + static_cast<std::uint64_t>(i);
    const Case c = random_case(seed);
    const FirstContact one = first_contact(query_of(c), scratch);
    for (const int k : {-20, 20}) {
      const FirstContact other = first_contact(query_of(scaled(c, std::ldexp(1.0, k))), scratch);
      ASSERT_EQ(one.state, other.state) << seed;
      sweep.measured(std::abs(one.t_contact - other.t_contact), 1e-15, label("2^", k, seed));
    }
  }
}

TEST(Offset, OfTheWorld) {
  for (const double far_mm : {1e3, 1e4, 1e5, 1e6, 1e7}) {
    char name[32];
    std::snprintf(name, sizeof name, "world offset %.0e mm", far_mm);
    Sweep sweep(name);
    const int cases = test::effort(60);
    for (int i = 0; i < cases; ++i) {
      const std::uint64_t seed = 2'200'000 + static_cast<std::uint64_t>(i);
      std::mt19937_64 random(seed);
      const Pose G{rotation_exp(random_turn(random, std::numbers::pi)),
                   far_mm * random_turn(random, 1.0).normalized()};
      sweep.ask(moved(random_case(seed), G), label("world offset", far_mm, seed));
    }
    EXPECT_GT(sweep.contacts(), cases / 3);
  }
}

TEST(Offset, OfTheMeshInItsPart) {
  for (const double far_mm : {1e3, 1e5, 1e7}) {
    char name[32];
    std::snprintf(name, sizeof name, "mesh offset %.0e mm", far_mm);
    Sweep sweep(name);
    const int cases = test::effort(60);
    for (int i = 0; i < cases; ++i) {
      const std::uint64_t seed = 2'300'000 + static_cast<std::uint64_t>(i);
      std::mt19937_64 random(seed);
      const Vec3 away = far_mm * random_turn(random, 1.0).normalized();
      sweep.ask(with_far_mesh(random_case(seed), away), label("mesh offset", far_mm, seed));
    }
    EXPECT_GT(sweep.contacts(), cases / 3);
  }
}

}  // namespace
}  // namespace mortise::stress
