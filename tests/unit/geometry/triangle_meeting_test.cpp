// What meeting_of says for certain is held against the distance of the triangles, moved a little.
#include "common/geometry/triangle_meeting.h"

#include <gtest/gtest.h>

#include <random>

#include "common/base/flat_map.h"
#include "tests/support/effort.h"

namespace mortise {
namespace {

Vec3 random_point(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> unit(-size, size);
  const double x = unit(random), y = unit(random), z = unit(random);
  return {x, y, z};
}

TEST(TriangleMeeting, IsCertainWhereItSaysSo) {
  std::mt19937_64 random(4);
  int apart = 0, crossing = 0, doubtful = 0;
  for (int i = 0; i < test::effort(20000); ++i) {
    const Vec3 shift = random_point(random, i % 5 == 0 ? 1e6 : 1.0);
    Triangle a, b;
    for (Vec3& x : a) x = shift + random_point(random, 1.0);
    for (Vec3& x : b) x = shift + random_point(random, 1.0);
    const Meeting meeting = meeting_of(a, b, 1e-6);
    EXPECT_EQ(meeting, meeting_of(b, a, 1e-6));
    const TriangleDistance distance = triangle_distance(a, b);
    if (meeting == Meeting::kApart) {
      EXPECT_GT(distance.distance_mm, 0.0) << i;
    }
    if (meeting == Meeting::kCrossing) {
      EXPECT_TRUE(triangles_cross(a, b)) << i;
    }
    apart += meeting == Meeting::kApart;
    crossing += meeting == Meeting::kCrossing;
    doubtful += meeting == Meeting::kDoubtful;
  }
  EXPECT_GT(apart, 100);
  EXPECT_GT(crossing, 100);
  EXPECT_LT(doubtful, crossing / 10);
}

TEST(TriangleMeeting, TouchIsDoubtful) {
  const Triangle floor = {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  const auto lifted = [&](double z) {
    Triangle t = {Vec3(1, 1, z), Vec3(1, 2, z + 1), Vec3(2, 1, z + 1)};
    return t;
  };
  EXPECT_EQ(meeting_of(floor, lifted(0.0), 1e-6), Meeting::kDoubtful);
  EXPECT_EQ(meeting_of(floor, lifted(9e-7), 1e-6), Meeting::kDoubtful);
  EXPECT_EQ(meeting_of(floor, lifted(1.1e-6), 1e-6), Meeting::kApart);
  EXPECT_EQ(meeting_of(floor, lifted(-1e-3), 1e-6), Meeting::kCrossing);
  EXPECT_EQ(meeting_of(floor, floor, 1e-6), Meeting::kDoubtful);
  EXPECT_EQ(meeting_of(floor, {Vec3(1, 1, 1), Vec3(1, 1, 1), Vec3(1, 1, -1)}, 1e-6),
            Meeting::kDoubtful);
}

TEST(FlatMap, KeepsWhatItWasGiven) {
  std::mt19937_64 random(9);
  FlatMap<double> map;
  std::vector<std::uint32_t> keys;
  for (int i = 0; i < 5000; ++i) {
    keys.push_back(static_cast<std::uint32_t>(random() % 1'000'000) + 1);
    map[keys.back()] = keys.back() * 0.5;
  }
  for (const std::uint32_t key : keys) {
    ASSERT_NE(map.find(key), nullptr);
    EXPECT_EQ(*map.find(key), key * 0.5);
  }
  EXPECT_EQ(map.find(0), nullptr);
  EXPECT_LE(map.size(), keys.size());
}

}  // namespace
}  // namespace mortise
