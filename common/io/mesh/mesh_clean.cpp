#include "common/io/mesh/mesh_clean.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "common/geometry/border.h"

namespace mortise {
namespace {

/// A triangle lower than this part of its longest edge has no area: no drawing has a sliver of one
/// to a billion, and no normal could be taken from it.
constexpr double kNoHeight = 1e-9;

using Corners = std::array<std::uint32_t, 3>;

/// For each corner the first corner at exactly the same place.
std::vector<std::uint32_t> first_at_same_place(const std::vector<Vec3>& corners) {
  std::vector<std::uint32_t> order(corners.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto before = [&](std::uint32_t i, std::uint32_t j) {
    const Vec3& a = corners[i];
    const Vec3& b = corners[j];
    if (a.x() != b.x()) return a.x() < b.x();
    if (a.y() != b.y()) return a.y() < b.y();
    if (a.z() != b.z()) return a.z() < b.z();
    return i < j;
  };
  std::sort(order.begin(), order.end(), before);
  std::vector<std::uint32_t> first(corners.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && corners[order[i]] == corners[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

bool without_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest2 =
      std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() <= kNoHeight * longest2;
}

/// Takes triangles without area out of a mesh without opening it. Such a triangle a b c, b on the
/// line from a to c, closes the surface between its long side and its two short ones; when it goes,
/// the one neighbour across the long side is split at b. (Importers make them when they cut a
/// polygon with corners in a row.)
class FlatTriangles {
 public:
  FlatTriangles(const std::vector<Vec3>& corners, std::vector<Corners>& triangles)
      : corners_(corners), triangles_(triangles), gone_(triangles.size(), false) {}

  void take_out() {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      if (flat(t)) waiting_.push_back(t);
    if (waiting_.empty()) return;
    dropped_ = waiting_.size();
    const std::size_t with_area = triangles_.size() - dropped_;
    list_neighbors();
    // A split makes at most one more flat triangle, with a shorter long side; the cap only guards
    // against rounding.
    const std::size_t most = 64 * waiting_.size() + 64;
    for (std::size_t i = 0; i < waiting_.size() && i < most; ++i) take_out(waiting_[i]);
    for (const std::uint32_t t : waiting_) drop(t);
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      if (!gone_[t]) triangles_[kept++] = triangles_[t];
    triangles_.resize(kept);
    split_ = kept - with_area;
  }

  std::uint64_t dropped() const { return dropped_; }
  std::uint64_t split() const { return split_; }

 private:
  bool flat(std::uint32_t t) const {
    const Corners& c = triangles_[t];
    return without_area(corners_[c[0]], corners_[c[1]], corners_[c[2]]);
  }

  void drop(std::uint32_t t) {
    if (flat(t)) gone_[t] = true;
  }

  /// Triangles at every corner of a flat one.
  void list_neighbors() {
    for (const std::uint32_t t : waiting_)
      for (const std::uint32_t corner : triangles_[t]) at_[corner];
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) list(t);
  }
  void list(std::uint32_t t) {
    for (const std::uint32_t corner : triangles_[t])
      if (const auto found = at_.find(corner); found != at_.end()) found->second.push_back(t);
  }

  static int place_in(const Corners& triangle, std::uint32_t corner) {
    for (int k = 0; k < 3; ++k)
      if (triangle[k] == corner) return k;
    return -1;
  }

  void take_out(std::uint32_t t) {
    if (gone_[t] || !flat(t)) return;
    const Corners& c = triangles_[t];
    int middle = 0;  // the corner across the longest side
    double longest2 = -1.0;
    for (int k = 0; k < 3; ++k) {
      const double side2 = (corners_[c[(k + 1) % 3]] - corners_[c[(k + 2) % 3]]).squaredNorm();
      if (side2 > longest2) {
        longest2 = side2;
        middle = k;
      }
    }
    const std::uint32_t b = c[middle], from = c[(middle + 1) % 3], to = c[(middle + 2) % 3];
    std::vector<std::uint32_t> across;
    for (const std::uint32_t other : at_[from]) {
      if (other == t || gone_[other] || place_in(triangles_[other], from) < 0) continue;
      if (place_in(triangles_[other], to) >= 0 &&
          std::find(across.begin(), across.end(), other) == across.end())
        across.push_back(other);
    }
    drop(t);
    if (across.size() != 1) return;
    const std::uint32_t neighbor = across.front();
    if (place_in(triangles_[neighbor], b) >= 0) {  // the same three corners: both close nothing
      drop(neighbor);
      return;
    }
    split(neighbor, from, to, b);
  }

  void split(std::uint32_t t, std::uint32_t from, std::uint32_t to, std::uint32_t b) {
    Corners first = triangles_[t], second = triangles_[t];
    first[place_in(first, to)] = b;
    second[place_in(second, from)] = b;
    triangles_[t] = first;
    const auto added = static_cast<std::uint32_t>(triangles_.size());
    triangles_.push_back(second);
    gone_.push_back(false);
    if (const auto found = at_.find(b); found != at_.end()) found->second.push_back(t);
    list(added);
    if (flat(t)) waiting_.push_back(t);
    if (flat(added)) waiting_.push_back(added);
  }

  const std::vector<Vec3>& corners_;
  std::vector<Corners>& triangles_;
  std::vector<bool> gone_;
  std::vector<std::uint32_t> waiting_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> at_;
  std::uint64_t dropped_ = 0, split_ = 0;
};

std::uint64_t count_duplicates(const std::vector<Corners>& triangles) {
  std::vector<Corners> sorted = triangles;
  for (Corners& t : sorted) std::sort(t.begin(), t.end());
  std::sort(sorted.begin(), sorted.end());
  std::uint64_t count = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) count += sorted[i] == sorted[i - 1] ? 1 : 0;
  return count;
}

// Copies of a triangle of which all three edges are passed more often its way than the other way:
// without one of them they balance better. Copies that face each other, and a mesh that is there
// twice as a whole, stay.
std::uint64_t drop_surplus_copies(std::vector<Corners>& triangles) {
  std::map<Corners, std::uint32_t> copies;
  const auto from_least = [](Corners t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  for (const Corners& t : triangles) ++copies[from_least(t)];
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Edge, int> surplus;  // of passes from the smaller corner to the larger
  const auto passes = [&](const Corners& t, int k) -> std::pair<int*, int> {
    const std::uint32_t from = t[k], to = t[(k + 1) % 3];
    return {&surplus[std::minmax(from, to)], from < to ? 1 : -1};
  };
  for (const Corners& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const auto [count, way] = passes(t, k);
      *count += way;
    }
  return std::erase_if(triangles, [&](const Corners& t) {
    std::uint32_t& left = copies[from_least(t)];
    if (left < 2) return false;
    for (int k = 0; k < 3; ++k)
      if (const auto [count, way] = passes(t, k); *count * way < 1) return false;
    for (int k = 0; k < 3; ++k) {
      const auto [count, way] = passes(t, k);
      *count -= way;
    }
    --left;
    return true;
  });
}

// The triangles that are left of loose ones whose corners have been made one.
struct Assembled {
  std::vector<Corners> triangles;
  std::uint64_t dropped = 0, split = 0;
};

Assembled assemble(const std::vector<Vec3>& corners, const std::vector<Corners>& loose) {
  Assembled assembled;
  for (const Corners& t : loose)
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      ++assembled.dropped;
    else
      assembled.triangles.push_back(t);
  FlatTriangles flats(corners, assembled.triangles);
  flats.take_out();
  assembled.dropped += flats.dropped();
  assembled.split = flats.split();
  return assembled;
}

/// Closes open edges whose corners are almost those of others, or lie almost on others.
class CrackWelder {
 public:
  CrackWelder(const std::vector<Vec3>& corners, const std::vector<BorderEdge>& border, double near)
      : corners_(corners), border_(border), near_(near) {
    for (const BorderEdge& edge : border) points_.insert(points_.end(), {edge.from, edge.to});
    std::sort(points_.begin(), points_.end(), [&](std::uint32_t i, std::uint32_t j) {
      const double a = corners[i].x(), b = corners[j].x();
      return a != b ? a < b : i < j;
    });
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
  }

  /// Corners of open edges onto the first one near them.
  void join_corners(std::vector<Corners>& triangles) {
    std::map<std::uint32_t, std::uint32_t> onto;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vec3& x = corners_[points_[i]];
      std::uint32_t best = points_[i];
      for (std::size_t j = i; j-- > 0 && corners_[points_[j]].x() >= x.x() - near_;) {
        const auto earlier = onto.find(points_[j]);
        if (earlier == onto.end() && (corners_[points_[j]] - x).norm() <= near_) best = points_[j];
      }
      if (best != points_[i]) onto[points_[i]] = best;
    }
    for (const auto& [point, to] : onto) note((corners_[point] - corners_[to]).norm());
    if (onto.empty()) return;
    for (Corners& triangle : triangles)
      for (std::uint32_t& corner : triangle)
        if (const auto found = onto.find(corner); found != onto.end()) corner = found->second;
  }

  /// Triangles along an open edge on which corners of others lie are cut there.
  void cut_edges(std::vector<Corners>& triangles) {
    std::vector<bool> cut(triangles.size(), false);
    for (const BorderEdge& edge : border_) {
      if (cut[edge.triangle]) continue;
      std::vector<std::uint32_t> row = corners_on(edge);
      if (row.empty()) continue;
      cut[edge.triangle] = true;
      row.push_back(edge.to);
      const Corners whole = triangles[edge.triangle];
      int k = 0;
      while (k < 2 && whole[k] != edge.from) ++k;
      const std::uint32_t across = whole[(k + 2) % 3];
      triangles[edge.triangle] = {edge.from, row[0], across};
      for (std::size_t i = 1; i < row.size(); ++i)
        triangles.push_back({row[i - 1], row[i], across});
    }
  }

  std::uint64_t moved() const { return moved_; }
  double farthest() const { return farthest_; }

 private:
  // In the order of their place on the edge.
  std::vector<std::uint32_t> corners_on(const BorderEdge& edge) {
    const Vec3& a = corners_[edge.from];
    const Vec3 along = corners_[edge.to] - a;
    const double length2 = along.squaredNorm();
    const double lo = std::min(a.x(), a.x() + along.x()) - near_;
    const double hi = std::max(a.x(), a.x() + along.x()) + near_;
    std::vector<std::pair<double, std::uint32_t>> found;
    auto at = std::lower_bound(points_.begin(), points_.end(), lo,
                               [&](std::uint32_t i, double x) { return corners_[i].x() < x; });
    for (; at != points_.end() && corners_[*at].x() <= hi; ++at) {
      if (*at == edge.from || *at == edge.to) continue;
      const double share = along.dot(corners_[*at] - a) / length2;
      const double off = (corners_[*at] - a - share * along).norm();
      if (!(share > 0.0 && share < 1.0) || off > near_) continue;
      if (std::min(share, 1.0 - share) * std::sqrt(length2) <= near_) continue;
      found.emplace_back(share, *at);
      note(off);
    }
    std::sort(found.begin(), found.end());
    std::vector<std::uint32_t> row;
    for (const auto& [share, point] : found) row.push_back(point);
    return row;
  }

  void note(double distance) {
    ++moved_;
    farthest_ = std::max(farthest_, distance);
  }

  const std::vector<Vec3>& corners_;
  const std::vector<BorderEdge>& border_;
  double near_;
  std::vector<std::uint32_t> points_;  // of the border, by x
  std::uint64_t moved_ = 0;
  double farthest_ = 0.0;
};

std::uint64_t open_edges(const std::vector<BorderEdge>& border) {
  std::uint64_t count = 0;
  for (const BorderEdge& edge : border) count += static_cast<std::uint64_t>(edge.times);
  return count;
}

/// Corners first, then edges, each as far as it closes something.
void weld_cracks(const std::vector<Vec3>& corners, double near, Assembled& assembled,
                 CleanMesh& clean, double unit_mm) {
  for (const bool edges : {false, true}) {
    const std::vector<BorderEdge> border = border_of(assembled.triangles);
    if (border.empty()) return;
    CrackWelder welder(corners, border, near);
    std::vector<Corners> triangles = assembled.triangles;
    edges ? welder.cut_edges(triangles) : welder.join_corners(triangles);
    if (welder.moved() == 0) continue;
    Assembled welded = assemble(corners, triangles);
    if (open_edges(border_of(welded.triangles)) >= open_edges(border)) continue;
    welded.dropped += assembled.dropped;
    welded.split += assembled.split;
    assembled = std::move(welded);
    clean.corners_moved += welder.moved();
    clean.moved_mm += unit_mm * welder.farthest();
  }
}

}  // namespace

CleanMesh weld(const std::vector<double>& coordinates, double unit_mm, double near) {
  // 1. Corners; adding zero turns -0 into 0, so that both weld and hash alike.
  std::vector<Vec3> corners(coordinates.size() / 3);
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] =
        Vec3(coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]).array() + 0.0;
  const std::vector<std::uint32_t> first = first_at_same_place(corners);

