#pragma once
#include "common/ccd/pair_tree.h"

// What a thread keeps apart: pairs of nodes in the coordinates that a screw leaves alone.
namespace mortise::ccd {

/// A pair of which one body turns and the other does not (README, section 9). In cylinder
/// coordinates about the axis a screw changes the angle theta alone: the radius r and the height
/// along the thread, zeta = z - h theta, stay. Nodes that lie apart in (r, zeta) are free for the
/// whole tick, others until their angles meet.
class ScrewBounds {
 public:
  /// taken_mm: farther apart than this is free. Uses the hulls of scratch, and leaves `motion` at
  /// 0. O(nodes) of memory to be cleared, and a sample of the triangles to be looked at.
  ScrewBounds(PairMotion& motion, const Bvh& a, const Bvh& b, double taken_mm, CcdScratch& scratch);

  /// Exactly one body turns, from t on far enough to be worth it, and the meshes are not too large.
  static bool applies(const PairMotion& motion, const Bvh& a, const Bvh& b, double t);

  /// Nodes a and b (as in Bvh::Node::child) stay farther apart than taken_mm in [t, result), ticks;
  /// kNever: to the end of the tick. Not below t. What is known of a node is made when it is first
  /// asked for: O(triangles below it), later O(1).
  double free_until(std::int32_t a, std::int32_t b, double t);

  /// The same of the children of a pair that is opened at item.t: child k is free for dt[k] ticks
  /// from then. True: all of them to the end of the tick.
  bool keeps_children(const CcdScratch::Item& item, float* dt);

  static constexpr double kNever = 2.0;  ///< ticks: beyond any end

 private:
  using Hull = CcdScratch::ScrewHull;
  static constexpr int kDirections = CcdScratch::ScrewHull::kDirections;

  struct Body {
    const Bvh* bvh;
    std::vector<Hull>* hulls;
    std::vector<Hull>* triangles;  // in leaf order; known where the leaf is
    Mat3 R;  // a point x of the part, from the origin of its tree, is at R x + p: rows are the
    Vec3 p;  // directions across the axis, and the axis
  };

  void choose_directions();
  const Hull& hull(const Body& body, std::int32_t node);
  Hull of_leaf(const Body& body, std::int32_t leaf);
  Hull of_node(const Body& body, std::int32_t node);
  Hull of_triangle(const Vec3* x) const;
  void merge(Hull& hull, Hull other) const;
  double free_until(const Hull& of_a, const Hull& of_b, double t) const;
  bool apart(const Hull& turning, const Hull& other, double turns, double slack_mm) const;

  std::uint64_t asked_ = 0, kept_ = 0;  // children
  Body a_, b_;
  bool a_turns_;
  double speed_;     // rad per tick
  double lead_mm_;   // h, mm per rad
  double near_mm_;   // what is farther is free: taken, rounding, and by how far the axis moves
  double round_mm_;  // rounding of r and zeta along a direction
  double r_[kDirections], zeta_[kDirections];  // unit directions of the plane (r, zeta)
};

}  // namespace mortise::ccd
