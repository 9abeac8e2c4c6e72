// Proofs against points: whatever the faces of two parts state, no point of either real surface
// lies deeper in the other part than the brackets say. Random parts, statements and poses.
#include <gtest/gtest.h>

#include <random>

#include "common/depth/depth.h"
#include "common/depth/search/candidates.h"
#include "common/depth/search/known_depth.h"
#include "common/depth/search/search.h"
#include "common/evaluation/band.h"
#include "common/math/rotation.h"
#include "tests/bench/judgement_parts.h"
#include "tests/support/effort.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

constexpr double kTouch_mm = 1e-6;

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double in(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(random_() >> 11) * 0x1.0p-53;
  }
  int up_to(int n) { return static_cast<int>(random_() % static_cast<std::uint64_t>(n)); }
  Vec3 vector(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }

 private:
  std::mt19937_64 random_;
};

struct Stated {
  JudgedPart part;
  SurfaceBand band;
};

// A face that is stated in two halves: facets of one plane move differently, and a shaft goes on
// beyond the end of its face.
void split_a_face(JudgedPart& part, Draw& draw) {
  Feature& whole =
      part.features[static_cast<std::size_t>(draw.up_to(static_cast<int>(part.features.size())))];
  std::vector<std::uint32_t>& all = whole.triangles;
  if (all.size() < 2) return;
  const TriangleMesh& mesh = part.solid->mesh();
  const auto height = [&](std::uint32_t t) {
    const Vec3 sum = mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2);
    return sum.dot(whole.surface.kind == SurfaceKind::kPlane ? Vec3::UnitX() : whole.surface.axis);
  };
  std::sort(all.begin(), all.end(),
            [&](std::uint32_t s, std::uint32_t t) { return height(s) < height(t); });
  Feature half = whole;
  half.name += " half";
  const auto middle = static_cast<std::ptrdiff_t>(all.size() / 2);
  half.triangles.assign(all.begin() + middle, all.end());
  all.resize(static_cast<std::size_t>(middle));
  std::sort(all.begin(), all.end());
  std::sort(half.triangles.begin(), half.triangles.end());
  part.features.push_back(std::move(half));
}

// Statements of either sign, of every face and of the rest.
Stated state(JudgedPart part, double largest_mm, Draw& draw) {
  const auto zone = [&]() -> FaceStatement {
    const double middle = draw.in(-largest_mm, largest_mm), half = draw.in(0.0, 0.3 * largest_mm);
    return {{middle - half, middle + half}, "zone"};
  };
  Stated made;
  made.part = std::move(part);
  if (draw.up_to(2) == 0) split_a_face(made.part, draw);
  BandInput input;
  input.solid = made.part.solid.get();
  input.features = made.part.features;
  for (std::size_t i = 0; i < made.part.features.size(); ++i) input.of_feature.push_back(zone());
  if (draw.up_to(2) == 0) input.rest = zone();
  made.band = build_band(input);
  return made;
}

struct Pair {
  JudgedPart a, b;
  Pose X_BA;
};

