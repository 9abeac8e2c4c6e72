#include "common/generators/triangulate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise {
namespace {

using Index = std::uint32_t;
using Triangles = std::vector<std::array<Index, 3>>;

/// An ear must be higher than this part of its longest side: three corners on a line are no ear.
constexpr double kFlatEar = 1e-10;
/// The triangles must have the polygon's area to this part.
constexpr double kAreaAgrees = 1e-9;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }
double turn(const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - a); }

bool properly_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0;
}

class Cutter {
 public:
  Cutter(const Loop& outer, const std::vector<Loop>& holes) {
    add(outer);
    ring_ = loops_[0];
    for (const Loop& hole : holes) add(hole);
  }

  Result<Triangles> run() {
    while (joined_ + 1 < loops_.size())
      if (!join_nearest_hole()) return broken("a hole cannot be joined to the outline");
    if (!cut_ears()) return broken("no ear is left to cut");
    double area = 0.0;
    for (const auto& t : triangles_) {
      const double twice = turn(points_[t[0]], points_[t[1]], points_[t[2]]);
      if (!(twice > 0.0)) return broken("a triangle is turned over");
      area += twice;
    }
    if (!(std::abs(area - twice_area_) <= kAreaAgrees * std::abs(twice_area_)))
      return broken("the area does not agree");
    return triangles_;
  }

 private:
  static Error broken(const std::string& why) {
    return fail(Code::kInvalidInput, "an outline crosses itself or a hole leaves it: " + why);
  }

  void add(const Loop& loop) {
    std::vector<Index> indices;
    for (const Vec2& p : loop) {
      indices.push_back(static_cast<Index>(points_.size()));
      points_.push_back(p);
    }
    loops_.push_back(std::move(indices));
    twice_area_ += twice_area(loop);
  }

  bool bridge_is_free(Index from, Index to) const {
    for (const auto& loop : loops_)
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const Index a = loop[i];
        const Index b = loop[(i + 1) % loop.size()];
        if (a != from && a != to && b != from && b != to &&
            properly_cross(points_[from], points_[to], points_[a], points_[b]))
          return false;
        // A corner that lies on the bridge would be run over.
        if (a != from && a != to && lies_on(points_[a], points_[from], points_[to])) return false;
      }
    for (const auto& [a, b] : bridges_)
      if (properly_cross(points_[from], points_[to], points_[a], points_[b])) return false;
    return true;
  }

  static bool lies_on(const Vec2& p, const Vec2& a, const Vec2& b) {
    const double length2 = (b - a).squaredNorm();
    const double along = (p - a).dot(b - a);
    return along > 0.0 && along < length2 && std::abs(turn(a, b, p)) <= kFlatEar * length2;
  }

  /// 1. The hole nearest to what is joined already, by its shortest free bridge.
  bool join_nearest_hole() {
    struct Bridge {
      double length2 = std::numeric_limits<double>::infinity();
      std::size_t hole = 0, at_ring = 0, at_hole = 0;
    };
    std::vector<Bridge> candidates;
    for (std::size_t h = 1; h < loops_.size(); ++h) {
      if (std::find(done_.begin(), done_.end(), h) != done_.end()) continue;
      for (std::size_t r = 0; r < ring_.size(); ++r)
        for (std::size_t k = 0; k < loops_[h].size(); ++k)
          candidates.push_back(
              {(points_[ring_[r]] - points_[loops_[h][k]]).squaredNorm(), h, r, k});
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Bridge& a, const Bridge& b) { return a.length2 < b.length2; });
    for (const Bridge& bridge : candidates) {
      const std::vector<Index>& hole = loops_[bridge.hole];
      const Index from = ring_[bridge.at_ring];
      const Index to = hole[bridge.at_hole];
      if (touched(from) || !bridge_is_free(from, to)) continue;
      std::vector<Index> inserted;
      for (std::size_t k = 0; k <= hole.size(); ++k)
        inserted.push_back(hole[(bridge.at_hole + k) % hole.size()]);
      inserted.push_back(from);
      ring_.insert(ring_.begin() + static_cast<std::ptrdiff_t>(bridge.at_ring) + 1,
                   inserted.begin(), inserted.end());
      bridges_.push_back({from, to});
      done_.push_back(bridge.hole);
      ++joined_;
      return true;
    }
    return false;
  }

  /// A corner takes one bridge only, so that it stands in the ring at most twice.
  bool touched(Index corner) const {
    return std::any_of(bridges_.begin(), bridges_.end(), [&](const auto& bridge) {
      return bridge.first == corner || bridge.second == corner;
    });
  }

  bool is_ear(std::size_t i) const {
    const std::size_t n = ring_.size();
    const Vec2& a = points_[ring_[(i + n - 1) % n]];
    const Vec2& b = points_[ring_[i]];
    const Vec2& c = points_[ring_[(i + 1) % n]];
    const double longest2 =
        std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if (turn(a, b, c) <= kFlatEar * longest2) return false;
    for (const Index j : ring_) {
      const Vec2& p = points_[j];
      if (p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
    }
    return true;
  }

  /// 2. Ears, the one with the shortest cut first; only the neighbours of a cut ear change, and
  /// what others hid is looked at again when no ear is known.
  bool cut_ears() {
    enum : char { kNo, kYes };
    std::vector<char> ear(ring_.size());
    const auto look_at_all = [&] {
      for (std::size_t i = 0; i < ring_.size(); ++i) ear[i] = is_ear(i) ? kYes : kNo;
    };
    look_at_all();
    bool fresh = true;
    while (ring_.size() > 3) {
      const std::size_t n = ring_.size();
      std::size_t best = n;
      double shortest2 = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < n; ++i) {
        if (ear[i] == kNo) continue;
        const double cut2 =
            (points_[ring_[(i + 1) % n]] - points_[ring_[(i + n - 1) % n]]).squaredNorm();
        if (cut2 < shortest2) {
          shortest2 = cut2;
          best = i;
        }
      }
      if (best == n) {
        if (fresh) return false;
        look_at_all();
        fresh = true;
        continue;
      }
      if (!is_ear(best)) {
        ear[best] = kNo;
        continue;
      }
      triangles_.push_back({ring_[(best + n - 1) % n], ring_[best], ring_[(best + 1) % n]});
      ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(best));
      ear.erase(ear.begin() + static_cast<std::ptrdiff_t>(best));
      const std::size_t m = ring_.size();
      for (const std::size_t i : {(best + m - 1) % m, best % m}) ear[i] = is_ear(i) ? kYes : kNo;
      fresh = false;
    }
    triangles_.push_back({ring_[0], ring_[1], ring_[2]});
    return true;
  }

  std::vector<Vec2> points_;
  std::vector<std::vector<Index>> loops_;
  std::vector<Index> ring_;
  std::vector<std::pair<Index, Index>> bridges_;
  std::vector<std::size_t> done_;
  std::size_t joined_ = 0;
  double twice_area_ = 0.0;
  Triangles triangles_;
};

}  // namespace

double twice_area(const Loop& loop) {
  double sum = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    sum += cross(loop[i] - loop[0], loop[(i + 1) % loop.size()] - loop[0]);
  return sum;
}

Result<Triangles> triangulate(const Loop& outer, const std::vector<Loop>& holes) {
  if (outer.size() < 3) return fail(Code::kInvalidInput, "an outline needs three corners");
  return Cutter(outer, holes).run();
}

}  // namespace mortise
