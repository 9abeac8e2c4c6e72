#include "common/depth/search/tip_reach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/depth/body_tips.h"
#include "common/depth/cells/least_reach.h"
#include "common/depth/triangles_in.h"

namespace mortise {
namespace {

// Pieces of all tips of a pair that are looked at.
constexpr std::uint64_t kMostLooks = 4000;
// A piece smaller than this that is not excluded is told, mm.
constexpr double kSmallest_mm = 2e-4;
// An edge of curved faces is followed by chords until they are off by less, mm, or so many
// halvings.
constexpr double kSag_mm = 2e-5;
constexpr int kMostChordHalvings = 7;
// The bulge of an arc is no larger than this many times that in the middle of its chord.
constexpr double kSagMargin = 1.1;
// Planes of one face.
constexpr double kSamePlane = 1.0 - 1e-9;
// A box around a piece is wide enough to show what bounds the largest body in it: so many times as
// far as its surface may be off the mesh. Corners of one plane differ by this share of the part.
constexpr double kReaches = 2.0, kFlatCorner = 1e-12;
// Faces that are asked whether all is below them.
constexpr std::size_t kMostFacesAsked = 16;
// Pieces that are so much of the distance of their middles deep in each other are not apart.
constexpr double kDeepShare = 1e-2;
// Another look is worth what it gains.
constexpr double kWorthLook = 0.5;

// A convex piece of what a tip adds to the faces' own offsets, frame K: the hull of its corners,
// and how far the tip may bulge out of it. Four corners: a simplex; more: `simplices` cover it.
struct TipPiece {
  std::vector<Vec3> corners;
  std::vector<std::array<int, 4>> simplices;
  double bulge_mm = 0.0;
  std::uint32_t triangle = 0;  // of the tip's part

  Vec3 middle() const {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& corner : corners) sum += corner;
    return sum / static_cast<double>(corners.size());
  }
  double radius_mm(const Vec3& x) const {
    double most = 0.0;
    for (const Vec3& corner : corners) most = std::max(most, (corner - x).norm());
    return most + bulge_mm;
  }
  const Vec3& farthest(const Vec3& n) const {
    return *std::max_element(corners.begin(), corners.end(),
                             [&](const Vec3& a, const Vec3& b) { return n.dot(a) < n.dot(b); });
  }
  double support_mm(const Vec3& n) const { return n.dot(farthest(n)) + bulge_mm; }
  TipPiece part(std::vector<Vec3> of_corners) const {
    return {std::move(of_corners), {}, bulge_mm, triangle};
  }
  void split(std::vector<TipPiece>& into) const;
};

void TipPiece::split(std::vector<TipPiece>& into) const {
  for (const auto& s : simplices)
    into.push_back(part({corners[s[0]], corners[s[1]], corners[s[2]], corners[s[3]]}));
  if (!simplices.empty()) return;
  std::size_t from = 0, to = 1;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t k = i + 1; k < corners.size(); ++k)
      if ((corners[i] - corners[k]).squaredNorm() > (corners[from] - corners[to]).squaredNorm()) {
        from = i;
        to = k;
      }
  const Vec3 middle = 0.5 * (corners[from] + corners[to]);
  for (const std::size_t k : {from, to}) {
    into.push_back(part(corners));
    into.back().corners[k] = middle;
  }
}

// What tips of a part add to its faces' own offsets, seen from K.
class TipPieces {
 public:
  TipPieces(const Body& body, const Pose& X_KS) : body_(body), X_KS_(X_KS) {}

  // Of the stretch of an edge between two points of it.
  void edge(const Tip& tip, const Vec3& from, const Vec3& to, std::vector<TipPiece>& into) const {
    const LargestFace a = face(tip, 0), b = face(tip, 1);
    const auto section = [&](const Vec3& on_mesh) {
      const Vec3 x = meeting_point(*body_.solid, *body_.band, tip, on_mesh, false);
      if (!goes_outwards(a, b, x)) return std::array<Vec3, 4>{x, x, x, x};
      return std::array<Vec3, 4>{a.foot(x), meeting_point(*body_.solid, *body_.band, tip, x, true),
                                 b.foot(x), x};
    };
    const auto one = section(from), two = section(to), middle = section(0.5 * (from + to));
    double sag_mm = 0.0;
    for (int i = 0; i < 4; ++i)
      sag_mm = std::max(sag_mm, (middle[i] - 0.5 * (one[i] + two[i])).norm());
    const auto prism = [&](int top) {
      TipPiece piece{{one[0], one[top], one[2], two[0], two[top], two[2]},
                     {{0, 1, 2, 5}, {0, 1, 4, 5}, {0, 3, 4, 5}},
                     kSagMargin * sag_mm,
                     tip.triangles[0]};
      add(piece, into);
    };
    prism(1);
    // A foot that moved inwards: the edge of the mesh is beyond the line of both.
    if (a.offset_mm() < 0.0 || b.offset_mm() < 0.0) prism(3);
  }

