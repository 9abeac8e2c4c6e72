#include "common/depth/cells/cover_bound.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mortise {
namespace {

// Sectors looked at before what is known so far has to do; each halving quarters their error.
constexpr int kMostSectors = 200;
// A place is so many times as far inside of an end of material as it is deep.
constexpr double kInner = 1.05;
// Another place is so far off a rim.
constexpr double kOffRim_mm = 0.1;
// Places on a circle.
constexpr int kAround = 16;
// Beside an axis as parallel as this the bound of a whole circle is taken for exact, mm.
constexpr double kParallelToWall_mm = 1e-9;

double beyond(const VoidWall& wall, const Vec3& x) {
  const Vec3 d = x - wall.point;
  if (wall.is_socket) return d.norm() - wall.r_mm;
  const double z = d.dot(wall.axis);
  return wall.cosine * (wall.arc.most(d - z * wall.axis) - wall.r_mm - wall.slope * z);
}

// A round cell beside a wall. Directions off its axis are u = c across[0] + s across[1]; what is
// linear in u is largest at an end of a sector, or where it is largest at all.
class RoundInWall {
 public:
  RoundInWall(const ConvexCell& s, const Chord& chord, const VoidWall& wall, const Interval& along,
              std::uint64_t& work)
      : s_(s), chord_(chord), wall_(wall), along_(along), work_(work) {
    for (int e = 0; e < chord.ends; ++e) {
      point_[e] = chord.X_KS[e] * s.point;
      axis_[e] = chord.X_KS[e].q * s.axis;
      for (int k = 0; k < 2; ++k) across_[e][k] = chord.X_KS[e].q * s.across[k];
      rises_[e] = {across_[e][0].dot(wall.axis), across_[e][1].dot(wall.axis)};
      rise_[e] = std::hypot(rises_[e].c, rises_[e].s);
      for (const auto& circle : s.circles)
        too_far_mm_ =
            std::max(too_far_mm_, circle.r_mm * rise_[e] * (rise_[e] + std::fabs(wall.slope)));
    }
  }

  double run(double limit_mm, double useless_mm) {
    const double whole = whole_circle();
    if (whole <= limit_mm || whole == -kInfinity) return whole;
    // Of a path only the number is asked, and beside a parallel axis that is exact.
    if (chord_.ends == 2 && too_far_mm_ <= kParallelToWall_mm && s_.arc.whole) return whole;
    see_away_from_axis();
    const auto is_useless = [&] { return best_ - chord_.spread_mm > useless_mm; };
    const auto is_narrow = [&](double most) {
      return most <= best_ + chord_.spread_mm + kBoundAccuracy_mm;
    };
    if (is_useless()) return kInfinity;
    if (is_narrow(whole)) return whole;
    if (s_.arc.whole)
      for (int i = 0; i < 4; ++i) add(kQuarters[i], kQuarters[(i + 1) % 4], whole);
    else
      add_arc(whole);
    while (!heap_.empty() && work_here_ < kMostSectors) {
      const double most = heap_.front().hi;
      if (most <= limit_mm || is_narrow(most)) break;
      if (is_useless()) return kInfinity;
      std::pop_heap(heap_.begin(), heap_.end());
      const Sector sector = heap_.back();
      heap_.pop_back();
      const Direction middle = between(sector.from, sector.to);
      add(sector.from, middle, sector.hi);
      add(middle, sector.to, sector.hi);
    }
    return heap_.empty() ? -kInfinity : heap_.front().hi;
  }

