#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/flat_map.h"
#include "common/depth/pair_frame.h"
#include "common/depth/search/face_pair.h"
#include "common/depth/search/proof.h"

namespace mortise {

/// Two declared faces whose overlap is known in closed form.
struct KnownFacePair {
  std::uint16_t face[2] = {0, 0};
  FacePairOverlap overlap;
  std::vector<std::uint32_t> triangles[2];  ///< of the faces, where they are near, ascending
};

struct Candidates {
  std::vector<std::uint32_t> triangles[2];  ///< near the other part, ascending
  std::vector<KnownFacePair> known;         ///< not contained in `triangles` on their account
  /// With want_meetings: triangles that cross one of the other part, and which one.
  FlatMap<std::uint32_t> crossing[2];
  bool has_meetings = false;
  std::vector<KnownFacePair> bounded;  ///< not tight: only their upper ends are used
  bool cross = false;                  ///< asked for when a part has no inside
  std::uint32_t cross_triangle[2] = {0, 0};
  Vec3 cross_point_B = Vec3::Zero();
  std::uint64_t tests = 0;
};

struct CandidateQuery {
  const PairFrame* pair = nullptr;
  double margin_mm = 0.0;
  bool want_crossing = false;
  /// Where the meshes are the parts: name the triangles that go through each other, leave out those
  /// that do not meet.
  bool want_meetings = false;
  /// False: all pairs of faces are descended into.
  bool closed_forms = true;
};

/// Bound of a round face in a bore over all layers; infinity for other pairs.
InBoreBound in_bore_bound(const PairFrame& pair, std::uint16_t face_a, std::uint16_t face_b,
                          double margin_mm);

/// Triangles of either part that are within the margin of the other part's boxes and planes: a
/// superset of those within the margin, and of those that touch: a shell none of whose triangles is
/// among them is inside or outside of the other part by more than touch. Pairs of declared faces
/// with a closed form that is tight, or that shows that they cannot interfere, are not descended
/// into.
Candidates find_candidate_triangles(const CandidateQuery& query);

/// What the closed forms of the candidates say, for proofs, and what is known of round faces in
/// bores that cannot interfere in the upper layer.
KnownOverlaps known_overlaps(const PairFrame& pair, const Candidates& candidates);

/// Leaves a pair of faces with a closed form to the search: its triangles become candidates, and
/// the closed form serves proofs only.
void leave_to_search(const KnownFacePair& pair, Candidates& candidates, KnownOverlaps& known);

}  // namespace mortise
