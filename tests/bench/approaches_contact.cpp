// Ways to find a first contact in the words of the paper's introduction, each as a careful reader
// of its source would write it, beside FCL's and ours.
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/bench/approaches.h"
#include "tests/bench/ccd_points.h"
#include "tests/bench/score.h"
#include "tests/bench/statistics.h"
#include "tests/oracle/fcl_model.h"

namespace mortise::bench {
namespace {

constexpr const char* kAlgebraic = "algebraic equations";
constexpr const char* kSwept = "swept volume";
constexpr const char* kBisection = "adaptive bisection";

Answer told(double time_s, bool hit, double t) {
  Answer answer;
  answer.time_s = time_s;
  answer.outcome = hit ? Outcome::kContact : Outcome::kFree;
  answer.t = hit ? t : 1.0;
  return answer;
}

using Corners = std::vector<Vec3>;
Corners corners_at(const Solid& part, const Pose& X) {
  Corners corners;
  for (const Vec3& x : part.mesh().points_mm) corners.push_back(X * x);
  return corners;
}

// A point that goes straight from one place to the other.
struct Line {
  Vec3 from, to;
  Vec3 at(double t) const { return from + t * (to - from); }
};

// Roots of a cubic in [0, 1], given by its values at four places: between its extrema by halving.
std::vector<double> roots_of(const std::array<double, 4>& at_thirds) {
  const auto [a, b, c, d] = at_thirds;
  const double k0 = a, k1 = 0.5 * (-11.0 * a + 18.0 * b - 9.0 * c + 2.0 * d),
               k2 = 0.5 * (18.0 * a - 45.0 * b + 36.0 * c - 9.0 * d),
               k3 = 0.5 * (-9.0 * a + 27.0 * b - 27.0 * c + 9.0 * d);
  const auto f = [&](double t) { return k0 + t * (k1 + t * (k2 + t * k3)); };
  std::vector<double> ends = {0.0, 1.0};
  if (const double root = k2 * k2 - 3.0 * k1 * k3; std::fabs(k3) > 0.0 && root > 0.0)
    for (const double sign : {-1.0, 1.0})
      ends.push_back((-k2 + sign * std::sqrt(root)) / (3.0 * k3));
  else if (std::fabs(k2) > 0.0)
    ends.push_back(-0.5 * k1 / k2);
  std::erase_if(ends, [](double t) { return !(t >= 0.0 && t <= 1.0); });
  std::sort(ends.begin(), ends.end());
  std::vector<double> roots;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    double lo = ends[i], hi = ends[i + 1];
    if (f(lo) == 0.0) roots.push_back(lo);
    if (!(f(lo) * f(hi) < 0.0)) continue;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (lo + hi);
      (f(lo) * f(middle) <= 0.0 ? hi : lo) = middle;
    }
    roots.push_back(hi);
  }
  return roots;
}

// When four moving points lie in one plane (Canny 1986; Redon 2000), and there the first three hold
// the fourth, or the edges of the first and of the last two cross.
template <class Meets>
void first_coplanar(const std::array<Line, 4>& p, const Meets& meets, double& first) {
  const auto volume = [&](double t) {
    const Vec3 o = p[0].at(t);
    return (p[1].at(t) - o).cross(p[2].at(t) - o).dot(p[3].at(t) - o);
  };
  for (const double t : roots_of({volume(0.0), volume(1.0 / 3.0), volume(2.0 / 3.0), volume(1.0)}))
    if (t < first && meets(p[0].at(t), p[1].at(t), p[2].at(t), p[3].at(t))) {
      first = t;
      return;
    }
}

bool in_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 n = (b - a).cross(c - a);
  return n.dot((b - a).cross(x - a)) >= 0.0 && n.dot((c - b).cross(x - b)) >= 0.0 &&
         n.dot((a - c).cross(x - c)) >= 0.0;
}

bool edges_cross(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 n = (b - a).cross(d - c);
  const double size = n.squaredNorm();
  if (!(size > 0.0)) return false;
  const double s = (c - a).cross(d - c).dot(n) / size, u = (c - a).cross(b - a).dot(n) / size;
  return s >= 0.0 && s <= 1.0 && u >= 0.0 && u <= 1.0;
}

