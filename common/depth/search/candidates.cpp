#include "common/depth/search/candidates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>

#include "common/geometry/triangle_distance.h"
#include "common/geometry/triangle_meeting.h"

namespace mortise {
namespace {

// An overlap of a smaller share of the radius than this is next to the wall that it is of.
constexpr double kShallowShare = 0.05;

constexpr std::int32_t kMixed = Body::kMixed;

// Is the closed form narrow, and reached on both faces, not only on their surfaces continued?
bool is_tight(const PairFrame& frame, const KnownFacePair& pair);

enum class Mark : std::uint8_t { kNone = 0, kNear, kCrossing };

// The marks of all triangles of a part. Only pages with a mark are there: a look at two parts of a
// million triangles reaches some hundred of them.
class Marks {
 public:
  void begin(std::size_t triangles) { pages_.resize((triangles + kPage - 1) / kPage); }
  Mark operator[](std::uint32_t triangle) const {
    const auto& page = pages_[triangle / kPage];
    return page ? (*page)[triangle % kPage] : Mark::kNone;
  }
  Mark& change(std::uint32_t triangle) {
    auto& page = pages_[triangle / kPage];
    if (!page) page = std::make_unique<Page>();
    return (*page)[triangle % kPage];
  }

 private:
  static constexpr std::uint32_t kPage = 1024;  // cleared as fast as one triangle is looked at
  using Page = std::array<Mark, kPage>;
  std::vector<std::unique_ptr<Page>> pages_;
};

struct Side {
  std::int32_t child = 0;
  std::int32_t face = kMixed;
  Vec3 center = Vec3::Zero(), half = Vec3::Zero();  // part frame
};

class Finder {
 public:
  explicit Finder(const CandidateQuery& query)
      : query_(query),
        pair_(*query.pair),
        reach_mm_(std::max(query.margin_mm, pair_.touch_mm) + pair_.rounding_mm),
        R_(pair_.X_KS[0].rotation()),
        R_abs_(R_.cwiseAbs()) {
    for (int i = 0; i < 2; ++i) {
      marked_[i].begin(pair_.bodies[i].mesh->triangles.size());
      if (query_.closed_forms && !pair_.trivial && has_surfaces(pair_.bodies[i]))
        faces_[i] = &pair_.bodies[i].face_of_child();
    }
  }

  Candidates run() {
    found_.has_meetings = query_.want_meetings;
    Side a = root(0), b = root(1);
    visit(a, b);
    for (std::vector<std::uint32_t>& triangles : found_.triangles)
      std::sort(triangles.begin(), triangles.end());
    for (auto& [faces, slot] : known_) {
      if (!slot.known || (slot.nodes[0].empty() && slot.triangles[0].empty())) continue;
      for (int i = 0; i < 2; ++i) {
        slot.known->triangles[i] = std::move(slot.triangles[i]);
        collect(i, slot.nodes[i], slot.known->triangles[i]);
      }
      found_.known.push_back(std::move(*slot.known));
    }
    return std::move(found_);
  }

 private:
  struct Slot {
    std::optional<KnownFacePair> known;
    std::vector<std::int32_t> nodes[2];
    std::vector<std::uint32_t> triangles[2];
  };

  static bool has_surfaces(const Body& body) {
    for (const SurfaceBand::Face& face : body.band->faces)
      if (Body::surface_of(face, Layer::kUpper) != nullptr) return true;
    return false;
  }

  Side root(int i) {
    const Bvh& bvh = pair_.bodies[i].solid->bvh();
    return {bvh.root, kMixed, bvh.bounds.center(), bvh.bounds.half()};
  }

  bool apart(const Side& a, const Side& b) const {
    const Vec3 d_B = pair_.X_KS[0] * a.center - b.center;
    const Vec3 reach_B = R_abs_ * a.half + b.half;
    if (((d_B.cwiseAbs() - reach_B).array() > reach_mm_).any()) return true;
    const Vec3 reach_A = R_abs_.transpose() * b.half + a.half;
    return (((R_.transpose() * d_B).cwiseAbs() - reach_A).array() > reach_mm_).any();
  }

