#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "common/base/flat_map.h"
#include "common/depth/pair_frame.h"
#include "common/depth/search/proof.h"

namespace mortise {

/// A point of the surface of S in a layer and how deep it lies in K in the same layer.
struct Sample {
  double depth_mm = -std::numeric_limits<double>::infinity();
  int role = 0;
  std::uint32_t triangle = 0;  ///< of S
  Vec3 point_K = Vec3::Zero();
  SurfacePoint at;  ///< nearest point of K's mesh
};

/// `near`: see nearest_surface().
Sample sample_at(const PairFrame& pair, Layer layer, int role, std::uint32_t triangle,
                 const Vec3& x_S, std::uint32_t near = Topology::kNone);

struct Root {
  int role = 0;
  std::uint32_t triangle = 0;
  std::uint32_t region = 0;
  std::int32_t middle = -1;  ///< of SearchQuery::middles; below 0: not known
};

/// Bracket of the largest depth of one region in one layer.
struct Bracket {
  Sample best;
  double hi_mm = -std::numeric_limits<double>::infinity();
  bool undecided = false;  ///< the cap came before the sign was known
  double area_mm2 = 0.0;   ///< of the primary part's surface inside the other, estimated by samples
  std::vector<Sample> samples;  ///< a few of those inside
};

struct SearchQuery {
  const PairFrame* pair = nullptr;
  Layer layer = Layer::kMesh;
  const KnownOverlaps* known = nullptr;
  const std::vector<Root>* roots = nullptr;
  /// Of roots on the mesh: what is nearest to the middle of the triangle. Null: none is known.
  const std::vector<SurfacePoint>* middles = nullptr;
  std::size_t regions = 1;
  /// Regions by triangle of the primary part: pieces of the other part belong to the region of the
  /// triangle that they meet. Null: pieces stay in their root's region.
  const FlatMap<std::uint32_t>* region_of_triangle = nullptr;
  int primary = 0;
  double accuracy_mm = 1e-4;
  double most_mm = std::numeric_limits<double>::infinity();  ///< no region is deeper, proven
  /// Depths up to this are ignored; one deeper point ends the search.
  double ignore_below_mm = -std::numeric_limits<double>::infinity();
  bool sign_only = false;      ///< stop when it is known for every region whether it exceeds touch
  std::uint64_t work_cap = 0;  ///< evaluations of this search
};

/// How much of a depth the bracket may leave open when only the class was asked for.
inline constexpr double kLooseShare = 0.2;

struct SearchScratch {
  ProofScratch proof;
};

/// Best first branch and bound over the surfaces of both parts. Deterministic.
std::vector<Bracket> search_depth(const SearchQuery& query, SearchScratch& scratch,
                                  std::uint64_t& evaluations);

/// Whether a whole triangle of S is proven no deeper than limit_mm in K, or some point is deeper.
/// Stops after a few evaluations.
enum class RootState : std::uint8_t { kUnknown = 0, kBelow, kAbove };
struct RootQuery {
  const PairFrame* pair = nullptr;
  Layer layer = Layer::kMesh;
  const KnownOverlaps* known = nullptr;
  int role = 0;
  std::uint32_t triangle = 0;
  double limit_mm = 0.0;
  std::uint32_t near = Topology::kNone;  ///< see nearest_surface()
};
struct RootAnswer {
  RootState state = RootState::kUnknown;
  Sample best;
};
RootAnswer ask_root(const RootQuery& query, SearchScratch& scratch, std::uint64_t& evaluations);

}  // namespace mortise
