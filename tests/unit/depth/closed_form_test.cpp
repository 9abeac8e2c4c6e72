#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/depth/search/candidates.h"
#include "common/depth/search/face_pair.h"
#include "common/depth/search/patch.h"
#include "common/math/rotation.h"
#include "tests/support/numbers.h"
#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

using namespace shapes;

// A triangle of a cylinder's mesh, and the true surface over it.
struct CylinderPiece {
  SolidPtr solid;
  SurfaceBand band;
  Piece piece;
};

CylinderPiece cylinder_piece(int facets) {
  CylinderPiece made;
  made.solid = solid(peg({3.0, -5.0, 5.0, facets, 1, 0.0}));
  made.band = cylinder_band(made.solid, 3.0, false, {-0.02, 0.01});
  for (std::uint32_t t = 0; t < made.solid->mesh().triangles.size(); ++t)
    if (made.band.face_of(t).surface) {
      const TriangleMesh& mesh = made.solid->mesh();
      made.piece = {{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}, t};
      break;
    }
  return made;
}

// A wall that touches the true cylinder in the middle of a facet or at its edge: known exactly,
// without cutting the triangle.
TEST(ClosedForm, ACylinderAgainstItsTangentPlaneIsExactInOnePiece) {
  for (const int facets : {6, 24, 48}) {
    const CylinderPiece made = cylinder_piece(facets);
    const Body body(*made.solid, made.band);
    for (const Layer layer : {Layer::kLower, Layer::kUpper}) {
      const Patch patch = make_patch(body, layer, made.piece, Pose());
      const double radius = 3.0 + (layer == Layer::kLower ? -0.02 : 0.01);
      for (const Vec3& x : made.piece.corners) {
        const Vec3 out = Vec3(x.x(), x.y(), 0.0).normalized();
        const Vec3 wall = (3.0 + 0.5) * out;  // half a millimetre clear of the nominal surface
        EXPECT_NEAR(patch.depth_below_plane(-out, wall, 0.0), radius - 3.5, 1e-6);
      }
    }
  }
}

// Points of the layer's surface over a piece are never deeper below a plane than its patch says.
TEST(ClosedForm, NoPointOfASurfaceIsDeeperThanItsPatch) {
  std::mt19937_64 random(20250611);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const CylinderPiece made = cylinder_piece(8);
  const Body body(*made.solid, made.band);
  for (int i = 0; i < 300; ++i) {
    Piece piece = made.piece;
    for (int k = 0; k < i % 4; ++k) piece = split(body, Layer::kUpper, piece)[k % 2];
    const Pose X{rotation_exp(Vec3(3.0 * unit(random), unit(random), unit(random))),
                 Vec3(unit(random), unit(random), unit(random))};
    const Vec3 n = Vec3(unit(random), unit(random), unit(random)).normalized();
    for (const Layer layer : {Layer::kMesh, Layer::kLower, Layer::kUpper}) {
      const double most = make_patch(body, layer, piece, X).depth_below_plane(n, Vec3::Zero(), 0.0);
      for (int s = 0; s < 40; ++s) {
        double a = 0.5 * (unit(random) + 1.0), b = 0.5 * (unit(random) + 1.0);
        if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
        const Vec3 x = piece.corners[0] + a * (piece.corners[1] - piece.corners[0]) +
                       b * (piece.corners[2] - piece.corners[0]);
        EXPECT_LE(-n.dot(X * on_layer(body, layer, piece.triangle, x)), most + 1e-9);
      }
    }
  }
}

Surface round_surface(SurfaceKind kind, bool inward) {
  Surface surface;
  surface.kind = kind;
  surface.inward = inward;
  surface.radius_mm = 10.0;
  surface.half_angle_rad = kPi / 4.0;
  return surface;
}

// A chamfer of 45 degrees whose wide end has the bore's radius: its overlap is the eccentricity.
TEST(ClosedForm, AChamferInABoreIsBoundedByItsWideEnd) {
  const Surface cone = round_surface(SurfaceKind::kCone, false);  // radius = height
  const Surface bore = round_surface(SurfaceKind::kCylinder, true);
  for (const double off : {0.0, 0.01, 0.5}) {
    const InBoreQuery query{&cone, &bore, {9.0, 10.0}, {0.0, 20.0}, 0.0, 0.1};
    const InBoreBound bound = in_bore_bound(query, {Quat::Identity(), Vec3(off, 0.0, 5.0)});
    EXPECT_NEAR(bound.face_mm, off, 1e-12);
    EXPECT_TRUE(std::isinf(bound.within_mm));
    InBoreQuery moved = query;
    moved.most_inward_mm = 0.1;  // 0.1 along the normal is less in radius
    EXPECT_NEAR(in_bore_bound(moved, {Quat::Identity(), Vec3(off, 0.0, 5.0)}).face_mm,
                off + 0.1 * (1.0 - std::cos(kPi / 4.0)), 1e-12);
  }
}