  void visit(const Side& a, const Side& b) {
    ++found_.tests;
    if (apart(a, b) || is_known(a, b)) return;
    if (a.child < 0 && b.child < 0) {
      leaves(a.child, b.child);
      return;
    }
    const bool open_a = b.child < 0 || (a.child >= 0 && a.half.sum() >= b.half.sum());
    const int i = open_a ? 0 : 1;
    const Bvh& bvh = pair_.bodies[i].solid->bvh();
    const std::int32_t n = open_a ? a.child : b.child;
    const Bvh::Node& node = bvh.nodes[n];
    for (int k = 0; k < node.count; ++k) {
      Side side;
      side.child = node.child[k];
      side.face = faces_[i] ? (*faces_[i])[n][k] : kMixed;
      for (int c = 0; c < 3; ++c) {
        side.center[c] = bvh.origin[c] + static_cast<double>(node.local_center[c][k]);
        side.half[c] = static_cast<double>(node.half[c][k]);
      }
      open_a ? visit(side, b) : visit(a, side);
    }
  }

  Slot* known_of(std::int32_t face_a, std::int32_t face_b) {
    if (face_a == kMixed || face_b == kMixed || !faces_[0] || !faces_[1]) return nullptr;
    const auto [at, fresh] = known_.try_emplace({face_a, face_b});
    Slot& slot = at->second;
    if (fresh) slot.known = closed_form(face_a, face_b);
    return slot.known ? &slot : nullptr;
  }

  bool is_known(const Side& a, const Side& b) {
    Slot* slot = known_of(a.face, b.face);
    if (slot == nullptr) return false;
    slot->nodes[0].push_back(a.child);
    slot->nodes[1].push_back(b.child);
    return true;
  }

  std::optional<KnownFacePair> closed_form(std::int32_t face_a, std::int32_t face_b) {
    const SurfaceBand::Face& fa = pair_.bodies[0].band->faces[face_a];
    const SurfaceBand::Face& fb = pair_.bodies[1].band->faces[face_b];
    const Surface* sa = Body::surface_of(fa, Layer::kUpper);
    const Surface* sb = Body::surface_of(fb, Layer::kUpper);
    if (sa == nullptr || sb == nullptr) return std::nullopt;
    KnownFacePair pair;
    pair.face[0] = static_cast<std::uint16_t>(face_a);
    pair.face[1] = static_cast<std::uint16_t>(face_b);
    std::array<PairOffsets, 2> layers;
    for (const Layer layer : {Layer::kLower, Layer::kUpper})
      layers[layer == Layer::kUpper] = {Body::offset_of(fa, layer), Body::offset_of(fb, layer)};
    const auto overlap = face_pair_overlap(*sa, extent_of(pair_.bodies[0], pair.face[0], *sa), *sb,
                                           extent_of(pair_.bodies[1], pair.face[1], *sb),
                                           pair_.X_KS[0], query_.margin_mm, &layers);
    if (!overlap) return cone_in_bore(pair);
    pair.overlap = *overlap;
    const double upper = Body::offset_of(fa, Layer::kUpper) + Body::offset_of(fb, Layer::kUpper);
    const bool never = overlap->near_hi_mm + upper <= pair_.touch_mm;
    if (never || is_tight(pair_, pair)) return pair;
    found_.bounded.push_back(pair);
    return std::nullopt;
  }

  // A chamfer or taper in a bore that it cannot touch.
  std::optional<KnownFacePair> cone_in_bore(KnownFacePair pair) const {
    const SurfaceBand::Face& fa = pair_.bodies[0].band->faces[pair.face[0]];
    const SurfaceBand::Face& fb = pair_.bodies[1].band->faces[pair.face[1]];
    if (fa.surface->kind != SurfaceKind::kCone && fb.surface->kind != SurfaceKind::kCone)
      return std::nullopt;
    const InBoreBound bound = in_bore_bound(pair_, pair.face[0], pair.face[1], query_.margin_mm);
    const double upper = Body::offset_of(fa, Layer::kUpper) + Body::offset_of(fb, Layer::kUpper);
    if (!(bound.face_mm + upper <= pair_.touch_mm)) return std::nullopt;
    pair.overlap.hi_mm = pair.overlap.near_hi_mm = bound.face_mm;
    pair.overlap.lo_mm = -std::numeric_limits<double>::infinity();
    pair.overlap.of_layer_mm.fill({pair.overlap.lo_mm, pair.overlap.hi_mm});
    return pair;
  }

