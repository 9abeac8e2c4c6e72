#pragma once
#include <array>
#include <span>

#include "common/geometry/recognition/seeds.h"

/// Private to recognition: surfaces fitted to seeds.
namespace mortise {

/// How far corners may stand off, as shares of the radius, exact meshes first.
inline constexpr std::array<double, 3> kShares{1e-6, 2e-5, 4e-4};

/// Are rows of facets asked for this kind, before patches?
constexpr bool grows_in_ribbons(SurfaceKind kind) {
  return kind == SurfaceKind::kCylinder || kind == SurfaceKind::kCone;
}

/// Diagonal of the box about points, mm.
double extent_of(std::span<const Vec3> points);

/// What a try asks of seeds before anything is grown. It depends on the mesh and on what is known
/// of the facet alone, not on the regions found so far. Not thread safe: one for each thread, over
/// one finder and one grower, of which it only reads what never changes.
class SeedFitter {
 public:
  /// plain: the slow twin, in which sets within others say nothing of these.
  SeedFitter(const Solid& solid, const SeedFinder& finder, const RegionGrower& grower, bool plain);

  /// The sets about a facet; known: off_share of each from an earlier try, or empty.
  SeedSets about(std::uint32_t facet, std::span<const ByKind> known);

  /// Asks of each kind all sets up to the first that holds, as a try does in which nothing grows.
  void ask_first(SeedSets& sets, double share);

  /// Does a surface of this kind fit the seeds within the share of its size? It is in seeds.fits
  /// then. Asks smaller sets of `all` first.
  bool holds(std::size_t kind, SeedSets& all, SeedSet& seeds, double share);

  /// Fits from a guess. Gives how far off the fit leaves corners, as a share of its size.
  double fit_from(const Surface& guess, const SeedSet& seeds, SeedFit& fit) const;

  void fill(SeedSet& seeds);

 private:
  double least_share(std::size_t kind, SeedSets& all, const SeedSet& seeds, double share);
  void fit(std::size_t kind, SeedSet& seeds);

  const TriangleMesh& mesh_;
  const SeedFinder& finder_;
  const RegionGrower& grower_;
  bool plain_ = false;
  Marks corners_, triangles_;
};

}  // namespace mortise
