// What a look at a pair of large parts costs when what is derived of them was made before.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <new>
#include <thread>
#include <vector>

#include "common/depth/depth.h"
#include "common/evaluation/band.h"
#include "common/geometry/recognition/recognition.h"
#include "tests/support/shapes.h"

namespace {
thread_local std::uint64_t allocated_bytes = 0;
}

// A sanitizer has its own; it finds leaks, this counts.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kCounts = false;
#else
constexpr bool kCounts = true;
// Inlined, the compiler takes free() for the wrong partner of the new above it.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
void* operator new(std::size_t size) {
  allocated_bytes += size;
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#endif

namespace mortise {
namespace {

struct LargePart {
  SolidPtr solid;
  SurfaceBand band;
};

LargePart ball() {
  LargePart part{shapes::solid(shapes::sphere(50.0, Vec3::Zero(), 160)), {}};
  const std::vector<Feature> features = recognize_features(*part.solid).features;
  BandInput input;
  input.solid = part.solid.get();
  input.features = features;
  input.of_feature.resize(features.size());
  input.estimate = true;
  part.band = build_band(input);
  return part;
}

OverlapQuery pressed(const LargePart& part, double by_mm) {
  OverlapQuery query;
  query.a = query.b = part.solid.get();
  query.band_a = query.band_b = &part.band;
  query.X_WB = Pose::translation({100.0 - by_mm, 0, 0});
  return query;
}

template <class Action>
void in_a_thread(Action action) {
  std::thread(action).join();
}

OverlapResult looked(const OverlapQuery& query, std::uint64_t& taken_bytes) {
  CcdScratch scratch;
  const std::uint64_t before = allocated_bytes;
  OverlapResult result = find_overlap(query, scratch);
  taken_bytes = allocated_bytes - before;
  return result;
}

void expect_same(const OverlapResult& x, const OverlapResult& y) {
  EXPECT_EQ(x.evaluations, y.evaluations);
  ASSERT_EQ(x.regions.size(), y.regions.size());
  for (std::size_t i = 0; i < x.regions.size(); ++i) {
    EXPECT_EQ(x.regions[i].delta_mm, y.regions[i].delta_mm);
    EXPECT_EQ(x.regions[i].certain_mm, y.regions[i].certain_mm);
    EXPECT_EQ(x.regions[i].possible_mm, y.regions[i].possible_mm);
    EXPECT_EQ(x.regions[i].triangle_a, y.regions[i].triangle_a);
  }
}

TEST(LargePart, ALookTakesNoMemoryByTriangle) {
  const LargePart part = ball();
  const std::size_t triangles = part.solid->mesh().triangles.size();
  ASSERT_GT(triangles, 100'000U);
  ASSERT_FALSE(part.band.trivial);
  std::vector<OverlapResult> unready;
  const std::vector<double> pressed_mm = {0.0, 1e-4};
  // A thread that nobody has made anything for makes it as it is needed.
  in_a_thread([&] {
    for (const double by_mm : pressed_mm) {
      std::uint64_t taken = 0;
      unready.push_back(looked(pressed(part, by_mm), taken));
      if (kCounts && by_mm == pressed_mm.front()) {
        EXPECT_GT(taken, triangles) << "planted: it is made of all triangles";
      }
    }
  });
  in_a_thread([&] { make_body_ready(*part.solid, part.band, 1); });
  for (std::size_t i = 0; i < pressed_mm.size(); ++i) {
    std::uint64_t taken = 0;
    expect_same(looked(pressed(part, pressed_mm[i]), taken), unready[i]);
    EXPECT_LT(taken, triangles) << pressed_mm[i] << " mm deep";
  }
}

}  // namespace
}  // namespace mortise
