#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "common/depth/cells/cover.h"
#include "common/depth/cells/cover_bound.h"
#include "common/depth/pair_path.h"

namespace mortise {

/// Up to when a layer of two parts is proven apart.
struct CoverFree {
  double t_free = 1.0;  ///< no point is in both deeper than the limit at any t <= t_free
  bool all = false;     ///< nor in the whole tick
  std::uint64_t work = 0;
};

/// A bound costs about this share of asking one point of the mesh.
constexpr std::uint64_t kBoundsPerEvaluation = 32;
constexpr std::uint64_t evaluations_of_bounds(std::uint64_t work) {
  return (work + kBoundsPerEvaluation - 1) / kBoundsPerEvaluation;
}

/// What keeps a cell S of part `role` from one of the other part, or nearly so: a direction fixed
/// in that part, or a void of it.
struct CoverKeeper {
  int role = -1;  ///< -1: nothing is known
  bool by_void = false;
  std::size_t v = 0;
  Vec3 n = Vec3::Zero();
};

/// How deep the overlap of a layer of two parts may be.
struct CoverOverlap {
  /// No point is deeper in both cells, or beyond both walls, that decide. Infinity: nothing is
  /// known. What is no deeper than least_mm is not in both parts; CoverPair::bounds_depth() asks
  /// whether this bounds the depth in the whole parts as well.
  double most_mm = std::numeric_limits<double>::infinity();
  CoverKeeper keeper;
  /// Points of S = part keeper.role that may be that deep in the other part, in its own frame, the
  /// likeliest first; to be verified.
  std::vector<Vec3> places_S;
};

/// Upper bounds of the overlap of one layer of two parts A and B by their covers (README, section
/// 11). True whatever the covers are larger by. Deterministic, without memory of other queries.
class CoverPair {
 public:
  CoverPair(const CoverLayer& a, const CoverLayer& b) : parts_{&a, &b} {}

  /// The time is looked for as closely as no point moves farther than accuracy_mm.
  CoverFree free_until(const PairPath& path, double limit_mm, double accuracy_mm) const;

  /// No point is in both deeper than limit_mm: what overlap() says, without how deep.
  bool apart(const Pose& X_BA, double limit_mm, std::uint64_t& work) const;

  /// Overlaps below least_mm count as that.
  CoverOverlap overlap(const Pose& X_BA, double least_mm, std::uint64_t& work) const;

  /// No point of either part is deeper in the other than most_mm and least_mm of the overlap at
  /// this pose: true, or not known. In the whole part, inside a hollow edge, the depth may be
  /// larger than in a cell or beyond a wall.
  bool bounds_depth(const CoverOverlap& overlap, const Pose& X_BA, double least_mm,
                    std::uint64_t& work) const;

 private:
  /// How each part is seen from the other over a span.
  struct Views {
    Chord chord[2];
  };
  /// A cell of A and one of B, and what kept them apart last.
  struct Cells {
    std::size_t cell[2] = {0, 0};
    CoverKeeper keeper;
    std::vector<Vec3> places_S;          // of part keeper.role, what comes farthest
    std::optional<Vec3> apart_along[2];  // in B, where the span begins and ends
  };
  class Bound;
  class Whole;

  static Views views_at(const Pose& X_BA);
  static Views views_of(const PairPath& path, const Span& span);
  /// visit(cells) for each pair of cells in turn, until one says false: then false.
  template <class Visit>
  bool each_pair(Visit&& visit) const;
  /// Kept apart over a span by a direction that turns: from that in which they are farthest apart
  /// where it begins to that where it ends.
  bool turn_apart(const Views& views, Cells& cells, double limit_mm, std::uint64_t& work) const;
  /// That direction in B, at a pose of A in B; null: none is found.
  std::optional<Vec3> apart_along(const Cells& cells, const Pose& X_BA, const Vec3& first,
                                  std::uint64_t& work) const;
  /// Points of part keeper.role where what kept its cell from the other one last is least far.
  std::vector<Vec3> places_of(const Cells& cells, const Views& views) const;

  const CoverLayer* parts_[2];
};

}  // namespace mortise