  // The hull of a corner, of the ends of its edges and of its feet on the faces.
  void corner(const Tip& tip, std::vector<TipPiece>& into) const {
    const Vec3& x = tip.from;
    TipPiece piece;
    piece.triangle = tip.triangles[0];
    piece.corners = {meeting_point(*body_.solid, *body_.band, tip, x, true)};
    for (int i = 0; i < 3; ++i) piece.corners.push_back(face(tip, i).foot(x));
    for (int i = 0; i < 3; ++i) {
      Tip pair = tip;
      pair.faces = 2;
      pair.triangles = {tip.triangles[i], tip.triangles[(i + 1) % 3], 0};
      piece.corners.push_back(meeting_point(*body_.solid, *body_.band, pair, x, true));
    }
    piece.corners.push_back(x);
    piece.corners.push_back(piece.middle());
    for (int i = 0; i < 3; ++i) {
      const int foot = 1 + i, next = 1 + (i + 1) % 3, end = 4 + i, before = 4 + (i + 2) % 3;
      for (const std::array<int, 3>& side :
           {std::array{0, before, foot}, {0, foot, end}, {end, foot, next}, {7, foot, next}})
        piece.simplices.push_back({8, side[0], side[1], side[2]});
    }
    add(piece, into);
  }

  void whole(const Tip& tip, std::vector<TipPiece>& into) const {
    if (tip.faces == 3)
      corner(tip, into);
    else
      edge(tip, tip.from, tip.to, into);
  }

 private:
  LargestFace face(const Tip& tip, int i) const {
    return {*body_.solid, *body_.band, tip.triangles[i]};
  }
  void add(TipPiece& piece, std::vector<TipPiece>& into) const {
    for (Vec3& corner : piece.corners) corner = X_KS_ * corner;
    into.push_back(piece);
  }

  const Body& body_;
  const Pose X_KS_;
};

// Upper bound of the depth of any point of a piece in the largest body of K.
class DepthBound {
 public:
  DepthBound(const Body& body, const TipPiece& piece) : body_(body), piece_(piece) {
    middle_ = piece.middle();
    radius_mm_ = piece.radius_mm(middle_);
    nearest_ = nearest_surface(*body.solid, middle_);
  }

  const SurfacePoint& nearest() const { return nearest_; }

  /// Looks no closer where the bound is no more than enough_mm.
  double mm(double enough_mm) const {
    const double from_mm = std::fabs(nearest_.depth_mm), most_mm = body_.band->largest_offset_mm;
    if (nearest_.depth_mm < 0.0 && from_mm > radius_mm_ + most_mm)
      return radius_mm_ + most_mm - from_mm;
    // Some face that is nearest to a point of the piece is nearest there to the depth in it.
    const double reach_mm = from_mm + 2.0 * radius_mm_;
    const bool may_be_inside = nearest_.depth_mm + radius_mm_ > 0.0;
    double most = -kInfinity, any = kInfinity;
    bool one_face = true;
    std::uint32_t first = Topology::kNone;
    for_each_triangle_in(
        body_.solid->bvh(), Box{middle_.array() - reach_mm, middle_.array() + reach_mm},
        [&](std::uint32_t t, const std::array<Vec3, 3>& c) {
          const double away_mm = (nearest_on_triangle(middle_, c[0], c[1], c[2]) - middle_).norm();
          if (away_mm > reach_mm) return;
          if (first == Topology::kNone) first = t;
          one_face &= is_one_face(first, t);
          const Interval offset_mm = Body::offset_range_of(body_.face(t), Layer::kUpper);
          any = std::min(any, away_mm + radius_mm_ + offset_mm.hi);
          double below = below_face(t, c[0]);
          if (!may_be_inside) below = std::min(below, radius_mm_ - away_mm + offset_mm.hi);
          most = std::max(most, below);
        });
    // Inside the mesh no point is deeper than its distance from any one triangle.
    if (may_be_inside && !one_face) most = std::max(most, any);
    return most > enough_mm ? std::min(most, below_any_face(enough_mm)) : most;
  }

