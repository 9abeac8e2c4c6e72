#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "common/geometry/solid.h"
#include "common/geometry/surface_band.h"

/// Random polyhedra whose faces have bands, with their least and largest bodies known as formulas
/// of offset half-spaces. Shares no code with what it judges.
namespace mortise::polyhedra {

using Random = std::mt19937_64;

struct HalfSpace {
  Vec3 n = Vec3::UnitZ();
  double c = 0.0;  ///< n · x <= c
  Interval offset_mm;
};

struct Polyhedron {
  std::vector<HalfSpace> half_spaces;
  std::vector<std::vector<int>> terms;  ///< the union of intersections of half-spaces
  SolidPtr solid;
  SurfaceBand band;
};

inline double between(Random& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}
inline Vec3 direction(Random& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}
inline Quat rotation(Random& random) {
  std::normal_distribution<double> normal;
  return Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
}

/// A band for each half-space.
inline void add_bands(Random& random, Polyhedron& body) {
  const double t = std::array<double, 3>{0.02, 0.05, 0.1}[random() % 3];
  for (HalfSpace& h : body.half_spaces) {
    h.offset_mm.lo = -t * between(random, 0.0, 1.0);
    h.offset_mm.hi = std::max(h.offset_mm.lo + 1e-3, t * between(random, -0.5, 1.0));
  }
  if (random() % 3 == 0)
    for (HalfSpace& h : body.half_spaces) h.offset_mm = {-t, t};
}

inline void finish(Polyhedron& body, TriangleMesh mesh, std::vector<std::uint16_t> face_of) {
  body.band.faces.clear();
  for (const HalfSpace& h : body.half_spaces) {
    SurfaceBand::Face face;
    face.grade = DeviationGrade::kNominal;
    face.tolerance_mm = h.offset_mm;
    body.band.faces.push_back(face);
    body.band.largest_offset_mm = std::max(body.band.largest_offset_mm, h.offset_mm.hi);
  }
  body.band.trivial = false;
  body.band.face_of_triangle = std::move(face_of);
  body.solid = std::make_shared<const Solid>(std::move(mesh));
}

/// The corners of an intersection of half-spaces.
inline std::vector<Vec3> corners_of(const std::vector<HalfSpace>& half_spaces) {
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < half_spaces.size(); ++i)
    for (std::size_t j = i + 1; j < half_spaces.size(); ++j)
      for (std::size_t k = j + 1; k < half_spaces.size(); ++k) {
        Mat3 m;
        m << half_spaces[i].n.transpose(), half_spaces[j].n.transpose(),
            half_spaces[k].n.transpose();
        if (std::fabs(m.determinant()) < 1e-6) continue;
        const Vec3 x = m.inverse() * Vec3(half_spaces[i].c, half_spaces[j].c, half_spaces[k].c);
        bool inside = true;
        for (const HalfSpace& h : half_spaces) inside &= h.n.dot(x) <= h.c + 1e-9;
        if (inside) corners.push_back(x);
      }
  return corners;
}

/// False: two corners are too near to each other to be told apart.
inline bool mesh_of(const std::vector<HalfSpace>& half_spaces, TriangleMesh& mesh,
                    std::vector<std::uint16_t>& face_of) {
  mesh.points_mm = corners_of(half_spaces);
  for (std::size_t i = 0; i < mesh.points_mm.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if ((mesh.points_mm[i] - mesh.points_mm[j]).norm() < 0.05) return false;
  for (std::size_t f = 0; f < half_spaces.size(); ++f) {
    const HalfSpace& h = half_spaces[f];
    std::vector<std::pair<double, std::uint32_t>> around;
    Vec3 middle = Vec3::Zero();
    std::vector<std::uint32_t> on;
    for (std::uint32_t i = 0; i < mesh.points_mm.size(); ++i)
      if (std::fabs(h.n.dot(mesh.points_mm[i]) - h.c) < 1e-9) on.push_back(i);
    if (on.size() < 3) return false;
    for (const std::uint32_t i : on) middle += mesh.points_mm[i] / static_cast<double>(on.size());
    const Vec3 u = h.n.unitOrthogonal(), v = h.n.cross(u);
    for (const std::uint32_t i : on) {
      const Vec3 d = mesh.points_mm[i] - middle;
      around.push_back({std::atan2(d.dot(v), d.dot(u)), i});
    }
    std::sort(around.begin(), around.end());
    for (std::size_t i = 2; i < around.size(); ++i) {
      mesh.triangles.push_back({around[0].second, around[i - 1].second, around[i].second});
      face_of.push_back(static_cast<std::uint16_t>(f));
    }
  }
  return true;
}

/// Boxes, tetrahedra, and what planes cut off them.
inline Polyhedron random_convex(Random& random) {
  for (;;) {
    Polyhedron body;
    const Quat q = rotation(random);
    if (random() % 2 == 0) {
      for (int k = 0; k < 3; ++k)
        for (const double sign : {1.0, -1.0})
          body.half_spaces.push_back({q * (sign * Vec3::Unit(k)), between(random, 1.0, 4.0), {}});
    } else {
      for (const Vec3& n : {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)})
        body.half_spaces.push_back(
            {q * Vec3(n + 0.5 * direction(random)).normalized(), between(random, 1.0, 2.5), {}});
    }
    for (auto cuts = random() % 4; cuts > 0; --cuts)
      body.half_spaces.push_back({direction(random), between(random, 0.8, 2.0), {}});
    body.terms.resize(1);
    for (std::size_t i = 0; i < body.half_spaces.size(); ++i)
      body.terms[0].push_back(static_cast<int>(i));
    TriangleMesh mesh;
    std::vector<std::uint16_t> face_of;
    if (!mesh_of(body.half_spaces, mesh, face_of)) continue;
    add_bands(random, body);
    finish(body, std::move(mesh), std::move(face_of));
    if (body.solid->topology().closed()) return body;
  }
}

