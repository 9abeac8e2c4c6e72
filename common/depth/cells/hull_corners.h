#pragma once
#include <cstddef>
#include <vector>

#include "common/math/interval.h"
#include "common/math/types.h"

namespace mortise {

/// Points, kept in blocks of four: the farthest one is looked for four at a time.
class HullCorners {
 public:
  void push_back(const Vec3& x) {
    // Those that a block lacks are its last one again.
    std::size_t k = size_++ % 4;
    if (k == 0) blocks_.emplace_back();
    for (; k < 4; ++k) blocks_.back().row(k) = x.transpose();
  }
  std::size_t size() const { return size_; }
  std::vector<Vec3> all() const {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < size_; ++i) points.push_back((*this)[i]);
    return points;
  }
  Vec3 middle() const {
    Vec3 middle = Vec3::Zero();
    for (std::size_t i = 0; i < size_; ++i) middle += (*this)[i] / static_cast<double>(size_);
    return middle;
  }
  Vec3 operator[](std::size_t i) const { return blocks_[i / 4].row(i % 4).transpose(); }

  /// The first of those with the largest n · x, and how large that is to the last bit of it; minus
  /// infinity: there is none. O(size).
  struct Farthest {
    std::size_t index = 0;
    double reach_mm = -kInfinity;
  };
  Farthest farthest(const Vec3& n) const {
    Farthest far;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Lanes reach = reach_of(blocks_[b], n);
      const double most = reach.maxCoeff();
      if (!(most > far.reach_mm)) continue;
      far = {4 * b, most};
    }
    if (blocks_.empty()) return far;
    const Lanes reach = reach_of(blocks_[far.index / 4], n);
    while (reach[far.index % 4] < far.reach_mm) ++far.index;
    return far;
  }

 private:
  using Block = Eigen::Matrix<double, 4, 3>;
  using Lanes = Eigen::Array4d;
  // As Vec3::dot() adds.
  static Lanes reach_of(const Block& x, const Vec3& n) {
    return (n[0] * x.col(0).array() + n[1] * x.col(1).array()) + n[2] * x.col(2).array();
  }

  std::vector<Block> blocks_;
  std::size_t size_ = 0;
};

}  // namespace mortise