 private:
  bool is_one_face(std::uint32_t t, std::uint32_t other) const {
    return body_.face_index(t) == body_.face_index(other) &&
           (Body::surface_of(body_.face(t), Layer::kUpper) != nullptr ||
            body_.normal(t).dot(body_.normal(other)) > kSamePlane);
  }

  // Where all of K near the piece is below one of its faces, no point is deeper than below that.
  double below_any_face(double enough_mm) const {
    const double reach_mm = radius_mm_ + kReaches * body_.band->farthest_mm();
    std::vector<std::uint32_t> faces, triangles;
    for_each_triangle_in(
        body_.solid->bvh(), Box{middle_.array() - reach_mm, middle_.array() + reach_mm},
        [&](std::uint32_t t, const std::array<Vec3, 3>&) {
          triangles.push_back(t);
          if (faces.size() < kMostFacesAsked &&
              std::none_of(faces.begin(), faces.end(),
                           [&](std::uint32_t other) { return is_one_face(t, other); }))
            faces.push_back(t);
        });
    double least = kInfinity;
    for (const std::uint32_t face : faces) {
      const double below = below_face(face, body_.mesh->corner(face, 0));
      if (below >= least) continue;
      if (std::all_of(triangles.begin(), triangles.end(),
                      [&](std::uint32_t t) { return is_below(t, face); }))
        least = below;
      if (least <= enough_mm) break;
    }
    return least;
  }

  bool is_below(std::uint32_t t, std::uint32_t face) const {
    const TriangleMesh& mesh = *body_.mesh;
    const SurfaceBand::Face& band = body_.face(face);
    const double extent_mm = body_.solid->bvh().extent_mm;
    if (const Surface* surface = Body::surface_of(band, Layer::kUpper))
      return surface->stays_below_mm(
          mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2),
          std::max(0.0, -band.deviation_mm.lo) + kFlatCorner * extent_mm);
    for (int k = 0; k < 3; ++k)
      if (body_.normal(face).dot(mesh.corner(t, k) - mesh.corner(face, 0)) >
          kFlatCorner * extent_mm)
        return false;
    return true;
  }

  // Below one face, continued: a distance that is convex is largest at a corner, a concave one is
  // below its tangent.
  double below_face(std::uint32_t t, const Vec3& on_t) const {
    const double offset_mm = Body::offset_of(body_.face(t), Layer::kUpper);
    const Surface* surface = Body::surface_of(body_.face(t), Layer::kUpper);
    if (surface == nullptr)
      return offset_mm + piece_.support_mm(-body_.normal(t)) + body_.normal(t).dot(on_t);
    const double at_middle = -surface->signed_distance_mm(middle_);
    double below = at_middle + radius_mm_;
    if (surface->kind != SurfaceKind::kTorus) {
      const Vec3 n = surface->outward_normal(middle_);
      double most = -kInfinity;
      for (const Vec3& x : piece_.corners)
        most = std::max(most, surface->inward ? -surface->signed_distance_mm(x)
                                              : at_middle - n.dot(x - middle_));
      below = std::min(below, most + piece_.bulge_mm);
    }
    return below + offset_mm;
  }

  const Body& body_;
  const TipPiece& piece_;
  Vec3 middle_;
  double radius_mm_ = 0.0;
  SurfacePoint nearest_;
};

// Are two convex pieces apart?
bool apart(const TipPiece& a, const TipPiece& b) {
  const double bulge_mm = a.bulge_mm + b.bulge_mm;
  bool found = false;
  const auto farthest = [&](const Vec3& n) { return PointOfEach{b.farthest(n), a.farthest(-n)}; };
  const auto tried = [&](const Vec3&, double reach_mm) {
    return found = reach_mm + bulge_mm <= 0.0;
  };
  const Vec3 between = a.middle() - b.middle();
  const double size_mm = between.norm();
  if (size_mm > 0.0)
    LeastReach(farthest, tried, size_mm).run(between / size_mm, kDeepShare * size_mm, kWorthLook);
  return found;
}

class TipSearch {
 public:
  TipSearch(const PairFrame& pair, int role, std::uint64_t& looks)
      : pair_(pair),
        role_(role),
        s_(pair.s(role)),
        k_(pair.k(role)),
        of_s_(s_, pair.X_KS[role]),
        of_k_(k_, Pose()),
        looks_(looks) {}

