#include "common/depth/cells/cover_pair.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "common/depth/cells/least_reach.h"
#include "common/math/unit.h"

namespace mortise {
namespace {

// Spans that are looked at before what is proven so far has to do.
constexpr int kMostSpans = 400;
// Over a span longer than this share of the path anything that keeps cells apart is looked for.
constexpr double kLongSpan = 0.2;
// Cells that are so much of the distance of their middles deep in each other: that they are apart
// is out of the question.
constexpr double kDeep = 1e-2;
// Another look is worth what it gains: for a depth little, for whether there is any much.
constexpr double kLittle = 1e-3, kMuch = 0.5;
// Onto each of two cells, to find a point of both.
constexpr int kProjections = 6;
// What comes so much less far is as good a place to look at.
constexpr double kAsFar_mm = 2e-5;
// A place beside the rim of a face is this share of the way to its middle.
constexpr double kFromRim = 0.02;
// Normals this near to opposite are those of two sides of one slot; nobody is beyond both.
constexpr double kOpposite = 1.0 - 1e-12;
// Who goes along a face goes less than this share towards it.
constexpr double kAcross = 1e-9;

}  // namespace

// The least bound of one pair of cells; looks no further once it is not above the limit.
class CoverPair::Bound {
 public:
  /// Whether the pair stays below a limit, or how deep it may be as well.
  enum class Asked { kWhether, kHowDeep };

  Bound(const CoverPair& pair, const Views& views, double limit_mm, Asked asked,
        std::uint64_t& work)
      : pair_(pair), views_(views), limit_mm_(limit_mm), asked_(asked), work_(work) {}

  double operator()(Cells& cells) {
    if (by_what_it_was(cells)) return least_;
    if (by_direction(0, views_.chord[0].X_KS[0] * s(0).middle - k(0).middle)) return least_;
    for (const int role : {0, 1})
      if (k(role).round && off_axis(role)) return least_;
    for (const int role : {0, 1})
      for (const HalfSpace& face : k(role).faces)
        if (by_face(role, face)) return least_;
    for (const int role : {0, 1}) {
      const std::vector<Void>& voids = pair_.parts_[1 - role]->voids;
      for (std::size_t v = 0; v < voids.size(); ++v)
        if (by_void(role, v)) return least_;
    }
    descend();
    return least_;
  }

  // The bound by what kept these cells apart before alone.
  bool by_what_it_was(Cells& cells) {
    cells_ = &cells;
    least_ = kInfinity;
    return cells.keeper.role >= 0 && again(cells.keeper);
  }

 private:
  // Role r looks at the cell S of part r from K, a cell of part 1 - r.
  const ConvexCell& s(int role) const { return pair_.parts_[role]->cells[cells_->cell[role]]; }
  const ConvexCell& k(int role) const { return s(1 - role); }

  bool again(const CoverKeeper& last) {
    return last.by_void ? by_void(last.role, last.v) : by_direction(last.role, last.n);
  }

  // All of K is below, all of S above, along a direction fixed in K.
  bool by_direction(int role, const Vec3& towards) {
    const double length = towards.norm();
    // No direction at all.
    if (!(length > 1e-12)) return false;
    const Vec3 n = towards / length;
    return by_plane(role, {n, k(role).support_mm(n)});
  }

  bool by_plane(int role, const HalfSpace& plane) {
    ++work_;
    return take(beyond_plane_mm(s(role), views_.chord[role], plane), role, plane.n);
  }

  // S reaches at least as deep as its middle.
  bool by_face(int role, const HalfSpace& face) {
    const double middle_mm = face.c_mm - face.n.dot(views_.chord[role].X_KS[0] * s(role).middle);
    return middle_mm < useless_mm() && by_plane(role, face);
  }

  bool off_axis(int role) {
    const ConvexCell& cell = k(role);
    const Vec3 d = views_.chord[role].X_KS[0] * s(role).middle - cell.point;
    return by_direction(role, d - d.dot(cell.axis) * cell.axis);
  }