  void leaves(std::int32_t a, std::int32_t b) {
    const Bvh& bvh_a = pair_.bodies[0].solid->bvh();
    const Bvh& bvh_b = pair_.bodies[1].solid->bvh();
    const Bvh::Leaf& leaf_a = bvh_a.leaves[~a];
    const Bvh::Leaf& leaf_b = bvh_b.leaves[~b];
    for (std::uint32_t i = leaf_a.first; i < leaf_a.first + leaf_a.count; ++i) {
      const std::uint32_t ta = bvh_a.triangle_order[i];
      Triangle ca;
      Box box;
      for (int k = 0; k < 3; ++k) {
        ca[k] = pair_.X_KS[0] * pair_.bodies[0].mesh->corner(ta, k);
        box.add(ca[k]);
      }
      const Box grown = box.grown(reach_mm_);
      for (std::uint32_t j = leaf_b.first; j < leaf_b.first + leaf_b.count; ++j) {
        const std::uint32_t tb = bvh_b.triangle_order[j];
        const Mark most = query_.want_meetings ? Mark::kCrossing : Mark::kNear;
        const bool news = marked_[0][ta] < most || marked_[1][tb] < most;
        if (!news && !(query_.want_crossing && !found_.cross)) continue;
        const Triangle cb = {pair_.bodies[1].mesh->corner(tb, 0),
                             pair_.bodies[1].mesh->corner(tb, 1),
                             pair_.bodies[1].mesh->corner(tb, 2)};
        Box box_b;
        for (const Vec3& x : cb) box_b.add(x);
        if (!grown.overlaps(box_b)) continue;
        Mark mark = Mark::kNear;
        if (query_.want_meetings) {
          const Meeting meeting = meeting_of(ca, cb, pair_.touch_mm);
          if (meeting == Meeting::kApart) continue;
          if (meeting == Meeting::kCrossing) mark = Mark::kCrossing;
        } else if (beyond_plane(ca, cb, reach_mm_) || beyond_plane(cb, ca, reach_mm_)) {
          continue;
        }
        if (Slot* slot = known_of(pair_.bodies[0].face_index(ta), pair_.bodies[1].face_index(tb))) {
          slot->triangles[0].push_back(ta);
          slot->triangles[1].push_back(tb);
          continue;
        }
        set(0, ta, mark, tb);
        set(1, tb, mark, ta);
        if (query_.want_crossing && !found_.cross && triangles_cross(ca, cb)) {
          found_.cross = true;
          found_.cross_triangle[0] = ta;
          found_.cross_triangle[1] = tb;
          const Box both{box.lo.cwiseMax(box_b.lo), box.hi.cwiseMin(box_b.hi)};
          found_.cross_point_B = both.center();
        }
      }
    }
  }

  void set(int i, std::uint32_t t, Mark mark, std::uint32_t partner) {
    Mark& now = marked_[i].change(t);
    if (now >= mark) return;
    if (now == Mark::kNone) found_.triangles[i].push_back(t);
    if (mark == Mark::kCrossing) found_.crossing[i][t] = partner;
    now = mark;
  }

  // All of x on one side of the plane of t, farther than m.
  static bool beyond_plane(const Triangle& x, const Triangle& t, double m) {
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    const double limit = m * n.norm();
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const Vec3& p : x) {
      const double h = n.dot(p - t[0]);
      lo = std::min(lo, h);
      hi = std::max(hi, h);
    }
    return lo > limit || hi < -limit;
  }

  void collect(int i, std::vector<std::int32_t>& nodes, std::vector<std::uint32_t>& triangles) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    const Bvh& bvh = pair_.bodies[i].solid->bvh();
    std::vector<std::int32_t> stack = nodes;
    while (!stack.empty()) {
      const std::int32_t child = stack.back();
      stack.pop_back();
      if (child < 0) {
        const Bvh::Leaf& leaf = bvh.leaves[~child];
        for (std::uint32_t k = leaf.first; k < leaf.first + leaf.count; ++k)
          triangles.push_back(bvh.triangle_order[k]);
        continue;
      }
      const Bvh::Node& node = bvh.nodes[child];
      for (int k = 0; k < node.count; ++k) stack.push_back(node.child[k]);
    }
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  }

