#include "common/depth/cells/cover_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise {
namespace {

// Steps towards the direction in which two cells are farthest apart.
constexpr int kSteps = 24;
// Spans that are looked at before what is proven so far has to do.
constexpr int kMostSpans = 400;
// Onto each of two cells, to find a point of both.
constexpr int kProjections = 6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

// The least bound of one pair of cells; looks no further once it is not above the limit.
class CoverPair::Bound {
 public:
  Bound(const CoverPair& pair, const Views& views, double limit_mm, std::uint64_t& work)
      : pair_(pair), views_(views), limit_mm_(limit_mm), work_(work) {}

  double operator()(Cells& cells) {
    cells_ = &cells;
    least_ = kInfinity;
    if (cells.role >= 0 && again()) return least_;
    if (by_direction(0, views_.chord[0].X_KS[0] * s(0).middle - k(0).middle)) return least_;
    for (const int role : {0, 1})
      for (const Vec3& n : k(role).normals)
        if (by_direction(role, n)) return least_;
    for (const int role : {0, 1}) {
      const std::vector<Void>& voids = pair_.parts_[1 - role]->voids;
      for (std::size_t v = 0; v < voids.size(); ++v)
        if (by_void(role, v)) return least_;
    }
    for (const int role : {0, 1})
      if (k(role).round && off_axis(role)) return least_;
    descend();
    return least_;
  }

 private:
  // Role r looks at the cell S of part r from K, a cell of part 1 - r.
  const ConvexCell& s(int role) const { return pair_.parts_[role]->cells[cells_->cell[role]]; }
  const ConvexCell& k(int role) const { return s(1 - role); }

  bool again() {
    return cells_->by_void ? by_void(cells_->role, cells_->v)
                           : by_direction(cells_->role, cells_->n);
  }

  // All of K is below, all of S above, along a direction fixed in K.
  bool by_direction(int role, const Vec3& towards) {
    const double length = towards.norm();
    if (!(length > 1e-12)) return false;
    const Vec3 n = towards / length;
    ++work_;
    return take(beyond_plane_mm(s(role), views_.chord[role], {n, k(role).support_mm(n)}), role, n);
  }

  bool off_axis(int role) {
    const ConvexCell& cell = k(role);
    const Vec3 d = views_.chord[role].X_KS[0] * s(role).middle - cell.point;
    return by_direction(role, d - d.dot(cell.axis) * cell.axis);
  }

  // What of S is in K is beside the wall of the void, or beyond one of its planes.
  bool by_void(int role, std::size_t v) {
    const CoverLayer& part = *pair_.parts_[1 - role];
    const Void& hole = part.voids[v];
    const Chord& chord = views_.chord[role];
    // Over a span only what excludes is of use, at a pose what is below the best bound so far.
    const double useless_mm = chord.ends == 2 ? limit_mm_ : least_;
    double most = -kInfinity, second = -kInfinity;
    std::optional<Vec3> at_S;
    for (const HalfSpace& plane : hole.planes) {
      ++work_;
      const double beyond = beyond_plane_mm(s(role), chord, plane);
      if (beyond >= least_) return false;
      second = std::max(second, std::min(most, beyond));
      if (beyond <= most) continue;
      most = beyond;
      if (chord.ends == 1) at_S = s(role).farthest(-(chord.X_KS[0].q.conjugate() * plane.n));
    }
    if (hole.wall) {
      std::optional<Vec3> at_wall;
      const double beyond =
          beyond_wall_mm(s(role), chord, *hole.wall, part.heights_of(cells_->cell[1 - role], v),
                         limit_mm_, useless_mm, work_, at_wall);
      second = std::max(second, std::min(most, beyond));
      if (beyond > most) {
        most = beyond;
        at_S = at_wall;
      }
    }
    if (!(most < least_)) return false;
    least_ = most;
    cells_->at_S = at_S;
    // The way out through the nearest wall does not meet another one.
    cells_->by_one_face = second <= -std::fabs(most);
    cells_->role = role;
    cells_->by_void = true;
    cells_->v = v;
    return least_ <= limit_mm_;
  }

  bool take(double bound, int role, const Vec3& n) {
    if (!(bound < least_)) return false;
    least_ = bound;
    cells_->role = role;
    cells_->by_void = false;
    cells_->by_one_face = true;
    cells_->n = n;
    cells_->at_S.reset();
    return least_ <= limit_mm_;
  }

