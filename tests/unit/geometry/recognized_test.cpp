#include "common/geometry/recognition/recognized.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <thread>
#include <vector>

#include "tests/support/shapes.h"

namespace mortise {
namespace {

TriangleMesh bushing(double bore_mm, int facets = 32) {
  return shapes::ring({bore_mm, 0.0, 20.0, facets, 1, 0.0}, bore_mm + 5.0);
}

void expect_same(const Recognition& a, const Recognition& b) {
  ASSERT_EQ(a.features.size(), b.features.size());
  EXPECT_EQ(a.triangles_recognized, b.triangles_recognized);
  EXPECT_EQ(a.largest_residual_share, b.largest_residual_share);
  for (std::size_t i = 0; i < a.features.size(); ++i) {
    const Feature &f = a.features[i], &g = b.features[i];
    EXPECT_EQ(f.name, g.name);
    EXPECT_EQ(f.surface.kind, g.surface.kind);
    EXPECT_EQ(f.surface.point, g.surface.point);
    EXPECT_EQ(f.surface.axis, g.surface.axis);
    EXPECT_EQ(f.surface.radius_mm, g.surface.radius_mm);
    EXPECT_EQ(f.residual_mm, g.residual_mm);
    EXPECT_EQ(f.triangles, g.triangles);
  }
}

TEST(Recognized, IsWorkedOutOnceForAContent) {
  const Solid one(bushing(4.0)), same(bushing(4.0)), other(bushing(4.5));
  const auto found = recognized(one);
  ASSERT_GE(found->features.size(), 4u);
  EXPECT_EQ(recognized(same), found);
  EXPECT_NE(recognized(other), found);
  EXPECT_EQ(recognized(one), found);
  expect_same(*found, recognize_features(one));
  expect_same(*recognized(other), recognize_features(other));
}

// The same mesh with coordinates as they are, and as a file rounded them.
TEST(Recognized, OtherOptionsHaveTheirOwn) {
  TriangleMesh rough = bushing(4.0);
  for (std::size_t i = 0; i < rough.points_mm.size(); ++i)
    rough.points_mm[i].x() += i % 2 == 0 ? 4e-3 : -4e-3;
  const Solid solid(rough);
  const RecognitionOptions all[] = {
      {}, {.quantum_mm = 5e-3}, {.planes = false}, {.quantum_mm = 5e-3, .planes = false}};
  for (const RecognitionOptions& options : all)
    expect_same(*recognized(solid, options), recognize_features(solid, options));
  EXPECT_NE(recognized(solid, all[0])->features.size(), recognized(solid, all[1])->features.size());
  EXPECT_NE(recognized(solid, all[1])->features.size(), recognized(solid, all[3])->features.size());
}

TEST(Recognized, IsForgottenWhenEnoughOthersWereAskedFor) {
  const Solid first(bushing(3.0));
  const std::weak_ptr<const Recognition> kept = recognized(first);
  EXPECT_FALSE(kept.expired());
  // One facet of many triangles: nothing to search in it.
  const auto fan = [](double height_mm) {
    TriangleMesh mesh;
    constexpr std::uint32_t kCorners = 500'000;
    mesh.points_mm.emplace_back(0.0, 0.0, height_mm);
    for (std::uint32_t i = 0; i < kCorners; ++i)
      mesh.points_mm.emplace_back(std::cos(1e-5 * i), std::sin(1e-5 * i), height_mm);
    for (std::uint32_t i = 2; i <= kCorners; ++i) mesh.triangles.push_back({0, i - 1, i});
    return mesh;
  };
  const std::size_t enough = kRecognizedTriangles / 499'999 + 1;
  for (std::size_t i = 0; i < enough; ++i)
    (void)recognized(Solid(fan(1.0 + static_cast<double>(i))));
  EXPECT_TRUE(kept.expired());
  expect_same(*recognized(first), recognize_features(first));
}

TEST(Recognized, IsTheSameAtAnyNumberOfThreads) {
  const Solid solid(bushing(7.0, 64));
  std::vector<std::shared_ptr<const Recognition>> found(8);
  std::vector<std::thread> threads;
  for (auto& mine : found) threads.emplace_back([&] { mine = recognized(solid); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& mine : found) EXPECT_EQ(mine, found[0]);
  expect_same(*found[0], recognize_features(solid));
}

}  // namespace
}  // namespace mortise
