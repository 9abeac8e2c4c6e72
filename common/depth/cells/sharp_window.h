#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "common/geometry/plane_faces.h"
#include "common/math/box.h"

namespace mortise {

/// Cuts away what of a polygon lies above n · x = c. `spare` is overwritten.
void clip(std::vector<Vec3>& polygon, std::vector<Vec3>& spare, const Vec3& n, double c);

/// A set of faces of one window, a bit each.
using FaceSet = std::uint64_t;

/// The faces of one part that reach into a box, and two questions about its sharp offset body there
/// (README, section 10). A face is *held* at a point that lies inside the offset half-space of it.
/// Which faces are held is all that the answers depend on: neither offsets nor pose count.
class SharpWindow {
 public:
  static constexpr std::size_t kMostFaces = 64;  ///< bits of a FaceSet
  enum class State : std::uint8_t {
    kReady,
    kCrowded,   ///< more than kMostFaces: a smaller window may have less
    kNotPlane,  ///< something in the box is not a plane face
    kTooSharp,  ///< a tip may come from farther off than the reach
  };

  /// core: the points that are asked for, part frame. The box is the core grown by reach_mm, which
  /// must cover what edges and corners travel by their bands and by `depth_mm` more: checked, if it
  /// is at least PlaneFaces::kUsualTravel times what faces do.
  SharpWindow(const Solid& solid, const PlaneFaces& planes, const Box& core, double reach_mm,
              double depth_mm);

  State state() const { return state_; }
  /// Reach that the edges and corners need that may come into the core.
  double needed_reach_mm() const { return needed_reach_mm_; }
  /// Indices into PlaneFaces::faces; bit i of a FaceSet is faces()[i].
  const std::vector<std::uint32_t>& faces() const { return faces_; }
  FaceSet all() const { return all_; }
  /// Is the core inside the part? Asked where no face reaches into the box.
  bool solid_inside() const;

  /// Clauses that a point which holds just these faces violates: "one face of the set must be
  /// held" by all points of the largest body. Each is the set of faces that some point outside the
  /// part, verified, is outside of. None: the point is in the largest body.
  const std::vector<FaceSet>& clauses(FaceSet held);

  /// Does a point that holds just these faces belong to the least body? Then some point inside the
  /// part, verified, is outside of all others.
  bool in_least(FaceSet held);

 private:
  void gather();
  void need_reach(const Box& core, double depth_mm);
  std::vector<FaceSet> find_clauses(FaceSet held);
  bool find_least(FaceSet held);
  // Faces of a set that look both ways from one plane: no point is inside of both, so where both
  // are held those of the plane stand for it.
  FaceSet both_ways(FaceSet half_spaces) const;
  void clauses_in_plane(FaceSet held, std::vector<FaceSet>& found) const;
  void clauses_of_facet(std::size_t face, std::vector<FaceSet>& found) const;
  /// What of a triangle lies in the box. Once it is placed: the half-spaces of which none of it is
  /// inside, or all; none outside, or all.
  struct Facet {
    std::uint32_t first = 0, count = 0;  // of corners_
    bool placed = false;
    FaceSet none_inside = 0, all_inside = 0, none_outside = 0, all_outside = 0;
  };
  // What is left of polygon_ in the box.
  bool clip_to_box();
  void place(Facet& facet) const;
  // polygon_: what is left of a facet inside of the half-spaces, or outside of them.
  bool take_facet(Facet& facet, FaceSet half_spaces, bool outside);
  FaceSet outside_of(const Vec3& x) const;
  bool is_inside(const Vec3& x) const;
  /// A point well inside of half-spaces, outside of others, in the plane of others, and in the box.
  bool middle(FaceSet inside_of, FaceSet outside_of, FaceSet in_plane_of, Vec3& at) const;

  const Solid& solid_;
  const PlaneFaces& planes_;
  Box box_;
  State state_ = State::kReady;
  double apart_mm_ = 0.0;
  double needed_reach_mm_ = 0.0;
  std::vector<std::uint32_t> faces_;
  std::vector<PlaneFace> plane_of_;                    // by face
  std::vector<std::vector<std::uint32_t>> triangles_;  // by face
  std::vector<std::vector<Facet>> facets_;             // by face, of the same triangles
  std::vector<Vec3> corners_;                          // of all facets
  FaceSet all_ = 0;
  std::map<FaceSet, std::vector<FaceSet>> clauses_of_;  // by faces held
  std::map<FaceSet, bool> least_of_;
  std::vector<Vec3> polygon_, spare_;  // at work
};

}  // namespace mortise