  // What of S is in K is beside a wall of the void, or beyond one of its planes.
  bool by_void(int role, std::size_t v) {
    const CoverLayer& part = *pair_.parts_[1 - role];
    const Void& hole = part.voids[v];
    const Chord& chord = views_.chord[role];
    const bool how_deep = asked_ == Asked::kHowDeep;
    double most = -kInfinity;
    std::vector<Vec3> places_S;
    for (const HalfSpace& plane : hole.planes) {
      ++work_;
      const double beyond = beyond_plane_mm(s(role), chord, plane);
      if (beyond >= least_ || (!how_deep && beyond > limit_mm_)) return false;
      if (beyond <= most) continue;
      most = beyond;
      if (how_deep)
        places_S = {s(role).farthest_middle(-(chord.X_KS[0].q.conjugate() * plane.n), kAsFar_mm)};
    }
    for (const VoidWall& wall : hole.walls) {
      std::vector<Vec3> at_wall;
      const double beyond =
          beyond_wall_mm(s(role), chord, wall, part.heights_of(cells_->cell[1 - role], v),
                         limit_mm_, useless_mm(), work_, how_deep ? &at_wall : nullptr);
      if (beyond > most) {
        most = beyond;
        places_S = std::move(at_wall);
      }
    }
    if (!(most < least_)) return false;
    least_ = most;
    cells_->places_S = std::move(places_S);
    cells_->keeper = {role, true, v, Vec3::Zero()};
    return least_ <= limit_mm_;
  }

  // What is no less changes nothing.
  double useless_mm() const { return asked_ == Asked::kHowDeep ? least_ : limit_mm_; }

  bool take(double bound, int role, const Vec3& n) {
    if (!(bound < least_)) return false;
    least_ = bound;
    cells_->keeper = {role, false, 0, n};
    cells_->places_S.clear();
    return least_ <= limit_mm_;
  }

  // Along the direction in which both cells are farthest apart, or least deep in each other, at
  // both ends of the span: from the best one so far.
  void descend() {
    const Chord& chord = views_.chord[0];
    const auto farthest = [&](const Vec3& n) {
      ++work_;
      Vec3 nearest_S = Vec3::Zero();
      double least = kInfinity;
      for (int e = 0; e < chord.ends; ++e) {
        const Pose& X = chord.X_KS[e];
        const Vec3 x = X * s(0).farthest(-(X.q.conjugate() * n));
        if (n.dot(x) >= least) continue;
        least = n.dot(x);
        nearest_S = x;
      }
      return PointOfEach{k(0).farthest(n), nearest_S};
    };
    double most = kInfinity;
    const auto tried = [&](const Vec3& n, double reach_mm) {
      if (reach_mm >= most) return false;
      most = reach_mm;
      return by_direction(0, n);
    };
    const Vec3 between = chord.X_KS[0] * s(0).middle - k(0).middle;
    const double size_mm = between.norm();
    // Both middles are one point: no direction to begin with.
    if (!(size_mm > 1e-12)) return;
    LeastReach search(farthest, tried, size_mm);
    const bool how_deep = asked_ == Asked::kHowDeep;
    search.run(first_direction(between / size_mm), std::max(kDeep * size_mm, useless_mm()),
               how_deep ? kLittle : kMuch);
    if (!how_deep || cells_->keeper.by_void) return;
    const PointOfEach& touching = search.touching();
    cells_->places_S = {cells_->keeper.role == 0 ? chord.X_KS[0].inverse() * touching.s
                                                 : touching.k};
  }

  Vec3 first_direction(const Vec3& otherwise) const {
    const CoverKeeper& last = cells_->keeper;
    if (last.role < 0 || last.by_void) return otherwise;
    return last.role == 0 ? last.n : Vec3(-(views_.chord[0].X_KS[0].q * last.n));
  }

  const CoverPair& pair_;
  const Views& views_;
  const double limit_mm_;
  const Asked asked_;
  std::uint64_t& work_;
  Cells* cells_ = nullptr;
  double least_ = kInfinity;
};

// Does what bounds one pair of cells bound the depth in both parts, with all of their cells? The
// proof is in the README, section 11.
class CoverPair::Whole {
 public:
  Whole(const CoverPair& pair, const Views& views, double most_mm, double least_mm,
        std::uint64_t& work)
      : pair_(pair), views_(views), most_mm_(most_mm), least_mm_(least_mm), work_(work) {}

  bool operator()(const CoverKeeper& deciding) {
    role_ = deciding.role;
    return deciding.by_void ? of_void(deciding.v) : of_direction(deciding.n);
  }

