#pragma once
#include <array>
#include <optional>
#include <vector>

#include "common/geometry/recognition/region.h"

/// Private to recognition: from which few triangles a surface may be guessed.
namespace mortise {

/// Surfaces that are looked for, simpler kinds first.
inline constexpr std::array kCurvedKinds{SurfaceKind::kCylinder, SurfaceKind::kCone,
                                         SurfaceKind::kSphere, SurfaceKind::kTorus};
using ByKind = std::array<double, kCurvedKinds.size()>;  ///< one value for each of them

/// What one kind of surface is to a set of seeds.
struct SeedFit {
  bool asked = false;
  std::optional<Surface> surface;
  /// A set that contains these seeds is not asked below this share: 0, where nothing is known.
  double least_share = 0.0;
};

/// Triangles about a facet that may belong to one surface; points and normals
/// are of the triangles, filled when first asked for.
struct SeedSet {
  std::vector<std::uint32_t> triangles;
  /// How far the fit of each kind leaves corners off, as a share of its size, or less;
  /// 0: not known.
  ByKind off_share{};
  std::array<SeedFit, kCurvedKinds.size()> fits{};  ///< of this try
  std::uint32_t holds = 0;                          ///< bits of the smaller sets that are in it
  std::vector<Vec3> points;
  std::vector<OrientedPoint> normals;
};

/// ribbons: facets in a row across opposite edges, because each facet of a
/// cylinder may touch a fillet at both ends; patches: all neighbours, near ones
/// first. Longer sets come first, because they average noise.
struct SeedSets {
  std::vector<SeedSet> ribbons, patches;

  static constexpr unsigned kPatchBit = 24;  ///< of SeedSet::holds: ribbons are 18 at most
  SeedSet& at_bit(unsigned bit) {
    return bit < kPatchBit ? ribbons[bit] : patches[bit - kPatchBit];
  }
};

class SeedFinder {
 public:
  /// O(n log n), once a mesh.
  SeedFinder(const Solid& solid, const Facets& facets, const RegionGrower& grower);

  /// Does any edge of the facet bend smoothly?
  bool bends_smoothly(std::uint32_t facet) const;
  /// triangles: those of the mesh, for this call.
  SeedSets about(std::uint32_t facet, Marks& triangles) const;

 private:
  // The longest smooth edge between two facets.
  struct Crossing {
    std::uint32_t facet = 0;  // across
    Vec3 along = Vec3::Zero();
    double length_mm = 0.0;
  };
  std::span<const Crossing> crossings(std::uint32_t facet) const {
    return std::span(crossings_).subspan(begin_[facet], begin_[facet + 1] - begin_[facet]);
  }
  void add_crossings_of(std::uint32_t facet);
  const Crossing* onward(std::uint32_t facet, const Vec3& along,
                         std::span<const std::uint32_t> been) const;
  std::vector<std::uint32_t> walk(std::uint32_t seed, Crossing step, std::uint32_t not_into) const;
  std::vector<std::uint32_t> triangles_of(std::span<const std::uint32_t> row) const;
  void add_ribbons(std::uint32_t seed, SeedSets& sets) const;
  void add_patches(std::uint32_t seed, SeedSets& sets, Marks& met) const;

  const TriangleMesh& mesh_;
  const Topology& topology_;
  const Facets& facets_;
  const RegionGrower& grower_;
  std::vector<std::size_t> begin_{0};
  std::vector<Crossing> crossings_;
};

}  // namespace mortise
