#include "common/io/mesh/mesh_orient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "common/base/union_find.h"
#include "common/geometry/border.h"
#include "common/geometry/signed_distance.h"
#include "common/geometry/solid.h"

namespace mortise {
namespace {

using Corners = std::array<std::uint32_t, 3>;

/// Points of a shell that are asked whether they lie in another.
constexpr std::size_t kQuestions = 24;

/// Nearer to a surface than this share of its extent no side is told.
constexpr double kOnSurface = 1e-9;

/// A volume below this share of the box is that of a sheet, which faces no way.
constexpr double kSheet = 1e-12;

/// The corners from the smallest on, and whether that order is the way round of the triangle.
std::pair<Corners, bool> sorted_corners(const Corners& t) {
  Corners s = t;
  std::sort(s.begin(), s.end());
  const bool even = (s[0] == t[0] && s[1] == t[1]) || (s[0] == t[1] && s[1] == t[2]) ||
                    (s[0] == t[2] && s[1] == t[0]);
  return {s, even};
}

/// The shells of a mesh: which triangle is of which, and which of them are closed.
class Shells {
 public:
  explicit Shells(const TriangleMesh& mesh) : mesh_(mesh), patches_(mesh.triangles.size()) {
    list_sides();
    // 1. Across edges of two triangles that fit, patches grow.
    each_edge([&](std::span<const Side> sides) {
      if (sides.size() == 2 && sides[0].forward != sides[1].forward)
        patches_.join(sides[0].triangle, sides[1].triangle);
    });
    // 2. Patches that do not balance an edge of more alone belong together.
    each_edge([&](std::span<const Side> sides) {
      const auto balance = balance_of(sides);
      std::uint32_t first = kNone;
      for (const auto& [patch, more] : balance)
        if (more != 0) first = first == kNone ? patch : (patches_.join(first, patch), first);
    });
    number();
    closed_.assign(count_, true);
    each_edge([&](std::span<const Side> sides) {
      for (const auto& [shell, more] : balance_of(sides))
        if (more != 0) closed_[shell] = false;
    });
  }

  std::uint32_t count() const { return count_; }
  std::uint32_t of(std::uint32_t triangle) const { return of_[triangle]; }
  bool closed(std::uint32_t shell) const { return closed_[shell]; }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  struct Side {
    std::uint32_t low, high, triangle;
    bool forward;
  };

  void list_sides() {
    sides_.reserve(3 * mesh_.triangles.size());
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t from = mesh_.triangles[t][k], to = mesh_.triangles[t][(k + 1) % 3];
        sides_.push_back({std::min(from, to), std::max(from, to), t, from < to});
      }
    std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) {
      return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
  }

  template <class Visit>
  void each_edge(Visit&& visit) const {
    for (std::size_t i = 0; i < sides_.size();) {
      std::size_t end = i;
      while (end < sides_.size() && sides_[end].low == sides_[i].low &&
             sides_[end].high == sides_[i].high)
        ++end;
      visit(std::span(sides_).subspan(i, end - i));
      i = end;
    }
  }

  // How often each piece passes the edge one way more than the other.
  std::map<std::uint32_t, int> balance_of(std::span<const Side> sides) {
    std::map<std::uint32_t, int> balance;
    for (const Side& side : sides)
      balance[of_.empty() ? patches_.leader_of(side.triangle) : of_[side.triangle]] +=
          side.forward ? 1 : -1;
    return balance;
  }

  void number() {
    std::vector<std::uint32_t> number_of(patches_.size(), kNone);
    for (std::uint32_t t = 0; t < patches_.size(); ++t) {
      std::uint32_t& n = number_of[patches_.leader_of(t)];
      if (n == kNone) n = count_++;
      of_.push_back(n);
    }
  }

  const TriangleMesh& mesh_;
  std::vector<Side> sides_;
  UnionFind patches_;
  std::vector<std::uint32_t> of_;  // once they are numbered
  std::vector<bool> closed_;
  std::uint32_t count_ = 0;
};

/// One shell as a mesh of its own.
struct Shell {
  std::vector<std::uint32_t> triangles;
  TriangleMesh mesh;
  Box box;
  int sign = 0;                              ///< 1 outward, -1 inward, 0 open or a sheet
  std::vector<std::uint32_t> within, holds;  ///< others that it lies in, and that lie in it
  std::unique_ptr<const Solid> solid;