// About as deep in each other as the statements are wide.
Pair draw_pair(Draw& draw, double largest_mm) {
  const Around coarse{12 + draw.up_to(20), draw.in(0.0, 0.3)}, fine{12 + draw.up_to(30), 0.0};
  const double r = draw.in(5.0, 20.0), slack = draw.in(-1.0, 2.0) * largest_mm;
  const Vec3 off = draw.vector(largest_mm), turn = draw.vector(1e-3);
  const Pose near{rotation_exp(turn), off};
  switch (draw.up_to(5)) {
    case 0:
      return {
          make_shaft({r - slack, -5.0, r - slack, draw.in(5.0, 25.0)}, 1 + draw.up_to(3), coarse),
          make_ring({r, 0.0, r, 20.0}, 1.6 * r, 1, fine), near};
    case 1: {
      // The cone ends before its bore does, or goes on.
      const double lo = draw.in(-3.0, 3.0), hi = 12.0 + draw.in(-3.0, 3.0), taper = 0.2 * r / 12.0;
      return {make_shaft({r - slack + taper * lo, lo, r - slack + taper * hi, hi}, 1, coarse),
              make_ring({r, 0.0, 1.2 * r, 12.0}, 1.9 * r, 1, fine), near};
    }
    case 2:
      return {make_ball(r - slack, coarse), make_socket(r, draw.in(-0.3, 0.3) * r, 1.5 * r, fine),
              near};
    case 3: {
      const Slot slot{0.5 * r, r, 1.5 * r, 0.4 * r};
      const double half = 0.5 * r - 0.5 * slack;
      Pose X = near;
      X.p.y() += half;
      return {make_block({half, half, r}, 1 + draw.up_to(2)), make_slot(slot), X};
    }
    default: {
      // Anyhow: a corner or an edge of a block against whatever the other shows.
      Pair pair{make_block({0.4 * r, 0.5 * r, 0.6 * r}, 1 + draw.up_to(2)), {}, {}};
      pair.b = draw.up_to(2) == 0 ? make_slot({0.5 * r, r, 1.5 * r, 0.4 * r})
                                  : make_shaft({r, -5.0, 0.8 * r, 15.0}, 1, coarse);
      pair.X_BA = {rotation_exp(draw.vector(3.0)), draw.vector(1.2 * r)};
      return pair;
    }
  }
}

OverlapQuery query_of(const Stated& a, const Stated& b, const Pose& X_BA) {
  OverlapQuery query;
  query.a = a.part.solid.get();
  query.b = b.part.solid.get();
  query.band_a = &a.band;
  query.band_b = &b.band;
  query.X_WA = X_BA;
  return query;
}

// A face that is moved outward ends where its neighbour, moved inward, cuts it: what is beyond is
// no point of the part.
bool is_of_part(const PairFrame& pair, Layer layer, const Sample& at) {
  const Body& s = pair.s(at.role);
  const Vec3 x_S = pair.X_KS[1 - at.role] * at.point_K;
  return s.depth_in(x_S, nearest_surface(*s.solid, x_S), layer) > -kTouch_mm;
}

double deepest_point_mm(const PairFrame& pair, Layer layer, Draw& draw, int points) {
  double deepest = -1e9;
  for (int role = 0; role < 2; ++role) {
    const TriangleMesh& mesh = *pair.s(role).mesh;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      // Only those that may reach the other part.
      const Vec3 middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
      const double reach =
          std::max({(mesh.corner(t, 0) - middle).norm(), (mesh.corner(t, 1) - middle).norm(),
                    (mesh.corner(t, 2) - middle).norm()});
      const auto look = [&](const Vec3& x) {
        const Sample at = sample_at(pair, layer, role, t, x);
        if (at.depth_mm > deepest && is_of_part(pair, layer, at)) deepest = at.depth_mm;
        return at;
      };
      const Sample at = look(middle);
      if (at.depth_mm < -reach - 1.0) continue;
      for (int i = 0; i < points; ++i) {
        double u = draw.in(0.0, 1.0), v = draw.in(0.0, 1.0);
        if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
        if (i % 3 == 0) v = 0.0;  // edges: there the proofs have most to say
        const Vec3 x = mesh.corner(t, i % 3) +
                       u * (mesh.corner(t, (i + 1) % 3) - mesh.corner(t, i % 3)) +
                       v * (mesh.corner(t, (i + 2) % 3) - mesh.corner(t, i % 3));
        look(x);
      }
    }
  }
  return deepest;
}

