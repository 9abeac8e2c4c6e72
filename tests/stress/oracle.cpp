#include "tests/stress/oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/ccd/distance.h"
#include "tests/oracle/fcl_model.h"

namespace mortise::stress {
namespace {

constexpr Real kFar = std::numeric_limits<Real>::infinity();

// Below this part of the parts' size FCL is not asked: its triangle distance fails below 1.8e-4.
constexpr double kFclFloor = 1e-3;
constexpr int kFclSteps = 60;

struct Bounds {
  double lo[3] = {1e300, 1e300, 1e300}, hi[3] = {-1e300, -1e300, -1e300};
  void add(const Point& p) {
    const Real x[3] = {p.x, p.y, p.z};
    for (int c = 0; c < 3; ++c) {
      lo[c] = std::min(lo[c], static_cast<double>(x[c]));
      hi[c] = std::max(hi[c], static_cast<double>(x[c]));
    }
  }
  void add(const Bounds& b) {
    for (int c = 0; c < 3; ++c) {
      lo[c] = std::min(lo[c], b.lo[c]);
      hi[c] = std::max(hi[c], b.hi[c]);
    }
  }
  double apart2(const Bounds& b) const {
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
      const double gap = std::max({0.0, b.lo[c] - hi[c], lo[c] - b.hi[c]});
      sum += gap * gap;
    }
    return sum;
  }
};

// How far two triangles are apart along n; not above their distance.
double apart_along(const Vec3& n, const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  double a_lo = 0.0, a_hi = 0.0, b_lo = n.dot(b[0] - a[0]), b_hi = b_lo;
  for (int k = 1; k < 3; ++k) {
    const double x = n.dot(a[k] - a[0]), y = n.dot(b[k] - a[0]);
    a_lo = std::min(a_lo, x);
    a_hi = std::max(a_hi, x);
    b_lo = std::min(b_lo, y);
    b_hi = std::max(b_hi, y);
  }
  return std::max(b_lo - a_hi, a_lo - b_hi);
}

double path_extent(const Motion& motion) {
  return std::max(motion.X_W0.p.norm(), motion.X_W1.p.norm());
}

}  // namespace

struct Oracle::Body {
  const TriangleMesh& mesh;
  std::vector<Point> at;  // corners, where they are now
  std::vector<Bounds> box;
  std::vector<Vec3> normal;                // of the faces, double: for discarding only
  std::vector<std::array<Vec3, 3>> rough;  // corners, double
  Bounds whole;

  explicit Body(const TriangleMesh& m)
      : mesh(m), box(m.triangles.size()), normal(m.triangles.size()), rough(m.triangles.size()) {
    for (const Vec3& p : m.points_mm) at.push_back(point_of(p));
    bound();
  }
  Corners corners(std::uint32_t i) const {
    const auto& t = mesh.triangles[i];
    return {at[t[0]], at[t[1]], at[t[2]]};
  }
  void bound() {
    whole = {};
    for (std::uint32_t i = 0; i < box.size(); ++i) {
      box[i] = {};
      const Corners t = corners(i);
      for (int k = 0; k < 3; ++k) {
        box[i].add(t[k]);
        rough[i][k] = {static_cast<double>(t[k].x), static_cast<double>(t[k].y),
                       static_cast<double>(t[k].z)};
      }
      const Vec3 n = (rough[i][1] - rough[i][0]).cross(rough[i][2] - rough[i][0]);
      normal[i] = n.squaredNorm() > 0.0 ? Vec3(n.normalized()) : Vec3::Zero();
      whole.add(box[i]);
    }
  }
  void place(const Placement& X) {
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = X(point_of(mesh.points_mm[i]));
    bound();
  }
  double radius() const {
    double r = 0.0;
    for (const Vec3& p : mesh.points_mm) r = std::max(r, p.norm());
    return r;
  }
};

struct Oracle::FclPair {
  testing::FclModel a, b;
  double unit_mm;
  static testing::FclModel model(TriangleMesh mesh, double unit_mm, const Vec3& middle) {
    for (Vec3& p : mesh.points_mm) p = (p - middle) / unit_mm;
    return testing::fcl_model(mesh);
  }
};

