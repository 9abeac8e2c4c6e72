#include "common/io/mesh/mesh_clean.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

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

}  // namespace

CleanMesh weld(const std::vector<double>& coordinates, double unit_mm) {
  // 1. Corners; adding zero turns -0 into 0, so that both weld and hash alike.
  std::vector<Vec3> corners(coordinates.size() / 3);
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] =
        Vec3(coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]).array() + 0.0;
  const std::vector<std::uint32_t> first = first_at_same_place(corners);

  // 2. Triangles with three corners, then those with an area.
  CleanMesh clean;
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i + 2 < corners.size(); i += 3) {
    const Corners t = {first[i], first[i + 1], first[i + 2]};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      ++clean.degenerate_dropped;
    else
      triangles.push_back(t);
  }
  FlatTriangles flats(corners, triangles);
  flats.take_out();
  clean.degenerate_dropped += flats.dropped();
  clean.triangles_split = flats.split();

  // 3. Points in the order of their use.
  constexpr std::uint32_t kNotUsed = 0xffffffffU;
  std::vector<std::uint32_t> number(corners.size(), kNotUsed);
  for (Corners& triangle : triangles) {
    for (std::uint32_t& corner : triangle) {
      std::uint32_t& point = number[corner];
      if (point == kNotUsed) {
        point = static_cast<std::uint32_t>(clean.mesh.points_mm.size());
        clean.mesh.points_mm.push_back(unit_mm * corners[corner]);
      }
      corner = point;
    }
    clean.mesh.triangles.push_back(triangle);
  }
  clean.duplicate_triangles = count_duplicates(clean.mesh.triangles);
  return clean;
}

}  // namespace mortise