  // 2. Triangles with three corners, then those with an area; then what is almost closed.
  CleanMesh clean;
  std::vector<Corners> loose;
  for (std::uint32_t i = 0; i + 2 < corners.size(); i += 3)
    loose.push_back({first[i], first[i + 1], first[i + 2]});
  Assembled assembled = assemble(corners, loose);
  if (near > 0.0) weld_cracks(corners, near, assembled, clean, unit_mm);
  clean.degenerate_dropped = assembled.dropped;
  clean.triangles_split = assembled.split;

  // 3. Points in the order of their use.
  constexpr std::uint32_t kNotUsed = 0xffffffffU;
  std::vector<std::uint32_t> number(corners.size(), kNotUsed);
  std::vector<Corners>& triangles = clean.mesh.triangles;
  for (Corners& triangle : assembled.triangles) {
    for (std::uint32_t& corner : triangle) {
      std::uint32_t& point = number[corner];
      if (point == kNotUsed) {
        point = static_cast<std::uint32_t>(clean.mesh.points_mm.size());
        clean.mesh.points_mm.push_back(unit_mm * corners[corner]);
      }
      corner = point;
    }
    triangles.push_back(triangle);
  }
  clean.duplicate_triangles = count_duplicates(triangles);
  if (clean.duplicate_triangles > 0) clean.duplicates_dropped = drop_surplus_copies(triangles);
  return clean;
}

}  // namespace mortise
