// Binary frames as a page reads them: byte for byte, and there and back.
#include "client/web/frames.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

namespace mortise::web {
namespace {

template <class T>
T value_at(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

TEST(PoseFrame, LiesAsThePageExpectsIt) {
  PartState state;
  state.part = PartId{7};
  state.holder = UserId{3};
  state.X_WP.p = Vec3(1.5, -2.25, 1e-7);
  state.X_WP.q = Quat(0.5, -0.5, 0.5, 0.5);  // w x y z
  state.classes = class_bit(CollisionClass::kReal) | class_bit(CollisionClass::kFake);
  const std::string bytes = pose_frame(123456789012, {{state}});
  ASSERT_EQ(bytes.size(), 16u + 64u);
  EXPECT_EQ(bytes.substr(0, 4), "MPF1");
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 4), 1u);
  EXPECT_EQ(value_at<double>(bytes, 8), 123456789012.0);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 16), 7u);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 20), 3u);
  EXPECT_EQ(value_at<double>(bytes, 24), 1.5);
  EXPECT_EQ(value_at<double>(bytes, 32), -2.25);
  EXPECT_EQ(value_at<double>(bytes, 40), 1e-7);
  EXPECT_EQ(value_at<float>(bytes, 48), -0.5f);
  EXPECT_EQ(value_at<float>(bytes, 60), 0.5f);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 64), 5u);
}

TEST(PoseFrame, ComesBackAsItWent) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> number(-1e4, 1e4);
  for (std::size_t count : {0u, 1u, 2u, 50u, 1000u}) {
    std::vector<PartState> parts(count);
    for (std::size_t i = 0; i < count; ++i) {
      parts[i].part = PartId{static_cast<std::uint32_t>(i + 1)};
      parts[i].holder = UserId{static_cast<std::uint32_t>(random() % 5)};
      parts[i].X_WP.p = Vec3(number(random), number(random), number(random));
      parts[i].X_WP.q =
          Quat(number(random), number(random), number(random), number(random)).normalized();
      parts[i].classes = static_cast<std::uint32_t>(random() % 8);
    }
    const auto frame = read_pose_frame(pose_frame(count, parts));
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->tick, count);
    ASSERT_EQ(frame->parts.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(frame->parts[i].part, parts[i].part);
      EXPECT_EQ(frame->parts[i].holder, parts[i].holder);
      EXPECT_EQ(frame->parts[i].classes, parts[i].classes);
      EXPECT_EQ(frame->parts[i].X_WP.p, parts[i].X_WP.p);  // exact
      EXPECT_LT((frame->parts[i].X_WP.q.coeffs() - parts[i].X_WP.q.coeffs()).norm(), 1e-7);
    }
  }
}

TEST(PoseFrame, OfAnotherLengthOrNameIsNone) {
  const std::string bytes = pose_frame(1, std::vector<PartState>(3));
  EXPECT_TRUE(read_pose_frame(bytes));
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(read_pose_frame(std::string_view(bytes).substr(0, length))) << length;
  EXPECT_FALSE(read_pose_frame(bytes + "x"));
  std::string other = bytes;
  other[3] = '2';
  EXPECT_FALSE(read_pose_frame(other));
  std::string many = bytes;  // a count that no memory could hold
  std::memset(many.data() + 4, 0xff, 4);
  EXPECT_FALSE(read_pose_frame(many));
}

TEST(PageMesh, HasHeaderPointsAndTriangles) {
  WireMesh mesh;
  mesh.points_mm = {Vec3(0, 0, 0), Vec3(1.5, 0, 0), Vec3(0, -2.5, 0.1)};
  mesh.triangles = {{0, 1, 2}};
  const std::string bytes = page_mesh(mesh);
  ASSERT_EQ(bytes.size(), 16u + 3 * 12u + 12u);
  EXPECT_EQ(bytes.substr(0, 4), "MSH1");
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 4), 3u);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 8), 1u);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 12), 0u);
  EXPECT_EQ(value_at<float>(bytes, 16 + 12), 1.5f);
  EXPECT_EQ(value_at<float>(bytes, 16 + 2 * 12 + 8), 0.1f);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 16 + 36 + 8), 2u);
}

}  // namespace
}  // namespace mortise::web