  const Solid& as_solid() {
    if (!solid) solid = std::make_unique<const Solid>(mesh);
    return *solid;
  }
};

TriangleMesh piece_of(const TriangleMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  TriangleMesh piece;
  std::map<std::uint32_t, std::uint32_t> number;
  for (const std::uint32_t t : triangles) {
    Corners corners{};
    for (int k = 0; k < 3; ++k) {
      const auto [at, fresh] = number.try_emplace(
          mesh.triangles[t][k], static_cast<std::uint32_t>(piece.points_mm.size()));
      if (fresh) piece.points_mm.push_back(mesh.corner(t, k));
      corners[k] = at->second;
    }
    piece.triangles.push_back(corners);
  }
  return piece;
}

int facing(const TriangleMesh& mesh, const Box& box) {
  const double volume = signed_volume_mm3(mesh), all = (box.hi - box.lo).prod();
  if (std::fabs(volume) <= kSheet * all) return 0;
  return volume > 0.0 ? 1 : -1;
}

/// Does `inner` lie wholly within `outer`? Points on the surface of the outer one say nothing.
bool lies_within(const Shell& inner, Shell& outer) {
  if ((inner.box.lo.array() < outer.box.lo.array()).any() ||
      (inner.box.hi.array() > outer.box.hi.array()).any())
    return false;
  const Solid& solid = outer.as_solid();
  const double near_mm = kOnSurface * (outer.box.hi - outer.box.lo).norm();
  const std::size_t count = inner.mesh.triangles.size();
  const std::size_t step = std::max<std::size_t>(1, count / kQuestions);
  bool any = false;
  for (std::size_t t = 0; t < count; t += step) {
    const auto triangle = static_cast<std::uint32_t>(t);
    const Vec3 middle = (inner.mesh.corner(triangle, 0) + inner.mesh.corner(triangle, 1) +
                         inner.mesh.corner(triangle, 2)) /
                        3.0;
    for (const Vec3& x : {inner.mesh.corner(triangle, 0), middle}) {
      if (nearest_point(solid, x, near_mm).triangle != Topology::kNone) continue;
      if (winding_number(solid, x) == 0) return false;
      any = true;
    }
  }
  return any;
}

/// Fills in which shells lie within which. Only those are asked whose boxes may hold each other
/// along x: a mesh may have as many shells as a quarter of its triangles.
void find_nesting(std::vector<Shell>& shells) {
  std::vector<std::uint32_t> by_low;
  double widest_mm = 0.0;
  for (std::uint32_t i = 0; i < shells.size(); ++i) {
    if (shells[i].sign == 0) continue;
    by_low.push_back(i);
    widest_mm = std::max(widest_mm, shells[i].box.hi.x() - shells[i].box.lo.x());
  }
  const auto low_of = [&](std::uint32_t i) { return shells[i].box.lo.x(); };
  std::sort(by_low.begin(), by_low.end(),
            [&](std::uint32_t a, std::uint32_t b) { return low_of(a) < low_of(b); });
  for (const std::uint32_t inner : by_low) {
    const auto from = std::partition_point(by_low.begin(), by_low.end(), [&](std::uint32_t j) {
      return low_of(j) + widest_mm < low_of(inner);
    });
    for (auto j = from; j != by_low.end() && low_of(*j) <= low_of(inner); ++j)
      if (*j != inner && lies_within(shells[inner], shells[*j])) {
        shells[inner].within.push_back(*j);
        shells[*j].holds.push_back(inner);
      }
  }
}

}  // namespace

std::uint64_t take_out_inner_faces(TriangleMesh& mesh) {
  // 1. Pairs that look opposite ways over the same corners.
  std::map<Corners, std::array<std::vector<std::uint32_t>, 2>> same;
  const auto before = mesh.triangles.size();
  {
    std::vector<Corners> sorted;
    sorted.reserve(before);
    for (const Corners& t : mesh.triangles) sorted.push_back(sorted_corners(t).first);
    std::vector<Corners> all = sorted;
    std::sort(all.begin(), all.end());
    for (std::uint32_t t = 0; t < before; ++t) {
      const auto [first, last] = std::equal_range(all.begin(), all.end(), sorted[t]);
      if (last - first > 1) same[sorted[t]][sorted_corners(mesh.triangles[t]).second].push_back(t);
    }
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& [corners, ways] : same)
    for (std::size_t i = 0; i < std::min(ways[0].size(), ways[1].size()); ++i)
      pairs.emplace_back(ways[0][i], ways[1][i]);
  if (pairs.empty()) return 0;
  // 2. Those with material on both sides: without them the place is inside.
  std::vector<bool> out(before, false);
  for (const auto& [a, b] : pairs) out[a] = out[b] = true;
  std::vector<std::uint32_t> rest;
  for (std::uint32_t t = 0; t < before; ++t)
    if (!out[t]) rest.push_back(t);
  if (rest.empty() || !border_of(mesh.triangles).empty()) return 0;
  const Solid solid(piece_of(mesh, rest));
  for (const auto& [a, b] : pairs) {
    const Vec3 middle = (mesh.corner(a, 0) + mesh.corner(a, 1) + mesh.corner(a, 2)) / 3.0;
    if (winding_number(solid, middle) == 0) out[a] = out[b] = false;
  }
  std::vector<std::uint32_t> kept;
  for (std::uint32_t t = 0; t < before; ++t)
    if (!out[t]) kept.push_back(t);
  if (kept.size() < before) mesh = piece_of(mesh, kept);
  return before - kept.size();
}

