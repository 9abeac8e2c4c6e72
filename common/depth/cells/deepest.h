#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/depth/cells/decide.h"
#include "common/depth/cells/linear_program.h"
#include "common/depth/cells/sharp_window.h"

namespace mortise {

enum class SharpLayer : std::uint8_t { kLeast, kLargest };

/// kMargin: twice the lesser depth of a point in both bodies, negative outside; kSum: the sum of
/// both, where both are positive.
enum class SharpMeasure : std::uint8_t { kMargin, kSum };

/// Both parts seen from one core (frame B), and the clauses met there.
struct WindowPair {
  /// planes about `origin_B`.
  WindowPair(const SharpQuery& query, double reach_mm, const Box& core_B, const Vec3& origin_B);

  /// A face of a window in frame B, about the origin: n · x <= c + offset.
  struct Plane {
    Vec3 n;
    double c = 0.0;
    Interval offset_mm;
    double c_in(SharpLayer layer) const {
      return c + (layer == SharpLayer::kLargest ? offset_mm.hi : offset_mm.lo);
    }
  };
  SharpWindow part[2];
  std::vector<Plane> planes[2];
  std::vector<FaceSet> known[2];
  Box core;  ///< about the origin
};

/// The point of one window that lies deepest in both bodies of a layer: branch and bound over
/// clauses, the node with the largest bound first (README, section 10).
class DeepestPoint {
 public:
  DeepestPoint(SharpLayer layer, SharpMeasure measure, double depth_mm)
      : layer_(layer), measure_(measure), depth_mm_(depth_mm) {}

  struct Found {
    double bound = -std::numeric_limits<double>::infinity();  ///< nothing is deeper
    bool closed = false;        ///< `at` is the optimum of the bodies asked for
    LinearProgram::Optimum at;  ///< x, y, z, depth of A, with kSum depth of B
    /// closed: length of the mean of the normals of A that bound the depth, weighted by their dual
    /// multipliers. 1: one face. A gap of m is m / facing wide.
    double facing = 1.0;
    /// closed: of each part the face with the largest multiplier, by its bit; -1: none has one.
    int deciding[2] = {-1, -1};
    std::uint64_t programs = 0;
  };
  /// least_bodies: of the bodies that every admissible trimming contains, otherwise of those that
  /// contain each. Stops when nothing deeper than `best` is left, or after a number of programs.
  Found find(WindowPair& windows, bool least_bodies, double best) const;

  /// Is the point in the bodies that every admissible trimming contains?
  bool in_least(WindowPair& windows, const LinearProgram::Optimum& at) const;
  /// Lower bound of what is measured at a point that is in_least().
  double proven_mm(const LinearProgram::Optimum& at) const;
  /// What lies below this is not told apart.
  double nothing_mm() const { return measure_ == SharpMeasure::kSum ? 0.0 : -2.0 * depth_mm_; }
  /// By face of a window: how far the point, with its depth, is inside.
  std::vector<double> slacks(const WindowPair& windows, int part,
                             const LinearProgram::Optimum& at) const;

 private:
  struct Literal;
  struct Node;
  class Queue;
  LinearProgram::Row row_of(const WindowPair& windows, const Literal& literal) const;
  LinearProgram program_of(const WindowPair& windows) const;
  FaceSet violated(WindowPair& windows, int part, const LinearProgram::Optimum& at,
                   bool least_bodies) const;
  FaceSet violated(WindowPair& windows, const LinearProgram::Optimum& at, bool least_bodies,
                   int& part) const;
  void tell_faces(const WindowPair& windows, const Node& node, Found& found) const;
  std::uint64_t branch(WindowPair& windows, const Node& node, int part, FaceSet clause, double best,
                       Queue& open) const;

  SharpLayer layer_;
  SharpMeasure measure_;
  double depth_mm_;
};

}  // namespace mortise
