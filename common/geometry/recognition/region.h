#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/recognition/facets.h"
#include "common/geometry/recognition/measure.h"
#include "common/geometry/recognition/surface_guess.h"

/// Private to recognition: triangles that stand for one surface.
namespace mortise {

struct Region {
  Surface surface;
  std::vector<std::uint32_t> triangles;  ///< ascending
  double residual_mm = 0.0;
  double allowed_mm = 0.0;  ///< how far corners could be off
  double share = 0.0;       ///< of the size, without rounding
};

/// Triangles that a region grows from, with their corners and normals (corners_of, normals_of).
struct Seeds {
  std::span<const std::uint32_t> triangles;
  std::span<const Vec3> corners;
  std::span<const OrientedPoint> normals;
};

/// A set of indices that is cleared in O(1).
class Marks {
 public:
  explicit Marks(std::size_t count) : mark_(count, 0) {}
  void clear() { ++stamp_; }
  bool has(std::uint32_t i) const { return mark_[i] == stamp_; }
  /// False when it was there.
  bool add(std::uint32_t i) { return std::exchange(mark_[i], stamp_) != stamp_; }

 private:
  std::vector<std::uint32_t> mark_;
  std::uint32_t stamp_ = 1;
};

/// The corners of triangles, each once, in order of appearance. met: corners of the mesh, for this
/// call.
std::vector<Vec3> corners_of(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                             Marks& met);

/// Balls that hold and are too flat to be told from a plane.
class FlatBalls {
 public:
  void keep(const Region& ball, std::size_t triangles_of_mesh);
  /// Do all seeds lie on one of them? Then another ball through them, of which this is the start,
  /// is too flat as well, unless its corners are much nearer to it.
  bool hold(std::span<const std::uint32_t> seeds, const Region& start) const;

 private:
  struct Ball {
    double share = 0.0, allowed_mm = 0.0;
  };
  std::vector<Ball> balls_;
  std::vector<std::uint32_t> of_triangle_;  // the last one, counted from one
};

/// Grows regions over smooth edges. Not thread safe: one per thread.
class RegionGrower {
 public:
  /// plain: the slow twin of what is not asked twice.
  RegionGrower(const Solid& solid, const Facets& facets, double quantum_mm, bool plain = false);

  /// The region of a surface fitted to seed triangles: grown in doubling steps with a fit after
  /// each, cut back to corners within share * size + rounding. Nothing when fewer triangles than
  /// the seeds remain, or when the region shows too little of the surface. A surface that other
  /// seeds have grown before is not grown again.
  std::optional<Region> grow(const Surface& guess, const Seeds& seeds, double share);

  /// Fits the surface to what the region has now; false when it no longer holds.
  bool settle(Region& region);

  /// The corners of triangles, each once, in order of appearance.
  std::vector<Vec3> points_of(std::span<const std::uint32_t> triangles) {
    return corners_of(mesh_, triangles, corners_);
  }
  /// Middle and facet normal of triangles whose normal is known.
  std::vector<OrientedPoint> normals_of(std::span<const std::uint32_t> triangles) const;

  /// Rounding of coordinates: corners may be off by this beside any share of the size.
  double rounding_mm() const { return rounding_mm_; }
  /// Does the mesh go on across edge k of a triangle, and smoothly?
  bool smooth(std::uint32_t t, int k) const {
    return (edges_[t][static_cast<std::size_t>(k)] & kSmooth) != 0;
  }

 private:
  // How the mesh goes on across an edge; none of both: not at all, or sharply.
  static constexpr std::uint8_t kSmooth = 1, kSmoothOfBall = 2;
  void tell_edges();
  bool belongs(std::uint32_t t, const SurfaceAt& surface, double allowed_mm) const;
  bool corners_lie_on(std::uint32_t t, const SurfaceAt& surface, double allowed_mm) const;
  bool corners_asked_once(std::uint32_t t, const SurfaceAt& surface, double allowed_mm);
  bool looks_along(std::uint32_t t, const SurfaceAt& surface, double allowed_mm) const;
  void spread(const Surface& surface, double allowed_mm, std::size_t limit,
              std::vector<std::uint32_t>& triangles);
  // What a growth reached and how it ended.
  struct Attempt {
    double share = 0.0;
    std::vector<Vec3> reached;  // a few corners, all over what it reached
    std::optional<Region> outcome;
  };
  const Attempt* grown_before(const Surface& guess, std::span<const std::uint32_t> seeds,
                              const Region& region) const;
  void keep(SurfaceKind kind, double share, std::span<const std::uint32_t> reached,
            const std::optional<Region>& outcome);
  bool starts(Region& region, const Seeds& seeds) const;
  bool settles(Region& region, std::size_t least);
  bool refit(Region& region, const std::vector<Vec3>& corners, std::size_t most) const;
  bool fit_all(Region& region);
  bool shows_enough(const Region& region);

  const TriangleMesh& mesh_;
  const Topology& topology_;
  const Facets& facets_;
  double rounding_mm_ = 0.0;
  bool plain_ = false;
  std::vector<std::array<std::uint8_t, 3>> edges_;
  Marks corners_;
  std::vector<std::uint32_t> triangle_mark_;
  std::uint32_t mark_ = 0;
  // By point: twice the mark of the spread that asked, and one more where it lies on the surface.
  std::vector<std::uint32_t> point_asked_;
  std::vector<Attempt> attempts_;
  // By kind of surface and triangle: the last attempt that reached it, counted from one.
  std::array<std::vector<std::uint32_t>, 6> attempt_of_;
  FlatBalls flat_balls_;
};

}  // namespace mortise