  const CandidateQuery& query_;
  const PairFrame& pair_;
  const double reach_mm_;  // of boxes and triangles of both parts
  const Mat3 R_, R_abs_;
  // Null where no face has a surface.
  const std::vector<std::array<std::int32_t, Bvh::kWidth>>* faces_[2] = {nullptr, nullptr};
  Marks marked_[2];
  std::map<std::pair<std::int32_t, std::int32_t>, Slot> known_;
  Candidates found_;
};

}  // namespace

namespace {

// Of a tube and its wall: is there a point as deep in both parts as the closed form says? The face
// beside the end of a groove may be nearer to the tube's deepest point than the groove is. Then the
// foot of that point may still be as deep in the tube.
bool is_reached(const PairFrame& frame, const KnownFacePair& pair) {
  const auto depth_of = [&](int i, const Vec3& x_B) {
    const Body& body = frame.bodies[i];
    const Vec3 x = i == 0 ? Vec3(frame.X_KS[1] * x_B) : x_B;
    return body.depth_in(x, nearest_surface(*body.solid, x), Layer::kLower) -
           Body::offset_of(body.band->faces[pair.face[i]], Layer::kLower);
  };
  const auto foot_of = [&](int i, const Vec3& x_B) {
    const Surface& surface = *frame.bodies[i].band->faces[pair.face[i]].surface;
    const Vec3 x = i == 0 ? Vec3(frame.X_KS[1] * x_B) : x_B;
    const Vec3 foot = x - surface.signed_distance_mm(x) * surface.outward_normal(x);
    return i == 0 ? Vec3(frame.X_KS[0] * foot) : foot;
  };
  const Vec3& x_B = pair.overlap.point_B;
  for (const Vec3& at_B : {x_B, foot_of(0, x_B), foot_of(1, x_B)})
    if (depth_of(0, at_B) + depth_of(1, at_B) >= pair.overlap.lo_mm - kDepthAccuracyDefault_mm)
      return true;
  return false;
}

bool is_tight(const PairFrame& frame, const KnownFacePair& pair) {
  for (const Interval& of_layer : pair.overlap.of_layer_mm)
    if (!(of_layer.hi - of_layer.lo <= kDepthAccuracyDefault_mm)) return false;
  if (std::isfinite(pair.overlap.continued_hi_mm) && !is_reached(frame, pair)) return false;
  const auto on_face = [&](int i, const Vec3& x) {
    const Body& body = frame.bodies[i];
    if (!body.stands_for(pair.face[i], x)) return false;
    // Far behind a wall there may be anything: then the face has to be the nearest one.
    const Surface& surface = *body.band->faces[pair.face[i]].surface;
    const Vec3 from = x - surface.point;
    const double radius = surface.kind == SurfaceKind::kTorus ? surface.tube_radius_mm
                          : surface.kind == SurfaceKind::kCone
                              ? (from - from.dot(surface.axis) * surface.axis).norm()
                              : surface.radius_mm;
    return std::fabs(pair.overlap.hi_mm) <= kShallowShare * radius ||
           body.face_index(nearest_point(*body.solid, x).triangle) == pair.face[i];
  };
  return on_face(0, frame.X_KS[1] * pair.overlap.point_B) && on_face(1, pair.overlap.point_B);
}

}  // namespace

InBoreBound in_bore_bound(const PairFrame& pair, std::uint16_t face_a, std::uint16_t face_b,
                          double margin_mm) {
  InBoreQuery query;
  const SurfaceBand::Face& fa = pair.bodies[0].band->faces[face_a];
  const SurfaceBand::Face& fb = pair.bodies[1].band->faces[face_b];
  query.a = Body::surface_of(fa, Layer::kUpper);
  query.b = Body::surface_of(fb, Layer::kUpper);
  if (query.a == nullptr || query.b == nullptr || !is_round_in_bore(*query.a, *query.b)) return {};
  query.extent_a = extent_of(pair.bodies[0], face_a, *query.a);
  query.extent_b = extent_of(pair.bodies[1], face_b, *query.b);
  query.most_inward_mm = std::max(0.0, -Body::offset_of(query.a->inward ? fb : fa, Layer::kLower));
  query.margin_mm = margin_mm;
  return in_bore_bound(query, pair.X_KS[0]);
}

Candidates find_candidate_triangles(const CandidateQuery& query) { return Finder(query).run(); }

