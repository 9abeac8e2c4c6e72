// Convex pieces of outlines beside the outlines themselves.
#include "common/depth/cells/outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mortise {
namespace {

using outline::Piece;

std::vector<Vec2> teeth(int count, double root_mm, double tip_mm) {
  std::vector<Vec2> corners;
  const double pitch = 2.0 * std::numbers::pi / count;
  const auto add = [&](double r, double a) {
    corners.emplace_back(r * std::cos(a), r * std::sin(a));
  };
  for (int i = 0; i < count; ++i) {
    add(root_mm, pitch * (i - 0.28));
    add(tip_mm, pitch * (i - 0.12));
    add(tip_mm, pitch * (i + 0.12));
    add(root_mm, pitch * (i + 0.28));
    add(root_mm, pitch * (i + 0.5));
  }
  return corners;
}

std::vector<Vec2> corners_of(const Piece& piece) {
  std::vector<Vec2> corners;
  for (const outline::Corner& corner : piece) corners.push_back(corner.at);
  return corners;
}

TEST(Outline, OfTeethFallsIntoThemAndTheBodyThatTheyStandOn) {
  const std::vector<Vec2> corners = teeth(20, 17.5, 22.0);
  const std::vector<Piece> pieces = outline::convex_pieces(corners, 1e-9);
  ASSERT_EQ(pieces.size(), 21u);
  double area = 0.0;
  std::vector<int> of_side(corners.size(), 0);
  for (const Piece& piece : pieces) {
    area += outline::area(corners_of(piece));
    for (const outline::Corner& corner : piece)
      if (!corner.is_cut()) ++of_side[corner.side];
  }
  EXPECT_NEAR(area, outline::area(corners), 1e-9);
  for (const int pieces_of : of_side) EXPECT_EQ(pieces_of, 1);
}

TEST(Outline, ThatIsConvexIsOnePiece) {
  const std::vector<Vec2> corners = {{0, 0}, {4, 0}, {5, 3}, {1, 4}};
  ASSERT_EQ(outline::convex_pieces(corners, 1e-9).size(), 1u);
}

TEST(Outline, OfOneHollowCornerIsLeftAlone) {
  EXPECT_TRUE(
      outline::convex_pieces({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}}, 1e-9).empty());
}

TEST(Outline, AWayIsWithinWhenItCrossesNoSide) {
  const std::vector<Vec2> corners = teeth(6, 10.0, 15.0);
  EXPECT_TRUE(outline::is_within(corners, {0, 0}, {5, 5}, 0.0));
  EXPECT_TRUE(outline::is_within(corners, {0, 0}, {14.7, 0}, 0.0));
  EXPECT_FALSE(outline::is_within(corners, {0, 0}, {14.7, 0}, -0.2));
  EXPECT_FALSE(outline::is_within(corners, {0, 0}, {16, 0}, 0.5));
  // From tip to tip, over the space between.
  EXPECT_FALSE(outline::is_within(corners, corners[2], corners[6], 1e-6));
  // Along a side.
  EXPECT_TRUE(outline::is_within(corners, corners[1], corners[2], 1e-6));
}

TEST(Outline, WithinLinesIsTheirPolygon) {
  const std::vector<Vec2> square =
      outline::within({{{1, 0}, 2.0}, {{-1, 0}, 1.0}, {{0, 1}, 3.0}, {{0, -1}, 0.0}});
  EXPECT_NEAR(outline::area(square), 9.0, 1e-9);
  EXPECT_TRUE(outline::within({{{1, 0}, -2.0}, {{-1, 0}, 1.0}}).empty());
}

}  // namespace
}  // namespace mortise