  /// The point of S that came farthest, of those seen, and others on its circle, as deep as they
  /// are: the wall may be missing in a place.
  std::vector<Vec3> places() const {
    if (place_.far == -kInfinity) return {};
    std::vector<std::pair<double, Vec3>> around;
    const auto take = [&](double z, double r, const Direction& u, bool always) {
      const Vec3 x_S = s_.point + z * s_.axis + r * (u.c * s_.across[0] + u.s * s_.across[1]);
      const double far = beyond(wall_, chord_.X_KS[0] * x_S);
      if (always || far > 0.0) around.emplace_back(far, x_S);
    };
    take(place_.z_mm, place_.r_mm, place_.u, true);
    take(place_.end_z_mm, radius(place_.segment, place_.end_z_mm), place_.u, true);
    // Where a mesh has its rim it is off the surface by its chords.
    const double off_rim =
        std::clamp(0.5 * (place_.to_z_mm - place_.z_mm), -kOffRim_mm, kOffRim_mm);
    take(place_.z_mm + off_rim, radius(place_.segment, place_.z_mm + off_rim), place_.u, false);
    Direction u = place_.u;
    for (int i = 1; i < kAround; ++i) {
      u = {u.c * kTurn.c - u.s * kTurn.s, u.c * kTurn.s + u.s * kTurn.c};
      take(place_.z_mm, place_.r_mm, u, false);
    }
    std::stable_sort(around.begin() + 2, around.end(),
                     [](const auto& x, const auto& y) { return x.first > y.first; });
    std::vector<Vec3> places;
    for (const auto& [far, x_S] : around) places.push_back(x_S);
    return places;
  }

 private:
  struct Direction {
    double c, s;
  };
  struct Sector {
    Direction from, to;
    double hi;
    bool operator<(const Sector& other) const { return hi < other.hi; }
  };
  struct Rises {
    std::array<double, 2> least, most;  // by end of the chord
  };
  static constexpr Direction kTurn{0.9238795325112867, 0.3826834323650898};  // by 1 / kAround
  static constexpr Direction kQuarters[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};

  static Direction between(const Direction& a, const Direction& b) {
    const double c = a.c + b.c, s = a.s + b.s, length = std::sqrt(c * c + s * s);
    return {c / length, s / length};
  }

  // Of the generator between two circles: where some point of it, with a rise among those given,
  // may be between the heights of the wall at some time of the span. False: nowhere.
  bool clip(std::size_t segment, const Rises& rises, double& from, double& to) const {
    if (s_.bulges(segment)) return false;  // zones_in_wall() asks it
    const auto &p = s_.circles[segment], &q = s_.circles[segment + 1];
    const double slope = (q.r_mm - p.r_mm) / (q.z_mm - p.z_mm);
    from = kInfinity;
    to = -kInfinity;
    for (int i = 0; i < chord_.ends; ++i)
      for (int j = 0; j < chord_.ends; ++j) {
        double lo = p.z_mm, hi = q.z_mm;
        // height = at + by * z <= most, or the same with all signs turned
        const auto keep = [&](int e, double rise, double most, double sign) {
          const double at =
              sign * ((point_[e] - wall_.point).dot(wall_.axis) + rise * (p.r_mm - slope * p.z_mm));
          const double by = sign * (axis_[e].dot(wall_.axis) + rise * slope);
          const double left = most - at;
          // Square to the wall's axis within rounding: all of it is at one height, and out only
          // where it is a picometre out.
          if (std::fabs(by) < 1e-12) {
            if (left < -1e-9 - 1e-12 * (std::fabs(p.z_mm) + std::fabs(q.z_mm))) lo = kInfinity;
          } else if (by > 0.0) {
            hi = std::min(hi, left / by);
          } else {
            lo = std::max(lo, left / by);
          }
        };
        if (along_.hi < kInfinity) keep(i, rises.least[i], along_.hi + chord_.spread_mm, 1.0);
        if (along_.lo > -kInfinity) keep(j, rises.most[j], -(along_.lo - chord_.spread_mm), -1.0);
        if (lo > hi) continue;
        from = std::min(from, lo);
        to = std::max(to, hi);
      }
    return from <= to;
  }

  double radius(std::size_t segment, double z) const {
    const auto &p = s_.circles[segment], &q = s_.circles[segment + 1];
    return p.r_mm + (q.r_mm - p.r_mm) * (z - p.z_mm) / (q.z_mm - p.z_mm);
  }

  // Both ends of each segment that may be between the heights of the wall, at each end of the
  // chord: visit(segment, end of the chord, z).
  template <class Visit>
  void for_each_circle(Visit&& visit) const {
    const Rises all{{-rise_[0], -rise_[1]}, {rise_[0], rise_[1]}};
    for (std::size_t k = 0; k + 1 < s_.circles.size(); ++k) {
      double from, to;
      if (!clip(k, all, from, to)) continue;
      for (int e = 0; e < chord_.ends; ++e)
        for (const double z : {from, to}) visit(k, e, z);
    }
  }