  // Frank and Wolfe on the difference of both cells: towards its point nearest to the origin.
  void descend() {
    const Pose& X = views_.chord[0].X_KS[0];
    Vec3 z = X * s(0).middle - k(0).middle;
    for (int i = 0; i < kSteps; ++i) {
      const double length = z.norm();
      if (!(length > 1e-12)) return;
      const Vec3 n = z / length;
      const Vec3 y = X * s(0).farthest(-(X.q.conjugate() * n)) - k(0).farthest(n);
      if (y.dot(n) > 0.0 && by_direction(0, n)) return;
      const Vec3 step = y - z;
      const double square = step.squaredNorm();
      if (!(square > 1e-24)) return;
      const double share = std::clamp(-z.dot(step) / square, 0.0, 1.0);
      if (!(share > 0.0)) return;
      z += share * step;
    }
  }

  const CoverPair& pair_;
  const Views& views_;
  const double limit_mm_;
  std::uint64_t& work_;
  Cells* cells_ = nullptr;
  double least_ = kInfinity;
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

std::vector<CoverPair::Cells> CoverPair::all_cells() const {
  std::vector<Cells> all;
  for (std::size_t i = 0; i < parts_[0]->cells.size(); ++i)
    for (std::size_t j = 0; j < parts_[1]->cells.size(); ++j) {
      Cells& cells = all.emplace_back();
      cells.cell[0] = i;
      cells.cell[1] = j;
    }
  return all;
}

CoverFree CoverPair::free_until(const PairPath& path, double limit_mm, double accuracy_mm) const {
  CoverFree free;
  if (overlap(path.pose(0, 0.0), limit_mm, free.work).most_mm > limit_mm) {
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
  std::vector<Open> open{{{0.0, 1.0}, all_cells()}};
  for (int i = 0; !open.empty(); ++i) {
    Open now = std::move(open.back());
    open.pop_back();
    const Views views = views_of(path, now.span);
    Bound bound(*this, views, limit_mm, free.work);
    std::erase_if(now.cells, [&](Cells& cells) { return bound(cells) <= limit_mm; });
    if (now.cells.empty()) continue;
    const double middle = 0.5 * (now.span.t0 + now.span.t1);
    if (i >= kMostSpans || now.span.t1 - now.span.t0 <= moment || !(middle > now.span.t0) ||
        !(middle < now.span.t1)) {
      free.t_free = now.span.t0;
      return free;
    }
    open.push_back({{middle, now.span.t1}, now.cells});
    open.push_back({{now.span.t0, middle}, std::move(now.cells)});
  }
  free.all = true;
  return free;
}

CoverOverlap CoverPair::overlap(const Pose& X_BA, double least_mm, std::uint64_t& work) const {
  Views views;
  views.chord[0].X_KS[0] = X_BA;
  views.chord[1].X_KS[0] = X_BA.inverse();
  CoverOverlap overlap;
  overlap.most_mm = least_mm;
  for (Cells& cells : all_cells()) {
    const double bound = Bound(*this, views, overlap.most_mm, work)(cells);
    if (!(bound > overlap.most_mm)) continue;
    overlap.most_mm = bound;
    overlap.is_depth =
        parts_[0]->cells.size() == 1 && parts_[1]->cells.size() == 1 && cells.by_one_face;
    if (cells.role < 0) continue;
    overlap.role = cells.role;
    overlap.at_S = deepest_of(cells, views);
  }
  return overlap;
}

// By a direction: between both cells, then as far as S goes along it.
Vec3 CoverPair::deepest_of(const Cells& cells, const Views& views) const {
  if (cells.at_S) return *cells.at_S;
  const Pose& X_KS = views.chord[cells.role].X_KS[0];
  const ConvexCell& s = parts_[cells.role]->cells[cells.cell[cells.role]];
  const ConvexCell& k = parts_[1 - cells.role]->cells[cells.cell[1 - cells.role]];
  Vec3 x_S = s.farthest(-(X_KS.q.conjugate() * cells.n));
  const Pose X_SK = X_KS.inverse();
  for (int i = 0; i < kProjections; ++i) x_S = s.near(X_SK * k.near(X_KS * x_S));
  return x_S;
}

}  // namespace mortise