Box swept_of(const std::array<Line, 3>& triangle) {
  Box box;
  for (const Line& line : triangle) {
    box.add(line.from);
    box.add(line.to);
  }
  return box;
}

using Moving = std::array<Line, 3>;
std::vector<Moving> moving_triangles(const Solid& part, const Pose& X0, const Pose& X1) {
  const Corners from = corners_at(part, X0), to = corners_at(part, X1);
  std::vector<Moving> triangles;
  for (const auto& t : part.mesh().triangles) {
    Moving moving;
    for (std::size_t k = 0; k < 3; ++k) moving[k] = {from[t[k]], to[t[k]]};
    triangles.push_back(moving);
  }
  return triangles;
}

void first_of_triangles(const Moving& a, const Moving& b, double& first) {
  for (const Line& x : b) first_coplanar({a[0], a[1], a[2], x}, in_triangle, first);
  for (const Line& x : a) first_coplanar({b[0], b[1], b[2], x}, in_triangle, first);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      first_coplanar({a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]}, edges_cross, first);
}

Method algebraic(const MotionSet& set) {
  return {kAlgebraic, false, false, 0.0, [set](const Motion& motion) {
            double first = 2.0;
            const double time_s = least_time_s([&] {
              first = 2.0;
              const auto a = moving_triangles(*set.moving, motion.X_W0, motion.X_W1);
              const auto b = moving_triangles(*set.fixed, Pose(), Pose());
              std::vector<Box> boxes;
              for (const Moving& triangle : b) boxes.push_back(swept_of(triangle));
              for (const Moving& mine : a) {
                const Box swept = swept_of(mine);
                for (std::size_t i = 0; i < b.size(); ++i)
                  if (swept.overlaps(boxes[i])) first_of_triangles(mine, b[i], first);
              }
            });
            return told(time_s, first <= 1.0, first);
          }};
}

// What a convex part passes over (Abdel-Malek 2006), as hulls of its places at the ends of so many
// pieces of the way.
constexpr int kSweptPieces = 16;

Method swept_volume(const MotionSet& set) {
  return {
      kSwept, false, false, 0.0, [set](const Motion& motion) {
        int at = kSweptPieces;
        const double time_s = least_time_s([&] {
          const ccd_t ccd = ccd_of_points();
          for (at = 0; at < kSweptPieces; ++at) {
            Corners hull = corners_at(*set.moving, motion.pose_at(double(at) / kSweptPieces));
            const Corners end = corners_at(*set.moving, motion.pose_at((at + 1.0) / kSweptPieces));
            hull.insert(hull.end(), end.begin(), end.end());
            Box box;
            for (const Vec3& x : hull) box.add(x);
            const TriangleMesh& fixed = set.fixed->mesh();
            for (std::uint32_t t = 0; t < fixed.triangles.size(); ++t) {
              const Corners triangle = {fixed.corner(t, 0), fixed.corner(t, 1), fixed.corner(t, 2)};
              Box own;
              for (const Vec3& x : triangle) own.add(x);
              if (own.overlaps(box) && ccdGJKIntersect(&hull, &triangle, &ccd) != 0) return;
            }
          }
        });
        return told(time_s, at < kSweptPieces, double(at) / kSweptPieces);
      }};
}

// Free between two times at which the distances together are more than any point travels; else
// halved (Redon 2002; Schwarzer 2004).
class Bisection {
 public:
  Bisection(const MotionSet& set, const Motion& motion, const testing::FclModel& a,
            const testing::FclModel& b)
      : motion_(motion), a_(a), b_(b) {
    for (const Vec3& x : set.moving->mesh().points_mm) radius_mm_ = std::max(radius_mm_, x.norm());
  }
  // The first time that is not shown to be free; above 1: none.
  double first() const { return first(0.0, distance(0.0), 1.0, distance(1.0)); }