TEST(LayerBound, NoPointOfARealSurfaceIsDeeperThanTheBrackets) {
  Draw draw(20261);
  int regions = 0, deep[3] = {0, 0, 0}, bounded[3] = {0, 0, 0};
  for (int i = 0; i < test::effort(250); ++i) {
    const double largest_mm = draw.in(0.005, 0.2);
    const Pair pair = draw_pair(draw, largest_mm);
    const Stated a = state(pair.a, largest_mm, draw), b = state(pair.b, largest_mm, draw);
    OverlapQuery query = query_of(a, b, pair.X_BA);
    query.refinement = Refinement::kDecided;
    query.prove_not_certain = i % 2 == 0;
    query.work_cap = 20'000;
    CcdScratch scratch;
    const OverlapResult result = find_overlap(query, scratch);
    const PairFrame frame(query);
    Interval worst[3];  // by layer
    for (Interval& x : worst) x = {-1e9, frame.touch_mm};
    for (const OverlapRegion& region : result.regions) {
      ++regions;
      const Interval* found[3] = {&region.delta_mm, &region.certain_mm, &region.possible_mm};
      for (int k = 0; k < 3; ++k) worst[k].hi = std::max(worst[k].hi, found[k]->hi);
    }
    for (const Layer layer : {Layer::kMesh, Layer::kLower, Layer::kUpper}) {
      const int k = static_cast<int>(layer);
      // Where nothing may interfere no more is said than that.
      if (result.regions.empty() && layer != Layer::kUpper) continue;
      const double deepest = deepest_point_mm(frame, layer, draw, 24);
      EXPECT_LE(deepest, worst[k].hi + 2e-4) << "case " << i << ", layer " << k;
      deep[k] += deepest > frame.touch_mm;
      bounded[k] += worst[k].hi < deepest + largest_mm;
    }
  }
  std::printf("%d regions; overlaps and tight bounds by layer: %d %d, %d %d, %d %d\n", regions,
              deep[0], bounded[0], deep[1], bounded[1], deep[2], bounded[2]);
  EXPECT_GT(deep[1], 20);
  EXPECT_GT(bounded[2], 20);
}

// Where a sharp neighbour moves inward, a point beyond is taken back: it is none of this piece.
bool is_over(const PairFrame& pair, Layer layer, const Sample& at, const Vec3& x) {
  const Body& s = pair.s(at.role);
  const SurfaceBand::Face& face = s.face(at.triangle);
  const Surface* surface = Body::surface_of(face, layer);
  const Vec3 n = surface != nullptr ? surface->outward_normal(x) : s.normal(at.triangle);
  const double above = surface != nullptr ? surface->signed_distance_mm(x) : 0.0;
  const Vec3 over = x + (Body::offset_of(face, layer) - above) * n;
  return (pair.X_KS[at.role] * over - at.point_K).norm() < 1e-9;
}

// A piece of a triangle of S and the deepest of its points in K that was found.
struct Probe {
  Piece piece;
  Patch patch;
  SurfacePoint at_center;
  double deepest_mm = -1e9;
  std::vector<Vec3> points_K;
};

std::optional<Probe> draw_probe(const PairFrame& pair, Layer layer, int role, Draw& draw) {
  const Body& s = pair.s(role);
  const auto t = static_cast<std::uint32_t>(draw.up_to(static_cast<int>(s.mesh->triangles.size())));
  Probe probe;
  probe.piece = {{s.mesh->corner(t, 0), s.mesh->corner(t, 1), s.mesh->corner(t, 2)}, t};
  for (int i = draw.up_to(12); i > 0; --i)
    probe.piece = split(s, layer, probe.piece)[static_cast<std::size_t>(draw.up_to(2))];
  probe.patch = make_patch(s, layer, probe.piece, pair.X_KS[role]);
  if (probe.patch.count == 0) return std::nullopt;
  probe.at_center = nearest_surface(*pair.k(role).solid, probe.patch.center);
  if (std::fabs(probe.at_center.depth_mm) > probe.patch.radius_mm + 1.0) return std::nullopt;
  const std::array<Vec3, 3>& c = probe.piece.corners;
  for (int i = 0; i < 24; ++i) {
    double u = draw.in(0.0, 1.0), v = draw.in(0.0, 1.0);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    if (i < 12) v = 0.0;
    const std::size_t k = static_cast<std::size_t>(i % 3);
    const Vec3 x = c[k] + u * (c[(k + 1) % 3] - c[k]) + v * (c[(k + 2) % 3] - c[k]);
    const Sample at = sample_at(pair, layer, role, t, x);
    if (!is_over(pair, layer, at, x) || !is_of_part(pair, layer, at)) continue;
    probe.points_K.push_back(at.point_K);
    probe.deepest_mm = std::max(probe.deepest_mm, at.depth_mm);
  }
  return probe;
}