ContactQuery query_of(const Case& c) {
  ContactQuery q;
  q.a = c.a.get();
  q.b = c.b.get();
  q.motion_a = c.motion_a;
  q.motion_b = c.motion_b;
  q.accuracy_mm = c.accuracy_mm;
  q.separation_mm = c.separation_mm;
  q.check_contained = c.check_contained;
  return q;
}

Oracle::Oracle(const Case& c)
    : case_(c), a_(std::make_unique<Body>(c.a->mesh())), b_(std::make_unique<Body>(c.b->mesh())) {
  const auto fastest = [](const TriangleMesh& mesh, const Motion& motion) -> Real {
    if (motion.kind == PathKind::kStill) return 0;
    const Placement X = placement_of(motion.X_W0);
    const Point center =
        motion.kind == PathKind::kScrew ? point_of(motion.axis_W) : X(point_of(motion.reference_P));
    Real turning = 0;
    for (const Vec3& p : mesh.points_mm)
      turning = std::max(turning, norm(cross(point_of(motion.w_W), X(point_of(p)) - center)));
    return norm(point_of(motion.v_W)) + turning;
  };
  speed_ = (fastest(a_->mesh, c.motion_a) + fastest(b_->mesh, c.motion_b)) * (1 + Real(1e-15));
  double size = 0.0;
  for (const Body* body : {a_.get(), b_.get()})
    for (int k = 0; k < 3; ++k) size = std::max(size, body->whole.hi[k] - body->whole.lo[k]);
  size_ = size;
  const double extent =
      a_->radius() + b_->radius() + path_extent(c.motion_a) + path_extent(c.motion_b);
  rounding_ = 32.0 * 1.1102230246251565e-16 * extent;
  accuracy_ = std::max(c.accuracy_mm, 64.0 * rounding_);
}

Oracle::~Oracle() = default;

Placement Oracle::a_from_b(double t) const {
  return compose(inverse(place_at(case_.motion_b, t)), place_at(case_.motion_a, t));
}

Real Oracle::gap_mm(double t, Real limit_mm) {
  a_->place(a_from_b(t));
  const Real separation = case_.separation_mm;
  // Boxes are double: what their rounding could hide is added to the reach.
  const double slack = 1e-14 * static_cast<double>(size_) + 1e-15 * b_->radius();
  Real best = limit_mm + separation;
  const auto reach2 = [&] {
    const double reach = static_cast<double>(best) + slack;
    return reach * reach;
  };
  bool through = false, nearer = false;
  const auto parted = [&](std::uint32_t i, std::uint32_t j) {
    const double reach = static_cast<double>(best) + slack;
    const Vec3 d = b_->rough[j][0] + b_->rough[j][1] + b_->rough[j][2] - a_->rough[i][0] -
                   a_->rough[i][1] - a_->rough[i][2];
    for (const Vec3& n : {a_->normal[i], b_->normal[j], Vec3(d / (d.norm() + 1e-300))})
      if (apart_along(n, a_->rough[i], b_->rough[j]) > reach) return true;
    return false;
  };
  const auto look = [&](std::uint32_t i, std::uint32_t j) {
    const Corners x = a_->corners(i), y = b_->corners(j);
    const Gap gap = distance_of(x, y);
    if (gap.mm < best) {
      best = gap.mm;
      nearer = true;
      hint_a_ = i;
      hint_b_ = j;
    }
    // What passes through has an edge in the other's face: no distance tells it.
    if (a_->box[i].apart2(b_->box[j]) == 0.0 && passes_through(x, y)) {
      through = true;
      hint_a_ = i;
      hint_b_ = j;
    }
    return through;
  };
  constexpr Real kThrough = -1e-300L;
  if (look(hint_a_, hint_b_)) return kThrough - separation;
  candidates_.clear();
  for (std::uint32_t i = 0; i < a_->box.size(); ++i) {
    if (a_->box[i].apart2(b_->whole) > reach2()) continue;
    for (std::uint32_t j = 0; j < b_->box.size(); ++j) {
      const double apart2 = a_->box[i].apart2(b_->box[j]);
      if (apart2 <= reach2()) candidates_.push_back({apart2, i, j});
    }
  }
  // Nearest boxes first: what they find spares the others.
  std::sort(candidates_.begin(), candidates_.end());
  for (const auto& [apart2, i, j] : candidates_) {
    if (apart2 > reach2()) break;
    if (!parted(i, j) && look(i, j)) return kThrough - separation;
  }
  return nearer ? best - separation : limit_mm;
}