  // All around at once: the centre of the circle, and its radius.
  double whole_circle() {
    ++work_;
    double most = -kInfinity;
    for_each_circle([&](std::size_t k, int e, double z) {
      const double r = radius(k, z);
      most = std::max(most, beyond(wall_, point_[e] + z * axis_[e]) +
                                wall_.cosine * r * (1.0 + std::fabs(wall_.slope) * rise_[e]));
    });
    return most + chord_.spread_mm;
  }

  // Of each circle the point on the side to which its middle is off the axis of the wall: the
  // farthest one where the axes are parallel, and about that where they are nearly so.
  void see_away_from_axis() {
    ++work_;
    for_each_circle([&](std::size_t k, int e, double z) {
      Vec3 off = point_[e] + z * axis_[e] - wall_.point;
      off -= off.dot(wall_.axis) * wall_.axis;
      const double c = off.dot(across_[e][0]), s = off.dot(across_[e][1]);
      const double length = std::sqrt(c * c + s * s);
      if (s_.arc.whole)
        see(k, length > 0.0 ? Direction{c / length, s / length} : kQuarters[0]);
      else
        see(k, direction(s_.arc.farthest(c * s_.across[0] + s * s_.across[1], s_.arc.middle)));
    });
  }

  Direction direction(const Vec3& u_S) const {
    return {u_S.dot(s_.across[0]), u_S.dot(s_.across[1])};
  }

  void add_arc(double known) {
    const Direction from = direction(s_.arc.from), middle = direction(s_.arc.middle),
                    to = direction(s_.arc.to), first = between(from, middle),
                    second = between(middle, to);
    add(from, first, known);
    add(first, middle, known);
    add(middle, second, known);
    add(second, to, known);
  }

  // The points of one generator at both heights of the wall.
  void see(std::size_t segment, const Direction& d) {
    std::array<Vec3, 2> u;
    Rises rises{};
    for (int e = 0; e < chord_.ends; ++e) {
      u[e] = d.c * across_[e][0] + d.s * across_[e][1];
      rises.least[e] = rises.most[e] = u[e].dot(wall_.axis);
    }
    double a, b;
    if (!clip(segment, rises, a, b)) return;
    for (int e = 0; e < chord_.ends; ++e)
      for (const double z : {a, b}) {
        const double at = beyond(wall_, point_[e] + z * axis_[e] + radius(segment, z) * u[e]);
        best_ = std::max(best_, at);
        if (chord_.ends == 1 && at > place_.far) note(segment, z, z == a ? b : a, at, d);
      }
  }

  // The largest of g · u over a sector of at most half a turn.
  static double most_over(const Direction& from, const Direction& to, const Direction& g) {
    if (from.c * g.s - from.s * g.c >= 0.0 && g.c * to.s - g.s * to.c >= 0.0)
      return std::sqrt(g.c * g.c + g.s * g.s);
    return std::max(from.c * g.c + from.s * g.s, to.c * g.c + to.s * g.s);
  }

  // A point r u of a circle at z has a rise h = u · axis of the wall. With c the way from that axis
  // to the middle of the circle it is, off the axis, |c + r u|² = c² + 2 r c · u + r² (1 - h²).
  double most_of_circle(int e, double z, double r, const Direction& from, const Direction& to,
                        const Interval& rises) const {
    const Vec3 d = point_[e] + z * axis_[e] - wall_.point;
    const double height = d.dot(wall_.axis);
    const Vec3 off = d - height * wall_.axis;
    const double aside = most_over(from, to, {off.dot(across_[e][0]), off.dot(across_[e][1])});
    const double least_rise = std::max({0.0, rises.lo, -rises.hi});
    const double square =
        off.squaredNorm() + 2.0 * r * aside + r * r * (1.0 - least_rise * least_rise);
    const double rise = wall_.slope > 0.0 ? rises.lo : rises.hi;
    const double most = wall_.cosine * (std::sqrt(std::max(0.0, square)) - wall_.r_mm -
                                        wall_.slope * (height + r * rise));
    return wall_.arc.whole ? most : std::min(most, most_of_triangle(e, z, r, from, to));
  }