  std::optional<TipReach> run() {
    const double far_mm = k_.band->farthest_mm() + pair_.touch_mm;
    const Box near = k_.solid->bounds().grown(far_mm);
    for (const Tip& tip : tips_of(s_)) {
      const Vec3 from = pair_.X_KS[role_] * tip.from, to = pair_.X_KS[role_] * tip.to;
      Box box;
      box.add(from);
      box.add(to);
      if (!box.grown(tip.travel_mm).overlaps(near)) continue;
      const Vec3 middle = 0.5 * (from + to);
      const double reach_mm = 0.5 * (to - from).norm() + tip.travel_mm + far_mm;
      if (nearest_point(*k_.solid, middle, reach_mm).triangle == Topology::kNone &&
          !inside(*k_.solid, middle))
        continue;
      const bool excluded =
          tip.faces == 3 ? is_excluded(tip) : is_excluded(tip, tip.from, tip.to, 0);
      if (!excluded) return found_;
    }
    return std::nullopt;
  }

 private:
  bool is_excluded(const Tip& corner) {
    std::vector<TipPiece> pieces;
    of_s_.corner(corner, pieces);
    return is_excluded(std::move(pieces));
  }

  // An edge of curved faces is followed more closely where its chord does not settle it.
  bool is_excluded(const Tip& edge, const Vec3& from, const Vec3& to, int level) {
    std::vector<TipPiece> pieces;
    of_s_.edge(edge, from, to, pieces);
    bool all = true;
    for (const TipPiece& piece : pieces) all = all && is_excluded(piece);
    if (all) return true;
    if (has_reached()) return false;
    if (pieces.front().bulge_mm <= kSag_mm || level == kMostChordHalvings)
      return is_excluded(std::move(pieces));
    const Vec3 middle = 0.5 * (from + to);
    return is_excluded(edge, from, middle, level + 1) && is_excluded(edge, middle, to, level + 1);
  }

  bool is_excluded(std::vector<TipPiece> open) {
    while (!open.empty()) {
      const TipPiece piece = std::move(open.back());
      open.pop_back();
      if (is_excluded(piece)) continue;
      const double size_mm = piece.radius_mm(piece.middle()) - piece.bulge_mm;
      if (has_reached() || looks_ > kMostLooks || size_mm < kSmallest_mm) return false;
      piece.split(open);
    }
    return true;
  }

  bool has_reached() const { return found_.possible_mm.lo > pair_.touch_mm; }

  // Nothing of the piece is in the largest body of K; else found_ tells of it.
  bool is_excluded(const TipPiece& piece) {
    ++looks_;
    const DepthBound bound(k_, piece);
    const double most_mm = bound.mm(pair_.touch_mm);
    const bool below_faces = most_mm > pair_.touch_mm;
    if (!below_faces && !meets_other_tip(piece)) return true;
    Vec3 at = piece.middle();
    double reached_mm = 0.0;
    for (const Vec3& x : piece.corners) {
      if (!below_faces) break;
      const double depth_mm = k_.depth_in(x, nearest_surface(*k_.solid, x), Layer::kUpper);
      if (depth_mm <= reached_mm) continue;
      reached_mm = depth_mm;
      at = x;
    }
    found_.role = role_;
    found_.triangle = piece.triangle;
    found_.other_triangle = bound.nearest().triangle;
    found_.point_W = pair_.in_world(role_, at);
    found_.possible_mm = {reached_mm, std::max({reached_mm, most_mm, 2.0 * pair_.touch_mm})};
    found_.gap_mm = std::max(0.0, -bound.nearest().depth_mm);
    return false;
  }

  bool meets_other_tip(const TipPiece& piece) const {
    const Vec3 middle = piece.middle();
    const double radius_mm = piece.radius_mm(middle);
    for (const Tip& tip : tips_of(k_)) {
      const double half_mm = 0.5 * (tip.to - tip.from).norm();
      if ((0.5 * (tip.from + tip.to) - middle).norm() > radius_mm + half_mm + tip.travel_mm)
        continue;
      std::vector<TipPiece> others;
      of_k_.whole(tip, others);
      for (const TipPiece& other : others)
        if (!apart(piece, other)) return true;
    }
    return false;
  }

  const PairFrame& pair_;
  int role_;
  const Body &s_, &k_;
  TipPieces of_s_, of_k_;
  std::uint64_t& looks_;
  TipReach found_;
};

}  // namespace

std::optional<TipReach> find_tip_reach(const PairFrame& pair, std::uint64_t& evaluations) {
  if (pair.trivial || !pair.bodies[0].has_inside || !pair.bodies[1].has_inside) return std::nullopt;
  std::uint64_t looks = 0;
  std::optional<TipReach> found;
  for (int role = 0; role < 2 && !found; ++role) found = TipSearch(pair, role, looks).run();
  evaluations += looks;
  return found;
}

}  // namespace mortise