namespace {

KnownOverlaps::Row row_of(const PairFrame& pair, const KnownFacePair& known, bool told) {
  KnownOverlaps::Row row{{known.face[0], known.face[1]}, known.overlap.near_hi_mm};
  row.told = told;
  row.told_mm = known.overlap.hi_mm;
  // Of a torus the ends are angles: what is known of it holds everywhere, or of its faces alone.
  if (std::isfinite(known.overlap.continued_hi_mm)) {
    row.within_mm = row.along_mm = known.overlap.continued_hi_mm;
    const bool all = known.overlap.near_hi_mm >= known.overlap.continued_hi_mm;
    row.holds_along_mm[0] = row.holds_along_mm[1] = all ? kEverywhere_mm : Interval{1.0, -1.0};
    return row;
  }
  for (int i = 0; i < 2; ++i) {
    const Surface& surface = *pair.bodies[i].band->faces[known.face[i]].surface;
    if (surface.kind == SurfaceKind::kSphere && !surface.inward) continue;  // all of the ball
    const FaceExtent extent = extent_of(pair.bodies[i], known.face[i], surface);
    row.holds_along_mm[i] = {extent.lo_mm - extent.beyond_mm[0] - pair.near_mm,
                             extent.hi_mm + extent.beyond_mm[1] + pair.near_mm};
  }
  const Surface& a = *pair.bodies[0].band->faces[known.face[0]].surface;
  if (a.kind == SurfaceKind::kCone && std::isfinite(known.overlap.near_hi_mm)) {
    // Between its ends the inside of a cone is the hull of its end circles, over which the convex
    // distance is no larger than on them.
    const int convex = a.inward ? 1 : 0;
    row.within_mm = known.overlap.near_hi_mm;
    row.within_extent_mm = pair.bodies[convex].extent_of(known.face[convex]);
  }
  return row;
}

void add_in_bore_rows(const PairFrame& pair, KnownOverlaps& known) {
  if (pair.trivial) return;
  const auto& faces_a = pair.bodies[0].band->faces;
  const auto& faces_b = pair.bodies[1].band->faces;
  const auto count_a = static_cast<std::uint16_t>(faces_a.size());
  const auto count_b = static_cast<std::uint16_t>(faces_b.size());
  for (std::uint16_t i = 0; i < count_a; ++i)
    for (std::uint16_t j = 0; j < count_b; ++j) {
      const InBoreBound bound = in_bore_bound(pair, i, j, pair.near_mm);
      if (!std::isfinite(bound.face_mm)) continue;
      const auto row = std::find_if(known.rows.begin(), known.rows.end(), [&](const auto& r) {
        return r.face[0] == i && r.face[1] == j;
      });
      if (row != known.rows.end()) {
        row->within_mm = bound.within_mm;
        row->along_mm = bound.along_mm;
        continue;
      }
      const double upper =
          Body::offset_of(faces_a[i], Layer::kUpper) + Body::offset_of(faces_b[j], Layer::kUpper);
      if (bound.face_mm + upper > pair.touch_mm) continue;
      KnownOverlaps::Row found{.face = {i, j}, .overlap_mm = bound.face_mm};
      found.within_mm = bound.within_mm;
      found.along_mm = bound.along_mm;
      found.holds_along_mm[0] = bound.holds_along_mm[0];
      found.holds_along_mm[1] = bound.holds_along_mm[1];
      found.told = false;
      known.rows.push_back(found);
    }
}

}  // namespace

KnownOverlaps known_overlaps(const PairFrame& pair, const Candidates& candidates) {
  KnownOverlaps known;
  for (const KnownFacePair& face_pair : candidates.known)
    known.rows.push_back(row_of(pair, face_pair, true));
  for (const KnownFacePair& face_pair : candidates.bounded)
    known.rows.push_back(row_of(pair, face_pair, false));
  add_in_bore_rows(pair, known);
  known.X_BA = pair.X_KS[0];
  return known;
}

void leave_to_search(const KnownFacePair& pair, Candidates& candidates, KnownOverlaps& known) {
  for (KnownOverlaps::Row& row : known.rows)
    if (row.face[0] == pair.face[0] && row.face[1] == pair.face[1]) row.told = false;
  for (int role = 0; role < 2; ++role) {
    std::vector<std::uint32_t>& all = candidates.triangles[role];
    all.insert(all.end(), pair.triangles[role].begin(), pair.triangles[role].end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
  }
}

}  // namespace mortise