  // A sector is in the triangle of its ends and the place where its tangents meet.
  double most_of_triangle(int e, double z, double r, const Direction& from,
                          const Direction& to) const {
    const Vec3 x = point_[e] + z * axis_[e];
    const auto at = [&](const Direction& u, double length) {
      return beyond(wall_, x + length * (u.c * across_[e][0] + u.s * across_[e][1]));
    };
    const Direction middle = between(from, to);
    const double half = middle.c * from.c + middle.s * from.s;
    return std::max({at(from, r), at(to, r), at(middle, r / half)});
  }

  void add(const Direction& from, const Direction& to, double known) {
    ++work_;
    ++work_here_;
    Rises rises{};
    for (int e = 0; e < chord_.ends; ++e) {
      rises.least[e] = -most_over(from, to, {-rises_[e].c, -rises_[e].s});
      rises.most[e] = most_over(from, to, rises_[e]);
    }
    const Direction middle = between(from, to);
    double most = -kInfinity;
    for (std::size_t k = 0; k + 1 < s_.circles.size(); ++k) {
      double a, b;
      if (!clip(k, rises, a, b)) continue;
      for (int e = 0; e < chord_.ends; ++e)
        for (const double z : {a, b})
          most = std::max(
              most, most_of_circle(e, z, radius(k, z), from, to, {rises.least[e], rises.most[e]}));
      see(k, middle);
    }
    if (most == -kInfinity) return;
    heap_.push_back({from, to, std::min(known, most + chord_.spread_mm)});
    std::push_heap(heap_.begin(), heap_.end());
  }

  // At the end of the material nothing is deep: as far inside of it as that matters.
  void note(std::size_t segment, double z, double to_z, double at, const Direction& u) {
    const double inner =
        z + std::clamp(0.5 * (to_z - z), -kInner * std::max(0.0, at), kInner * std::max(0.0, at));
    const double r = radius(segment, inner);
    const Vec3 x_S = s_.point + inner * s_.axis + r * (u.c * s_.across[0] + u.s * s_.across[1]);
    const double far = beyond(wall_, chord_.X_KS[0] * x_S);
    if (far > place_.far) place_ = {far, segment, inner, z, to_z, r, u};
  }

  struct Place {
    double far = -kInfinity;
    std::size_t segment = 0;
    double z_mm = 0.0, end_z_mm = 0.0, to_z_mm = 0.0, r_mm = 0.0;
    Direction u{1.0, 0.0};
  };

