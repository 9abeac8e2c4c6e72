#pragma once
#include "common/depth/search/face_pair.h"
#include "common/depth/search/patch.h"

namespace mortise {

/// Reused memory of proofs.
struct ProofScratch {
  struct Facet {
    std::uint32_t triangle = 0;
    const Surface* surface = nullptr;  ///< null: the plane of the triangle
    Vec3 normal = Vec3::Zero();        ///< outward, at the patch
    Vec3 point = Vec3::Zero();
    double offset_mm = 0.0;
    double slack_mm = 0.0;  ///< how far the facet may rise before it meets the patch
    /// Heights along the axis of the surface between which it is a wall: often those of the face.
    Interval covers_along_mm = kEverywhere_mm;
  };
  std::vector<Facet> walls;  ///< facets that hold the patch off
  struct Near {
    std::uint32_t triangle = 0;
    std::array<Vec3, 3> corners;
  };
  std::vector<Near> near;  ///< all facets near the patch, while there are few
  std::vector<Near> open;  ///< those that nothing covers yet
};

/// Closed forms of pairs of faces: upper bounds of the nominal overlap, mm.
struct KnownOverlaps {
  struct Row {
    std::uint16_t face[2];
    double overlap_mm;  ///< of the two faces
    /// Of the convex face between its ends with the hollow surface continued beyond its own.
    double along_mm = std::numeric_limits<double>::infinity();
    /// Heights along the axis of A's and of B's surface: a patch of the other part between them is
    /// no deeper below the surface, ended or not, than `overlap_mm`.
    Interval holds_along_mm[2] = {kEverywhere_mm, kEverywhere_mm};
    /// For any point not outside of the convex face's surface; faces that end on it satisfy that.
    double within_mm = std::numeric_limits<double>::infinity();
    /// Where `within_mm` holds: between these heights along the axis of the convex face.
    Interval within_extent_mm = kEverywhere_mm;
    /// The pair is reported by its closed form. Otherwise the row serves proofs only.
    bool told = true;
    double told_mm = std::numeric_limits<double>::infinity();  ///< no more than this is so reported
  };
  std::vector<Row> rows;
  /// Set when neither part moves: then a shaft in a bore and a ball in a socket are also bounded at
  /// the place of a patch.
  std::optional<Pose> X_BA;
  /// Of face_s of body `role` with face_k of the other; null when not known.
  const Row* find(int role, std::uint16_t face_s, std::uint16_t face_k) const;
};

struct DepthProof {
  const KnownOverlaps* known = nullptr;  ///< may be null
  int role = 0;
  const Body* s = nullptr;
  std::uint32_t triangle_s = 0;  ///< triangle of the patch
  const Body* k = nullptr;
  Layer layer = Layer::kMesh;
  double limit_mm = 0.0;   ///< the claim: no point of the patch is deeper in k than this
  SurfacePoint at_center;  ///< nearest point of k's mesh to patch.center
  /// Depth of patch.center in the layer of k; asked for where it is not known.
  std::optional<double> center_depth_mm;
  double rounding_mm = 0.0;
};

/// True implies: no point of the patch lies deeper than limit_mm in the layer of k (for a negative
/// limit: none is nearer than -limit_mm). False implies nothing. The patch is one connected set and
/// its centre is not deeper than the limit. The proof is in the README, section 5.
///
/// Why it is right. Let m be the outward normal of k's facet nearest to the centre and u the limit.
/// Each facet f of k near the patch is a wall when the patch moved by u m lies wholly above f. Let
/// V be the convex set above all walls. If every other facet near the patch lies below some wall,
/// then no facet of k reaches into V; V is empty of k, as its rim is; the moved patch lies in V; so
/// no point of the patch is deeper than u. For u < 0 no move is needed: every facet is parted from
/// the patch by a wall at least -u away. Depth is continuous and the patch connected, so facets
/// farther than |u| from the patch need not be asked. Where k is convex, so that all facets near
/// the patch lie below two planes, any mean of the depths below both bounds the depth: this is what
/// makes the ridge along an edge of k converge. A facet may be a declared surface whose
/// distance is convex (bore) or bounded by its tangent plane (shaft): its triangles are one wall,
/// and the depth below it is a distance, which needs no m.
bool depth_at_most(const DepthProof& proof, const Patch& patch, ProofScratch& scratch);

}  // namespace mortise