// Random poses: no point of the cone or cylinder is farther out of the bore than the bound, and a
// bound that ignored the wide end would be seen.
TEST(ClosedForm, NoPointOfARoundFaceIsFartherOutThanItsBound) {
  std::mt19937_64 random(771);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Surface bore = round_surface(SurfaceKind::kCylinder, true);
  int narrow_end_fails = 0;
  for (const SurfaceKind kind : {SurfaceKind::kCone, SurfaceKind::kCylinder}) {
    const Surface round = round_surface(kind, false);
    for (int i = 0; i < 300; ++i) {
      const Pose X{rotation_exp(0.1 * Vec3(unit(random), unit(random), unit(random))),
                   Vec3(unit(random), unit(random), 3.0 * unit(random))};
      const InBoreQuery query{&round, &bore, {8.0, 10.0}, {-20.0, 40.0}, 0.0, 0.1};
      const InBoreBound bound = in_bore_bound(query, X);
      double deepest = -1e9;
      for (int s = 0; s < 200; ++s) {
        const double z = 9.0 + unit(random), angle = kPi * unit(random);
        const double r = kind == SurfaceKind::kCone ? z : 10.0;
        deepest = std::max(deepest, -bore.signed_distance_mm(
                                        X * Vec3(r * std::cos(angle), r * std::sin(angle), z)));
      }
      EXPECT_GE(bound.face_mm, deepest - 1e-9);
      if (kind == SurfaceKind::kCone) {
        InBoreQuery narrow = query;
        narrow.extent_a = {8.0, 8.0};
        narrow_end_fails += deepest > in_bore_bound(narrow, X).face_mm;
      }
    }
  }
  EXPECT_GT(narrow_end_fails, 0);
}

// The mirror: a bore in nothing, a shaft in a shaft, crossed axes.
TEST(ClosedForm, NothingIsSaidOfOtherPairs) {
  const Surface shaft = round_surface(SurfaceKind::kCylinder, false);
  const Surface bore = round_surface(SurfaceKind::kCylinder, true);
  EXPECT_FALSE(is_round_in_bore(shaft, shaft));
  EXPECT_FALSE(is_round_in_bore(bore, bore));
  const InBoreQuery query{&shaft, &bore, {0.0, 5.0}, {0.0, 5.0}, 0.0, 0.1};
  const Pose crossed{rotation_exp(Vec3(0.5 * kPi, 0.0, 0.0)), Vec3::Zero()};
  EXPECT_TRUE(std::isinf(in_bore_bound(query, crossed).face_mm));
}

// A cylinder lying across the edge of a block, just clear of it: a few questions, no search.
TEST(ClosedForm, ACylinderAtRestOnAPlaneTakesFewEvaluations) {
  const CylinderPiece made = cylinder_piece(24);
  const SolidPtr block = solid(box(Vec3(20.0, 20.0, 20.0)));
  const SurfaceBand plain = nominal_band();
  for (const double gap : {1e-3, 1e-2}) {
    OverlapQuery query;
    query.a = made.solid.get();
    query.b = block.get();
    query.band_a = &made.band;
    query.band_b = &plain;
    const double half_mm = block->bounds().half().y();
    query.X_WA.p = block->bounds().center() + Vec3(0.0, half_mm + 3.01 + gap, 9.0);
    query.refinement = Refinement::kDecided;
    CcdScratch scratch;
    const OverlapResult result = find_overlap(query, scratch);
    EXPECT_TRUE(result.regions.empty());
    EXPECT_LT(result.evaluations, 1500u);
    query.X_WA.p.y() -= gap + 0.05;  // and pressed in it is real
    const OverlapResult pressed = find_overlap(query, scratch);
    ASSERT_FALSE(pressed.regions.empty());
    EXPECT_GT(pressed.regions.front().certain_mm.lo, 0.0);
  }
}

}  // namespace
}  // namespace mortise