  const ConvexCell& s_;
  const Chord& chord_;
  const VoidWall& wall_;
  const Interval along_;
  std::uint64_t& work_;
  Vec3 point_[2], axis_[2], across_[2][2];
  Direction rises_[2];           // of both directions across
  double rise_[2] = {0.0, 0.0};  // the most of any
  double too_far_mm_ = 0.0;      // what whole_circle() may say too much
  int work_here_ = 0;
  double best_ = -kInfinity;  // of points seen, at an end of the chord
  Place place_;
  std::vector<Sector> heap_;
};

// f is convex, so it is largest at corners of what is between the heights: corners of the cell, and
// where its edges pass a height. Heights are those at an end of the chord, widened by how much any
// height changes.
double polytope_in_wall(const ConvexCell& s, const Chord& chord, const VoidWall& wall,
                        const Interval& along, std::uint64_t& work, std::vector<Vec3>* places) {
  ++work;
  const std::size_t count = s.corners.size();
  std::vector<Vec3> x(count * static_cast<std::size_t>(chord.ends));
  std::vector<double> z(x.size());
  double change = 0.0;
  for (std::size_t c = 0; c < count; ++c) {
    for (int e = 0; e < chord.ends; ++e) {
      const std::size_t i = e * count + c;
      x[i] = chord.X_KS[e] * s.corners[c];
      z[i] = (x[i] - wall.point).dot(wall.axis);
    }
    if (chord.ends == 2) change = std::max(change, std::fabs(z[count + c] - z[c]));
  }
  change += chord.spread_mm;
  const double lo = along.lo - change, hi = along.hi + change;
  double most = -kInfinity;
  const auto take = [&](double far, const Vec3& x_S) {
    if (far <= most) return;
    most = far;
    if (places) *places = {x_S};
  };
  for (int e = 0; e < chord.ends; ++e) {
    const std::size_t first = e * count;
    for (std::size_t c = 0; c < count; ++c)
      if (lo <= z[first + c] && z[first + c] <= hi) take(beyond(wall, x[first + c]), s.corners[c]);
    for (const auto& [a, b] : s.edges)
      for (const double level : {lo, hi}) {
        const double za = z[first + a] - level, zb = z[first + b] - level;
        if (!(za * zb < 0.0)) continue;
        const double share = za / (za - zb);
        take(beyond(wall, x[first + a] + share * (x[first + b] - x[first + a])),
             s.corners[a] + share * (s.corners[b] - s.corners[a]));
      }
  }
  return most + chord.spread_mm;
}

// A ball beside a wall. At a height of that the farthest point is as far off its axis as the middle
// is and the circle there reaches; the farthest of all is where the wall's normal points.
struct BallInWall {
  double far = -kInfinity;
  Vec3 at = Vec3::Zero();
};
BallInWall ball_in_wall(const Vec3& middle, double r_mm, const VoidWall& wall,
                        const Interval& along) {
  const Vec3 d = middle - wall.point;
  const double z = d.dot(wall.axis);
  const double lo = std::max(along.lo, z - r_mm), hi = std::min(along.hi, z + r_mm);
  if (!(lo <= hi)) return {};
  const Vec3 off = d - z * wall.axis;
  const double height = std::clamp(z - r_mm * wall.cosine * wall.slope, lo, hi);
  const double circle = std::sqrt(std::max(0.0, (r_mm - (height - z)) * (r_mm + height - z)));
  const double far = wall.cosine * (wall.arc.most(off) + circle - wall.r_mm - wall.slope * height);
  const Vec3 out =
      wall.arc.farthest(off, wall.arc.whole ? Vec3(wall.axis.unitOrthogonal()) : wall.arc.middle);
  return {far, middle + (height - z) * wall.axis + circle * out};
}

// Of the balls of all zones, whole. Heights are wider by as much as any changes.
double zones_in_wall(const ConvexCell& s, const Chord& chord, const VoidWall& wall,
                     const Interval& along, std::uint64_t& work, std::vector<Vec3>& places) {
  double most = -kInfinity;
  for (const ConvexCell::Zone& zone : s.zones) {
    ++work;
    const Vec3 middle_S = s.point + zone.z_mm * s.axis;
    Vec3 middle[2];
    for (int e = 0; e < chord.ends; ++e) middle[e] = chord.X_KS[e] * middle_S;
    double change = chord.spread_mm;
    // Any point of the ball turns with S: its height changes by no more than its way.
    if (chord.ends == 2)
      change += (middle[1] - middle[0]).norm() +
                2.0 * zone.r_mm * (chord.X_KS[0].q.conjugate() * chord.X_KS[1].q).vec().norm();
    for (int e = 0; e < chord.ends; ++e) {
      const BallInWall ball =
          ball_in_wall(middle[e], zone.r_mm, wall, {along.lo - change, along.hi + change});
      if (!(ball.far > most)) continue;
      most = ball.far;
      places = {chord.X_KS[e].inverse() * ball.at};
    }
  }
  return most + chord.spread_mm;
}

// Of a socket: |x - its middle| is convex.
double in_socket(const ConvexCell& s, const Chord& chord, const VoidWall& wall, std::uint64_t& work,
                 std::vector<Vec3>* places) {
  ++work;
  double most = -kInfinity;
  for (int e = 0; e < chord.ends; ++e) {
    Vec3 at = Vec3::Zero();
    const double far = s.farthest_from_mm(chord.X_KS[e].inverse() * wall.point, at);
    if (far <= most) continue;
    most = far;
    if (places) *places = {at};
  }
  return most - wall.r_mm + chord.spread_mm;
}

// A prism with round sides. At one height of it each point is a mean of points of its edges and
// pieces there: those have the same height along the wall but for how much a cut across the prism
// rises along the wall. f is convex.
double prism_in_wall(const ConvexCell& s, const Chord& chord, const VoidWall& wall,
                     const Interval& along, double limit_mm, double useless_mm, std::uint64_t& work,
                     std::vector<Vec3>* places) {
  double rise_mm = 0.0;
  for (int e = 0; e < chord.ends; ++e) {
    const Vec3 axis_S = chord.X_KS[e].q.conjugate() * wall.axis;
    const Vec3 across = axis_S - axis_S.dot(s.axis) * s.axis;
    rise_mm = std::max(rise_mm, s.support_mm(across) + s.support_mm(-across));
  }
  const Interval wider{along.lo - rise_mm, along.hi + rise_mm};
  double most = polytope_in_wall(s, chord, wall, wider, work, places);
  for (const ConvexCell& piece : s.pieces) {
    RoundInWall in_wall(piece, chord, wall, wider, work);
    const double beyond = in_wall.run(limit_mm, useless_mm);
    if (beyond <= most) continue;
    most = beyond;
    if (places) *places = in_wall.places();
  }
  return most;
}

}  // namespace