 private:
  const std::vector<ConvexCell>& s() const { return pair_.parts_[role_]->cells; }
  const CoverLayer& k() const { return *pair_.parts_[1 - role_]; }

  // How far any cell of S comes beyond the border.
  double beyond_mm(const HalfSpace& material) {
    double most = -kInfinity;
    for (const ConvexCell& cell : s()) {
      ++work_;
      most = std::max(most, beyond_plane_mm(cell, views_.chord[role_], material));
    }
    return most;
  }
  // What stands on an end of the material only touches it.
  double beyond_wall(std::size_t v, const VoidWall& wall) {
    double most = -kInfinity;
    for (std::size_t j = 0; j < k().cells.size(); ++j) {
      const Interval& along = k().heights_of(j, v);
      if (j > 0 && along.lo == k().heights_of(j - 1, v).lo &&
          along.hi == k().heights_of(j - 1, v).hi)
        continue;  // cells of a prism have the same heights
      const Interval inner{along.lo + least_mm_, along.hi - least_mm_};
      for (const ConvexCell& cell : s())
        most = std::max(most, beyond_wall_mm(cell, views_.chord[role_], wall, inner, most_mm_,
                                             most_mm_, work_, nullptr));
    }
    return most;
  }

  // All of S is above a plane that all of K is below.
  bool of_direction(const Vec3& n) {
    double c_mm = -kInfinity;
    for (const ConvexCell& cell : k().cells) c_mm = std::max(c_mm, cell.support_mm(n));
    return beyond_mm({n, c_mm}) <= most_mm_;
  }

  // Whoever is beyond a wall leaves through it, and meets no other one on the way.
  bool of_void(std::size_t v) {
    const Void& hole = k().voids[v];
    std::vector<double> wall_mm;
    for (const VoidWall& wall : hole.walls) {
      wall_mm.push_back(beyond_wall(v, wall));
      if (wall_mm.back() > most_mm_) return false;
    }
    std::vector<double> plane_mm;
    for (const HalfSpace& plane : hole.planes) {
      plane_mm.push_back(beyond_mm(plane));
      if (plane_mm.back() > most_mm_) return false;
    }
    for (std::size_t a = 0; a < hole.planes.size(); ++a) {
      const Vec3& n = hole.planes[a].n;
      for (std::size_t w = 0; w < hole.walls.size(); ++w) {
        const VoidWall& wall = hole.walls[w];
        const double along = n.dot(wall.axis);
        const double across = wall.is_socket ? 1.0 : (n - along * wall.axis).norm();
        if (!stays(plane_mm[a], wall_mm[w], across + std::fabs(wall.slope * along)) ||
            !stays(wall_mm[w], plane_mm[a], across))
          return false;
      }
      for (std::size_t b = 0; b < hole.planes.size(); ++b) {
        const double opposite = -n.dot(hole.planes[b].n);
        if (b != a && opposite < kOpposite && !stays(plane_mm[a], plane_mm[b], opposite))
          return false;
      }
    }
    for (std::size_t a = 0; a < hole.walls.size(); ++a)
      for (std::size_t b = 0; b < hole.walls.size(); ++b)
        if (b != a && !stays(wall_mm[a], wall_mm[b], 1.0)) return false;
    return true;
  }

  // Who leaves through a face that it is beyond by some depth goes that share of it towards another
  // face: is it still beside that one?
  bool stays(double through_mm, double other_mm, double share) const {
    if (through_mm <= least_mm_) return true;
    if (share < kAcross) return other_mm <= least_mm_;
    return other_mm + through_mm * share <= 0.0;
  }