DepthProof proof_of(const PairFrame& pair, Layer layer, int role, const Probe& probe,
                    const KnownOverlaps& known) {
  DepthProof proof;
  proof.known = layer == Layer::kMesh ? nullptr : &known;
  proof.role = role;
  proof.s = &pair.s(role);
  proof.k = &pair.k(role);
  proof.triangle_s = probe.piece.triangle;
  proof.layer = layer;
  proof.at_center = probe.at_center;
  proof.rounding_mm = pair.rounding_mm;
  return proof;
}

// What closed forms say of the piece and a face of K; how far a point is below what they say.
double below_closed_form_mm(const DepthProof& proof, const Probe& probe, std::uint32_t triangle) {
  const SurfaceBand::Face& face = proof.k->face(triangle);
  const Surface* surface = Body::surface_of(face, proof.layer);
  if (surface == nullptr || proof.known == nullptr) return -1e9;
  const double said = known_depth(proof, probe.patch, triangle).continued_mm;
  double below = -1e9;
  for (const Vec3& x : probe.points_K)
    below = std::max(below, Body::offset_of(face, proof.layer) - surface->signed_distance_mm(x));
  return below - said;
}

// Each proof by itself: of a piece of which a point lies deeper than the limit nothing may be
// proven.
TEST(LayerBound, NothingIsProvenBelowAPoint) {
  Draw draw(20262);
  ProofScratch scratch;
  int wrong = 0, asked = 0, proven = 0, by_closed_form = 0;
  for (int i = 0; i < test::effort(400); ++i) {
    const double largest_mm = draw.in(0.005, 0.2);
    const Pair drawn = draw_pair(draw, largest_mm);
    const Stated a = state(drawn.a, largest_mm, draw), b = state(drawn.b, largest_mm, draw);
    const OverlapQuery query = query_of(a, b, drawn.X_BA);
    const PairFrame pair(query);
    const KnownOverlaps known =
        known_overlaps(pair, find_candidate_triangles({&pair, pair.near_mm}));
    for (int j = 0; j < 400; ++j) {
      const Layer layer = std::array{Layer::kMesh, Layer::kLower, Layer::kUpper}[j % 3];
      const int role = draw.up_to(2);
      const auto probe = draw_probe(pair, layer, role, draw);
      if (!probe) continue;
      DepthProof proof = proof_of(pair, layer, role, *probe, known);
      proof.limit_mm = pair.touch_mm;
      const double below_mm = below_closed_form_mm(proof, *probe, probe->at_center.triangle);
      by_closed_form += below_mm > -largest_mm;
      EXPECT_LE(below_mm, 1e-6) << "case " << i << ", probe " << j;
      if (probe->deepest_mm < pair.touch_mm) continue;
      for (const double less_mm : {2e-6, 1e-3, 0.1}) {
        // Outside, a depth is known by its sign only.
        proof.limit_mm = probe->deepest_mm - less_mm;
        if (proof.limit_mm < pair.touch_mm) continue;
        ++asked;
        if (!depth_at_most(proof, probe->patch, scratch)) continue;
        if (++wrong <= 5)
          ADD_FAILURE() << "case " << i << ", probe " << j << ", layer " << static_cast<int>(layer)
                        << ": " << probe->deepest_mm << " mm deep, proven " << proof.limit_mm;
      }
      proof.limit_mm = probe->deepest_mm + 0.2 * largest_mm + probe->patch.thickness();
      proven += depth_at_most(proof, probe->patch, scratch);
    }
  }
  std::printf("%d claims that are wrong, %d of true ones proven, %d wrong ones; %d closed forms\n",
              asked, proven, wrong, by_closed_form);
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(asked, 1000);
  EXPECT_GT(proven, 1000);
  EXPECT_GT(by_closed_form, 200);
}

}  // namespace
}  // namespace mortise::bench
