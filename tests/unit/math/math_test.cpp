#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>
#include <vector>

#include "common/math/box.h"
#include "common/math/interval.h"
#include "common/math/pose.h"
#include "common/math/rotation.h"
#include "common/math/simplex.h"
#include "tests/support/numbers.h"

namespace mortise {
namespace {

Vec3 random_vector(std::mt19937_64& random, double scale) {
  std::uniform_real_distribution<double> uniform(-scale, scale);
  return {uniform(random), uniform(random), uniform(random)};
}

TEST(Rotation, ExpAgreesWithAngleAxis) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 w = random_vector(random, 1.8);
    const Mat3 expected = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
    EXPECT_LT((rotation_exp(w).toRotationMatrix() - expected).cwiseAbs().maxCoeff(), 1e-15);
  }
}

TEST(Rotation, LogUndoesExpAtEveryAngle) {
  std::mt19937_64 random(2);
  for (const double angle :
       {0.0, 1e-300, 1e-16, 1e-10, 1e-8, 1e-4, 0.1, 1.0, 3.0, kPi - 1e-6, kPi - 1e-12}) {
    for (int i = 0; i < 20; ++i) {
      const Vec3 w = random_vector(random, 1.0).normalized() * angle;
      const double allowance = 1e-15 + 4e-16 * angle;
      EXPECT_LT((rotation_log(rotation_exp(w)) - w).norm(), allowance) << angle;
    }
  }
}

TEST(Rotation, HalfTurnHasOneSign) {
  const Vec3 w = rotation_log(Quat(0.0, -1.0, 0.0, 0.0));
  EXPECT_EQ(w.x(), kPi);
  EXPECT_EQ(rotation_log(Quat(0.0, 1.0, 0.0, 0.0)), w);
  EXPECT_EQ(rotation_log(Quat(0.0, 0.0, -1.0, 0.0)), Vec3(0.0, kPi, 0.0));
}

TEST(Rotation, NeverExceedsHalfATurn) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1000; ++i) {
    const Quat q =
        Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
    const Vec3 w = rotation_log(q);
    EXPECT_LE(w.norm(), kPi * (1.0 + 1e-15));
    EXPECT_LT(rotation_exp(w).angularDistance(q), 2e-15);
  }
}

TEST(Pose, ComposesInReadingOrder) {
  const Pose X_WA{rotation_exp({0, 0, kPi / 2}), {10, 0, 0}};
  const Pose X_AB = Pose::translation({1, 0, 0});
  const Vec3 p_W = X_WA * X_AB * Vec3(1, 0, 0);
  EXPECT_LT((p_W - Vec3(10, 2, 0)).norm(), 1e-14);
  EXPECT_LT(((X_WA.inverse() * X_WA).p).norm(), 1e-15);
}

// Bit for bit: written out so that it is inlined.
TEST(Pose, MovesAPointAsTheQuaternionDoes) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 10'000; ++i) {
    const Pose X{rotation_exp(random_vector(random, 3.0)), random_vector(random, 1e3)};
    const Vec3 x = random_vector(random, 1e3);
    EXPECT_EQ(X * x, Vec3(X.q * x + X.p));
  }
}

TEST(Pose, StaysARotationAfterAMillionProducts) {
  Pose X;
  const Pose step{rotation_exp({1e-3, 2e-3, -1e-3}), {1e-3, 0, 0}};
  for (int i = 0; i < 1'000'000; ++i) X = step * X;
  EXPECT_NEAR(X.q.norm(), 1.0, 1e-15);
}

TEST(Interval, SumAndHull) {
  EXPECT_EQ((Interval{1, 2} + Interval{-3, 5}), (Interval{-2, 7}));
  EXPECT_EQ((-Interval{1, 2}), (Interval{-2, -1}));
  EXPECT_EQ(hull({0, 1}, {3, 4}), (Interval{0, 4}));
}

TEST(Box, EmptyGrowsAndOverlaps) {
  Box box;
  EXPECT_TRUE(box.empty());
  box.add(Vec3(0, 0, 0));
  box.add(Vec3(1, 2, 3));
  Box other;
  other.add(Vec3(1, 2, 3));
  EXPECT_TRUE(box.overlaps(other));
  other.lo = other.hi = Vec3(1.1, 0, 0);
  EXPECT_FALSE(box.overlaps(other));
  EXPECT_TRUE(box.grown(0.1).overlaps(other));
}

// The point of the hull of some points that is nearest to the origin: of each set of them the foot
// on what it spans, by least squares, where that lies between them.
Vec3 nearest_of_sets(const std::vector<Vec3>& points) {
  Vec3 best = points.front();
  for (unsigned set = 1; set < (1U << points.size()); ++set) {
    std::vector<Vec3> p;
    for (std::size_t k = 0; k < points.size(); ++k)
      if (set >> k & 1U) p.push_back(points[k]);
    Eigen::Matrix<double, 3, Eigen::Dynamic> edges(3, p.size() - 1);
    for (std::size_t k = 1; k < p.size(); ++k)
      edges.col(static_cast<Eigen::Index>(k) - 1) = p[k] - p[0];
    const Eigen::VectorXd share =
        p.size() > 1 ? edges.colPivHouseholderQr().solve(-p[0]).eval() : Eigen::VectorXd();
    if (share.size() > 0 && (share.minCoeff() < 0.0 || share.sum() > 1.0)) continue;
    const Vec3 foot = share.size() > 0 ? Vec3(p[0] + edges * share) : p[0];
    if (foot.norm() < best.norm()) best = foot;
  }
  return best;
}

TEST(Simplex, GoesOnFromThePointThatWasNearest) {
  std::mt19937_64 random(7);
  int inside = 0, carried_again = 0;
  for (int i = 0; i < 4000; ++i) {
    Simplex<int> simplex;
    const Vec3 off = random_vector(random, 1.0);
    Vec3 before = Vec3::Constant(kInfinity);
    for (int tag = 0; tag < 12 && simplex.count < 4; ++tag) {
      std::vector<Vec3> points(simplex.point, simplex.point + simplex.count);
      points.push_back(off + random_vector(random, 2.0));
      simplex.add(points.back(), tag);
      const Vec3 nearest = simplex.nearest();
      EXPECT_NEAR(nearest.norm(), nearest_of_sets(points).norm(), 1e-12);
      Vec3 sum = Vec3::Zero();
      for (int k = 0; k < simplex.count; ++k) sum += simplex.weight[k] * simplex.point[k];
      EXPECT_LT((sum - nearest).norm(), 1e-12);
      carried_again += nearest == before ? 1 : 0;
      before = nearest;
    }
    inside += simplex.count == 4 ? 1 : 0;
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(carried_again, 1000);
}

}  // namespace
}  // namespace mortise