 private:
  static constexpr double kAccuracy_mm = 1e-4;
  double distance(double t) const {
    return std::max(0.0, testing::fcl_distance(a_, motion_.pose_at(t), b_, {}));
  }
  double first(double t0, double d0, double t1, double d1) const {
    const double path_mm = motion_.travel_upper_bound_mm(radius_mm_, t0, t1);
    if (d0 + d1 > path_mm) return 2.0;
    if (path_mm < kAccuracy_mm) return t0;
    const double middle = 0.5 * (t0 + t1), d = distance(middle);
    const double before = first(t0, d0, middle, d);
    return before <= 1.0 ? before : first(middle, d, t1, d1);
  }

  const Motion& motion_;
  const testing::FclModel &a_, &b_;
  double radius_mm_ = 0.0;
};

Method adaptive_bisection(const MotionSet& set) {
  const auto a = testing::fcl_model(set.moving->mesh()), b = testing::fcl_model(set.fixed->mesh());
  return {kBisection, false, false, 1e-4, [set, a, b](const Motion& motion) {
            double first = 2.0;
            const double time_s =
                least_time_s([&] { first = Bisection(set, motion, a, b).first(); });
            return told(time_s, first <= 1.0, first);
          }};
}

struct Words {
  const char* method;
  const char* cannot_say;
};
constexpr Words kWords[] = {
    {kAlgebraic, "where corners turn: they are taken to go straight; contact in one plane"},
    {kSwept,
     "when: only in which piece of the way; parts that are not convex; a turn between pieces"},
    {kBisection, "that a way in touch is free: it halves until its accuracy is reached"},
    {kRepairedOBBRSS, "an accuracy in mm: 1e-5 of the motion; FCL as shipped misses most contacts"},
    {kOnDistance, "how close it is where it stops early: the parts are only near"},
};

std::string cannot_say(const Method& method) {
  for (const Words& words : kWords)
    if (method.name == words.method) return words.cannot_say;
  return "what parts that overlap at the start do: that is judged by depth";
}

}  // namespace

std::vector<Method> paper_methods(const MotionSet& set) {
  return {algebraic(set), swept_volume(set), adaptive_bisection(set)};
}

void section_contact(Report& report, const BenchOptions& options) {
  const int count = options.quick ? 12 : 40;
  const Limits limits = options.quick ? Limits{0.5, 1.0} : Limits{2.0, 8.0};
  std::vector<MotionSet> sets = {sphere_set(16, 9, count), peg_set(0.5, 32, count),
                                 wall_set(count)};
  std::vector<Method> methods;
  std::vector<Score> scores;
  for (MotionSet& set : sets) {
    find_truth(set);
    std::vector<Method> asked = paper_methods(set);
    for (Method& peer : fcl_methods(set))
      if (peer.name == kRepairedOBBRSS || peer.name == kOnDistance)
        asked.push_back(std::move(peer));
    asked.push_back(ours(set, 1e-6));
    for (std::size_t i = 0; i < asked.size(); ++i) {
      if (i == methods.size()) {
        methods.push_back(asked[i]);
        scores.emplace_back();
      }
      scores[i].add(
          score(set, asked[i],
                asked[i].ours ? ask_all(asked[i], set) : ask_guarded(asked[i], set, limits)));
    }
  }
  report.table(
      "Approaches to the first contact: balls, a peg in its bore, boxes and a wall of 1 um",
      {"approach", "asked", "gave up", "ms median", "ms p99", "late worst mm", "early worst mm",
       "missed", "false hits", "cannot say"});
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const Score& s = scores[i];
    report.row({methods[i].name, s.asked, s.asked - s.decided, 1e3 * median(s.time_s),
                1e3 * quantile(s.time_s, 0.99), largest(s.late_mm), largest(s.early_mm), s.missed,
                s.false_hits, cannot_say(methods[i])});
  }
  const Score& own = scores.back();
  report.bar("first contact, ours: missed, late or false",
             static_cast<double>(own.missed + own.late + own.false_hits), 0, BoundKind::kAtMost);
}

}  // namespace mortise::bench