/// Up to three boxes united, less up to two, along common axes; no two faces in one plane.
class RandomBoxes {
 public:
  explicit RandomBoxes(Random& random) : random_(random) {}

  Polyhedron make() {
    for (;;) {
      body_ = Polyhedron();
      boxes_.clear();
      tools_.clear();
      for (auto& planes : at_) planes.clear();
      for (auto count = 1 + random_() % 3; count > 0; --count) add_box(boxes_, false, 3.0);
      for (auto count = random_() % 3; count > 0; --count) add_box(tools_, true, 2.5);
      if (!far_apart()) continue;
      add_terms();
      add_bands(random_, body_);
      TriangleMesh mesh;
      std::vector<std::uint16_t> face_of;
      add_facets(mesh, face_of);
      if (mesh.triangles.empty()) continue;
      finish(body_, std::move(mesh), std::move(face_of));
      if (body_.solid->topology().closed()) return body_;
    }
  }

 private:
  struct Plane {
    double at = 0.0;
    int half_space = 0;
  };
  using Six = std::array<int, 6>;  // half-spaces of a box: lower and upper, by axis

  void add_box(std::vector<Six>& to, bool tool, double size) {
    Six six{};
    for (int k = 0; k < 3; ++k) {
      const double middle = between(random_, -2.0, 2.0), half = between(random_, 0.5, size);
      for (int side = 0; side < 2; ++side) {
        const double at = middle + (side == 0 ? -half : half);
        // Material lies inside of a box, outside of a tool.
        const double sign = (side == 0) != tool ? -1.0 : 1.0;
        six[static_cast<std::size_t>(2 * k + side)] = static_cast<int>(body_.half_spaces.size());
        at_[k].push_back({at, static_cast<int>(body_.half_spaces.size())});
        body_.half_spaces.push_back({sign * Vec3::Unit(k), sign * at, {}});
      }
    }
    to.push_back(six);
  }

  bool far_apart() {
    for (auto& planes : at_) {
      std::sort(planes.begin(), planes.end(),
                [](const Plane& a, const Plane& b) { return a.at < b.at; });
      for (std::size_t i = 1; i < planes.size(); ++i)
        if (planes[i].at - planes[i - 1].at < 0.35) return false;
    }
    return true;
  }

  void add_terms() {
    for (const Six& box : boxes_) {
      std::vector<std::vector<int>> terms = {{box.begin(), box.end()}};
      for (const Six& tool : tools_) {
        std::vector<std::vector<int>> more;
        for (const std::vector<int>& term : terms)
          for (const int outside : tool) {
            more.push_back(term);
            more.back().push_back(outside);
          }
        terms = more;
      }
      body_.terms.insert(body_.terms.end(), terms.begin(), terms.end());
    }
  }

  bool holds(const Vec3& x) const {
    const auto in = [&](int h) {
      return body_.half_spaces[static_cast<std::size_t>(h)].n.dot(x) <
             body_.half_spaces[static_cast<std::size_t>(h)].c;
    };
    const auto all = [&](const Six& six) { return std::all_of(six.begin(), six.end(), in); };
    const auto none = [&](const Six& six) { return std::none_of(six.begin(), six.end(), in); };
    return std::any_of(boxes_.begin(), boxes_.end(), all) &&
           std::none_of(tools_.begin(), tools_.end(), none);
  }