std::uint64_t align_neighbours(TriangleMesh& mesh) {
  const Topology topology = build_topology(mesh);
  if (topology.misoriented_edges == 0) return 0;
  const auto passes = [&](std::uint32_t t, std::uint32_t from, std::uint32_t to) {
    const Corners& c = mesh.triangles[t];
    return (c[0] == from && c[1] == to) || (c[1] == from && c[2] == to) ||
           (c[2] == from && c[0] == to);
  };
  enum : char { kUnseen, kKept, kTurned };
  std::vector<char> way(mesh.triangles.size(), kUnseen);
  std::uint64_t turned = 0;
  for (std::uint32_t seed = 0; seed < way.size(); ++seed) {
    if (way[seed] != kUnseen) continue;
    std::vector<std::uint32_t> piece{seed};
    way[seed] = kKept;
    bool fits = true;
    for (std::size_t i = 0; i < piece.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t t = piece[i], other = topology.neighbor[t][k];
        if (other == Topology::kNone) continue;
        // Neighbours that fit pass their edge in opposite directions.
        const bool against = passes(other, mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
        const char wanted = against == (way[t] == kKept) ? kTurned : kKept;
        if (way[other] == kUnseen) piece.push_back(other);
        if (way[other] == kUnseen) way[other] = wanted;
        fits = fits && way[other] == wanted;
      }
    const auto others = static_cast<std::size_t>(std::count_if(
        piece.begin(), piece.end(), [&](std::uint32_t t) { return way[t] == kTurned; }));
    if (!fits || others == 0) continue;
    const char fewer = 2 * others <= piece.size() ? kTurned : kKept;
    for (const std::uint32_t t : piece) {
      if (way[t] != fewer) continue;
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
      ++turned;
    }
  }
  return turned;
}

ShellsTurned orient_shells(TriangleMesh& mesh) {
  const Shells pieces(mesh);
  std::vector<Shell> shells(pieces.count());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    shells[pieces.of(t)].triangles.push_back(t);
  for (std::uint32_t i = 0; i < shells.size(); ++i) {
    if (!pieces.closed(i)) continue;
    shells[i].mesh = piece_of(mesh, shells[i].triangles);
    shells[i].box = bounds_of(shells[i].mesh);
    shells[i].sign = facing(shells[i].mesh, shells[i].box);
  }
  std::vector<std::uint32_t> order(shells.size());
  std::iota(order.begin(), order.end(), 0U);
  find_nesting(shells);
  // Outermost first: the winding number outside of a shell is that of all around it.
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return shells[a].within.size() < shells[b].within.size();
  });
  std::vector<bool> turn(shells.size(), false);
  for (const std::uint32_t i : order) {
    int around = 0;
    for (const std::uint32_t j : shells[i].within) around += shells[j].sign;
    if (shells[i].sign >= 0 || around > 0) continue;
    const auto over = [&](std::uint32_t j) {
      shells[j].sign = -shells[j].sign;
      turn[j] = !turn[j];
    };
    over(i);
    for (const std::uint32_t j : shells[i].holds) over(j);
  }
  ShellsTurned turned;
  turned.shells = pieces.count();
  for (const Shell& shell : shells) {
    int around = 0;
    for (const std::uint32_t j : shell.within) around += shells[j].sign;
    turned.filled += shell.sign > 0 && around > 0 ? 1U : 0U;
  }
  for (std::uint32_t i = 0; i < shells.size(); ++i) {
    if (!turn[i]) continue;
    ++turned.turned;
    for (const std::uint32_t t : shells[i].triangles)
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
  return turned;
}

}  // namespace mortise