bool Oracle::contained(double t) {
  const Placement X = a_from_b(t), back = inverse(X);
  const auto inside = [](const TriangleMesh& inner, const Placement& to_outer,
                         const TriangleMesh& outer, const std::vector<std::uint32_t>& shells) {
    for (const std::uint32_t i : shells)
      if (winding(to_outer(point_of(inner.corner(i, 0))), outer) > Real(0.5)) return true;
    return false;
  };
  return inside(a_->mesh, X, b_->mesh, case_.a->shells()) ||
         inside(b_->mesh, back, a_->mesh, case_.b->shells());
}

Oracle::Advanced Oracle::advance_by_fcl(double t_end) {
  if (!fcl_)
    fcl_ = std::make_unique<FclPair>(
        FclPair{FclPair::model(a_->mesh, static_cast<double>(size_), case_.a->bounds().center()),
                FclPair::model(b_->mesh, static_cast<double>(size_), case_.b->bounds().center()),
                static_cast<double>(size_)});
  Advanced result;
  for (int step = 0; step < kFclSteps; ++step) {
    const Placement X = a_from_b(result.t);
    const Point middle =
        X(point_of(case_.a->bounds().center())) - point_of(case_.b->bounds().center());
    fcl::Transform3d T = fcl::Transform3d::Identity();
    for (int i = 0; i < 3; ++i)
      T.linear().row(i) << static_cast<double>(X.row[i].x), static_cast<double>(X.row[i].y),
          static_cast<double>(X.row[i].z);
    T.translation() << static_cast<double>(middle.x / size_), static_cast<double>(middle.y / size_),
        static_cast<double>(middle.z / size_);
    fcl::DistanceRequestd request;
    fcl::DistanceResultd found;
    const double units = fcl::distance(fcl_->a.get(), T, fcl_->b.get(),
                                       fcl::Transform3d::Identity(), request, found);
    const Real gap = (units - 1e-9) * size_ - case_.separation_mm;
    if (gap < kFclFloor * size_) return result;
    if (gap >= speed_ * (t_end - result.t)) {
      result.t = t_end;
      result.done = true;
      return result;
    }
    result.t = static_cast<double>(result.t + gap / speed_);
  }
  result.tired = true;
  return result;
}

Oracle::Advanced Oracle::advance(double t, double t_end, Real floor_mm, int most_steps) {
  Advanced result{t, false, false};
  for (int step = 0; step < most_steps; ++step) {
    const Real rest = speed_ * (t_end - result.t);
    const Real gap = gap_mm(result.t, std::max(rest, floor_mm));
    if (gap >= rest && gap > 0) {
      result.t = t_end;
      result.done = true;
      return result;
    }
    if (gap <= floor_mm) return result;
    result.t = static_cast<double>(result.t + gap / speed_);
  }
  result.tired = true;
  return result;
}

double Oracle::first_seen(double t_end, int looks) {
  std::vector<double> times;
  for (int k = 0; k <= looks; ++k) times.push_back(t_end * k / looks);
  if (t_end < 1.0)
    for (double back = t_end / looks; back > 1e-13 * t_end; back *= 0.25)
      times.push_back(t_end - back);
  std::sort(times.begin(), times.end());
  double before = 0.0;
  for (const double t : times) {
    if (gap_mm(t, Real(0) + 1e-300L) > 0) {
      before = t;
      continue;
    }
    double after = t;
    for (int k = 0; k < 80 && std::nextafter(before, after) < after; ++k) {
      const double middle = 0.5 * (before + after);
      (gap_mm(middle, 1e-300L) > 0 ? before : after) = middle;
    }
    return after;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace mortise::stress