  // Cells between neighbouring planes are in or out; their borders between in and out are facets.
  void add_facets(TriangleMesh& mesh, std::vector<std::uint16_t>& face_of) const {
    std::array<std::size_t, 3> n{};
    for (std::size_t k = 0; k < 3; ++k) n[k] = at_[k].size();
    std::vector<std::uint32_t> point(n[0] * n[1] * n[2], 0xffffffffU);
    const auto in_cell = [&](const std::array<std::size_t, 3>& c, std::size_t axis, int step) {
      Vec3 x;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto i = static_cast<std::ptrdiff_t>(c[k]) + (k == axis ? step : 0);
        if (i < 0 || i + 1 >= static_cast<std::ptrdiff_t>(n[k])) return false;
        x[static_cast<int>(k)] = 0.5 * (at_[k][static_cast<std::size_t>(i)].at +
                                        at_[k][static_cast<std::size_t>(i) + 1].at);
      }
      return holds(x);
    };
    const auto point_of = [&](const std::array<std::size_t, 3>& p) {
      std::uint32_t& index = point[(p[0] * n[1] + p[1]) * n[2] + p[2]];
      if (index == 0xffffffffU) {
        index = static_cast<std::uint32_t>(mesh.points_mm.size());
        mesh.points_mm.push_back({at_[0][p[0]].at, at_[1][p[1]].at, at_[2][p[2]].at});
      }
      return index;
    };
    std::array<std::size_t, 3> c{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (c[0] = 0; c[0] < n[0]; ++c[0])
        for (c[1] = 0; c[1] < n[1]; ++c[1])
          for (c[2] = 0; c[2] < n[2]; ++c[2]) {
            const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
            if (c[u] + 1 >= n[u] || c[v] + 1 >= n[v]) continue;
            const bool above = in_cell(c, axis, 0), below = in_cell(c, axis, -1);
            if (above == below) continue;
            std::array<std::size_t, 3> pu = c, pv = c, puv = c;
            ++pu[u], ++pv[v], ++puv[u], ++puv[v];
            const std::uint32_t a = point_of(c), b = point_of(pu), d = point_of(pv),
                                e = point_of(puv);
            if (below) {
              mesh.triangles.push_back({a, b, e});
              mesh.triangles.push_back({a, e, d});
            } else {
              mesh.triangles.push_back({a, e, b});
              mesh.triangles.push_back({a, d, e});
            }
            face_of.insert(face_of.end(), 2,
                           static_cast<std::uint16_t>(at_[axis][c[axis]].half_space));
          }
  }

  Random& random_;
  Polyhedron body_;
  std::vector<Six> boxes_, tools_;
  std::array<std::vector<Plane>, 3> at_;
};

inline Polyhedron random_boxes(Random& random) { return RandomBoxes(random).make(); }

/// Largest d such that some x has n · x + d <= c for all rows, if that is above `best`: the best of
/// all points in which four rows meet. (n, c) of each row.
inline double deepest(const std::vector<Eigen::Vector4d>& rows, double best) {
  const std::size_t n = rows.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k)
        for (std::size_t l = k + 1; l < n; ++l) {
          Eigen::Matrix4d m;
          Eigen::Vector4d h;
          int at = 0;
          for (const std::size_t r : {i, j, k, l}) {
            m.row(at) << rows[r].head<3>().transpose(), 1.0;
            h[at++] = rows[r][3];
          }
          if (std::fabs(m.determinant()) < 1e-9) continue;
          const Eigen::Vector4d y = m.inverse() * h;
          if (!(y[3] > best)) continue;
          bool feasible = true;
          for (const Eigen::Vector4d& row : rows)
            feasible &= row.head<3>().dot(y.head<3>()) + y[3] <= row[3] + 1e-7;
          if (feasible) best = y[3];
        }
  return best;
}

enum class Body { kLeast, kLargest };

inline Eigen::Vector4d row_of(const HalfSpace& h, const Pose& X, Body body) {
  const Vec3 n = X.q * h.n;
  const double c = h.c + n.dot(X.p) + (body == Body::kLeast ? h.offset_mm.lo : h.offset_mm.hi);
  return {n.x(), n.y(), n.z(), c};
}

/// Twice the largest lesser depth of a common point of the two bodies; X_BA places A.
inline double true_margin(const Polyhedron& a, const Polyhedron& b, const Pose& X_BA, Body body) {
  double best = -10.0;
  for (const std::vector<int>& in_a : a.terms)
    for (const std::vector<int>& in_b : b.terms) {
      std::vector<Eigen::Vector4d> rows;
      for (const int i : in_a)
        rows.push_back(row_of(a.half_spaces[static_cast<std::size_t>(i)], X_BA, body));
      for (const int i : in_b)
        rows.push_back(row_of(b.half_spaces[static_cast<std::size_t>(i)], Pose(), body));
      best = deepest(rows, best);
    }
  return 2.0 * best;
}

/// Depth of x in the least or largest body, both in the frame in which X places it.
inline double depth_in(const Polyhedron& a, const Pose& X, const Vec3& x, Body body) {
  double most = -std::numeric_limits<double>::infinity();
  for (const std::vector<int>& term : a.terms) {
    double least = std::numeric_limits<double>::infinity();
    for (const int i : term) {
      const Eigen::Vector4d row = row_of(a.half_spaces[static_cast<std::size_t>(i)], X, body);
      least = std::min(least, row[3] - row.head<3>().dot(x));
    }
    most = std::max(most, least);
  }
  return most;
}

}  // namespace mortise::polyhedra