  const CoverPair& pair_;
  const Views& views_;
  const double most_mm_, least_mm_;
  std::uint64_t& work_;
  int role_ = 0;
};

CoverPair::Views CoverPair::views_of(const PairPath& path, const Span& span) {
  Views views;
  for (int role = 0; role < 2; ++role) {
    views.chord[role].ends = 2;
    views.chord[role].spread_mm = path.spread(role, span);
  }
  for (int e = 0; e < 2; ++e) {
    views.chord[0].X_KS[e] = path.pose(0, e == 0 ? span.t0 : span.t1);
    views.chord[1].X_KS[e] = views.chord[0].X_KS[e].inverse();
  }
  return views;
}

template <class Visit>
bool CoverPair::each_pair(Visit&& visit) const {
  for (std::size_t i = 0; i < parts_[0]->cells.size(); ++i)
    for (std::size_t j = 0; j < parts_[1]->cells.size(); ++j) {
      Cells cells{.cell = {i, j}, .keeper = {}, .places_S = {}, .apart_along = {}};
      if (!visit(cells)) return false;
    }
  return true;
}

std::optional<Vec3> CoverPair::apart_along(const Cells& cells, const Pose& X_BA, const Vec3& first,
                                           std::uint64_t& work) const {
  const ConvexCell& s = parts_[0]->cells[cells.cell[0]];
  const ConvexCell& k = parts_[1]->cells[cells.cell[1]];
  std::optional<Vec3> along;
  const auto farthest = [&](const Vec3& n) {
    ++work;
    return PointOfEach{k.farthest(n), X_BA * s.farthest(-(X_BA.q.conjugate() * n))};
  };
  const auto tried = [&](const Vec3& n, double reach_mm) {
    if (reach_mm < 0.0) along = n;
    return false;
  };
  LeastReach(farthest, tried, (X_BA * s.middle - k.middle).norm()).run(first, -kInfinity, 0.0);
  return along;
}

bool CoverPair::turn_apart(const Views& views, Cells& cells, double limit_mm,
                           std::uint64_t& work) const {
  const CoverKeeper& keeper = cells.keeper;
  if (keeper.role < 0 || keeper.by_void) return false;
  const Chord& chord = views.chord[0];
  for (int e = 0; e < 2; ++e) {
    std::optional<Vec3>& along = cells.apart_along[e];
    if (along) continue;
    const Pose& X = chord.X_KS[e];
    along = apart_along(cells, X, keeper.role == 0 ? keeper.n : Vec3(-(X.q * keeper.n)), work);
    if (!along) return false;
  }
  const Vec3 n[2] = {*cells.apart_along[0], *cells.apart_along[1]};
  work += 3;
  return beyond_turning_mm(parts_[0]->cells[cells.cell[0]], parts_[1]->cells[cells.cell[1]], chord,
                           n) <= limit_mm;
}

// What keeps two cells apart where a span begins does so all over it, or else over a part of it:
// the span is halved. Anything else is looked for where that is not so, over long spans, and over
// the shortest ones before they are taken for the end.
CoverFree CoverPair::free_until(const PairPath& path, double limit_mm, double accuracy_mm) const {
  MORTISE_CHECK(limit_mm >= 0.0 && accuracy_mm >= 0.0, "a limit must be a length");
  CoverFree free;
  const Views at_begin = views_at(path.pose(0, 0.0));
  Bound bound_at_begin(*this, at_begin, limit_mm, Bound::Asked::kWhether, free.work);
  std::vector<Cells> all;
  const bool begins_apart = each_pair([&](Cells& cells) {
    if (!(bound_at_begin(cells) <= limit_mm)) return false;
    all.push_back(std::move(cells));
    return true;
  });
  if (!begins_apart) {
    free.t_free = 0.0;
    return free;
  }
  const double moment = accuracy_mm / std::max(path.speed_upper_bound(), 1e-300);
  // Spans still to be looked at, the earliest last, each with the cells that nothing keeps apart
  // over a longer one.
  struct Open {
    Span span;
    std::vector<Cells> cells;
  };
  std::vector<Open> open;
  open.push_back({{0.0, 1.0}, std::move(all)});
  for (int i = 0; !open.empty(); ++i) {
    Open now = std::move(open.back());
    open.pop_back();
    const Views views = views_of(path, now.span);
    const Views at_start = views_at(views.chord[0].X_KS[0]);
    const double length = now.span.t1 - now.span.t0;
    const bool looks_for_others = length > kLongSpan || length <= moment;
    Bound bound(*this, views, limit_mm, Bound::Asked::kWhether, free.work);
    Bound bound_at_start(*this, at_start, limit_mm, Bound::Asked::kWhether, free.work);
    std::erase_if(now.cells, [&](Cells& cells) {
      if (bound.by_what_it_was(cells)) return true;
      if (!looks_for_others && bound_at_start.by_what_it_was(cells))
        return turn_apart(views, cells, limit_mm, free.work);
      return bound(cells) <= limit_mm;
    });
    if (now.cells.empty()) continue;
    const double middle = 0.5 * (now.span.t0 + now.span.t1);
    if (i >= kMostSpans || length <= moment || !(middle > now.span.t0) || !(middle < now.span.t1)) {
      free.t_free = now.span.t0;
      MORTISE_CHECK(0.0 <= free.t_free && free.t_free <= 1.0, "a time is one of the tick");
      return free;
    }
    open.push_back({{middle, now.span.t1}, now.cells});
    for (Cells& cells : open.back().cells) cells.apart_along[0].reset();
    for (Cells& cells : now.cells) cells.apart_along[1].reset();
    open.push_back({{now.span.t0, middle}, std::move(now.cells)});
  }
  free.all = true;
  return free;
}

CoverPair::Views CoverPair::views_at(const Pose& X_BA) {
  Views views;
  views.chord[0].X_KS[0] = X_BA;
  views.chord[1].X_KS[0] = X_BA.inverse();
  return views;
}

bool CoverPair::apart(const Pose& X_BA, double limit_mm, std::uint64_t& work) const {
  const Views views = views_at(X_BA);
  Bound bound(*this, views, limit_mm, Bound::Asked::kWhether, work);
  return each_pair([&](Cells& cells) { return bound(cells) <= limit_mm; });
}

CoverOverlap CoverPair::overlap(const Pose& X_BA, double least_mm, std::uint64_t& work) const {
  MORTISE_CHECK(valid(X_BA), "a pose must be finite and its quaternion unit");
  MORTISE_CHECK(!std::isnan(least_mm), "what counts as least is a number");
  const Views views = views_at(X_BA);
  CoverOverlap overlap;
  overlap.most_mm = least_mm;
  Cells deciding;
  each_pair([&](Cells& cells) {
    const double bound = Bound(*this, views, overlap.most_mm, Bound::Asked::kHowDeep, work)(cells);
    if (!(bound > overlap.most_mm)) return true;
    overlap.most_mm = bound;
    deciding = std::move(cells);
    return true;
  });
  if (deciding.keeper.role < 0) return overlap;
  overlap.keeper = deciding.keeper;
  MORTISE_CHECK(overlap.keeper.by_void
                    ? overlap.keeper.v < parts_[1 - overlap.keeper.role]->voids.size()
                    : is_unit(overlap.keeper.n),
                "what keeps two cells apart is a void of a part or a unit direction");
  overlap.places_S = places_of(deciding, views);
  return overlap;
}

bool CoverPair::bounds_depth(const CoverOverlap& overlap, const Pose& X_BA, double least_mm,
                             std::uint64_t& work) const {
  if (overlap.keeper.role < 0) return false;
  return Whole(*this, views_at(X_BA), overlap.most_mm, least_mm, work)(overlap.keeper);
}

// By a direction: between both cells, then as far as S goes along it. Around the middle of a disc
// as well, since a shaft may come out of it; and where both cells touch.
std::vector<Vec3> CoverPair::places_of(const Cells& cells, const Views& views) const {
  if (cells.keeper.by_void && !cells.places_S.empty()) return cells.places_S;
  const int role = cells.keeper.role;
  const Pose& X_KS = views.chord[role].X_KS[0];
  const ConvexCell& s = parts_[role]->cells[cells.cell[role]];
  const ConvexCell& k = parts_[1 - role]->cells[cells.cell[1 - role]];
  const Pose X_SK = X_KS.inverse();
  const Vec3 n_S = -(X_KS.q.conjugate() * cells.keeper.n);
  std::vector<Vec3> places;
  const auto add = [&](Vec3 x_S) {
    for (int i = 0; i < kProjections; ++i) x_S = s.near(X_SK * k.near(X_KS * x_S));
    places.push_back(x_S);
  };
  const Vec3 middle = s.farthest_middle(n_S, kAsFar_mm);
  add(middle);
  for (const Vec3& x_S : s.around_farthest(n_S, kAsFar_mm)) {
    const Vec3 inner = x_S + kFromRim * (middle - x_S);
    add(inner);
  }
  places.insert(places.end(), cells.places_S.begin(), cells.places_S.end());
  return places;
}

}  // namespace mortise