double beyond_plane_mm(const ConvexCell& s, const Chord& chord, const HalfSpace& material) {
  double least = kInfinity;
  for (int e = 0; e < chord.ends; ++e) {
    const Pose& X = chord.X_KS[e];
    least = std::min(least, material.n.dot(X.p) - s.support_mm(-(X.q.conjugate() * material.n)));
  }
  return material.c_mm - least + chord.spread_mm;
}

// h_K is convex, and n . x of both straight ways is a polynomial of degree two: at no time is its
// sum with h_K larger than the largest of these three (Bernstein).
double beyond_turning_mm(const ConvexCell& s, const ConvexCell& k, const Chord& chord,
                         const Vec3 (&n)[2]) {
  const double least_length = std::sqrt(std::max(0.0, 0.5 * (1.0 + n[0].dot(n[1]))));
  if (!(least_length > 0.0)) return kInfinity;
  // Over all x of S: the largest -(n[i] . X[j] x + n[j] . X[i] x) / 2.
  const auto s_mm = [&](int i, int j) {
    const Pose &Xi = chord.X_KS[i], &Xj = chord.X_KS[j];
    const Vec3 along_S = 0.5 * (Xj.q.conjugate() * n[i] + Xi.q.conjugate() * n[j]);
    return s.support_mm(-along_S) - 0.5 * (n[i].dot(Xj.p) + n[j].dot(Xi.p));
  };
  const double k_mm[2] = {k.support_mm(n[0]), k.support_mm(n[1])};
  const double most = std::max({k_mm[0] + s_mm(0, 0), k_mm[1] + s_mm(1, 1),
                                0.5 * (k_mm[0] + k_mm[1]) + s_mm(0, 1)}) +
                      chord.spread_mm;
  return most > 0.0 ? most / least_length : most;
}

double beyond_wall_mm(const ConvexCell& s, const Chord& chord, const VoidWall& wall,
                      const Interval& along, double limit_mm, double useless_mm,
                      std::uint64_t& work, std::vector<Vec3>* places) {
  if (wall.is_socket) return in_socket(s, chord, wall, work, places);
  if (!(along.lo <= along.hi)) return -kInfinity;
  if (chord.ends == 1) {
    const Vec3 x = chord.X_KS[0] * s.middle;
    const double z = (x - wall.point).dot(wall.axis);
    if (along.lo <= z && z <= along.hi && beyond(wall, x) > useless_mm) return kInfinity;
  }
  double most = -kInfinity;
  if (s.round) {
    std::vector<Vec3> at_zones;
    const double of_zones = zones_in_wall(s, chord, wall, along, work, at_zones);
    RoundInWall in_wall(s, chord, wall, along, work);
    most = in_wall.run(std::max(limit_mm, of_zones), useless_mm);
    if (places) *places = of_zones > most ? std::move(at_zones) : in_wall.places();
    most = std::max(most, of_zones);
  } else if (!s.pieces.empty()) {
    most = prism_in_wall(s, chord, wall, along, limit_mm, useless_mm, work, places);
  } else {
    most = polytope_in_wall(s, chord, wall, along, work, places);
  }
  // A depth is measured at right angles to the wall, the way along one radius is longer.
  return most > 0.0 ? most / wall.cosine : most;
}

}  // namespace mortise
