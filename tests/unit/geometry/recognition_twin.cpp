#include "tests/unit/geometry/recognition_twin.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace mortise::test {
namespace {

// Edges that turn by more than this are no place to look for a round. (60 degrees)
constexpr double kTurnCosine = 0.5;
// Corners lie on their surface within this share of its size.
constexpr double kOn = 1e-7;
// A facet looks where its surface looks.
constexpr double kLooksAlong = 0.9;

struct Polygon {
  std::vector<std::uint32_t> triangles, corners;
  Vec3 normal = Vec3::Zero();
  double area2 = 0.0;
  std::set<std::size_t> beside;
};

Vec3 area_of(const TriangleMesh& mesh, std::uint32_t t) {
  return (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
}

using Edges = std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>>;

Edges edges_of(const TriangleMesh& mesh) {
  Edges edges;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      edges[std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3])].push_back(t);
  return edges;
}

// Triangles of one plane that hang together, by joining neighbours until nothing changes.
std::vector<Polygon> polygons_of(const TriangleMesh& mesh) {
  const Edges edges = edges_of(mesh);
  std::vector<std::uint32_t> of(mesh.triangles.size());
  for (std::uint32_t t = 0; t < of.size(); ++t) of[t] = t;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [edge, sides] : edges) {
      const std::uint32_t a = sides[0], b = sides[1];
      if (of[a] == of[b]) continue;
      if (area_of(mesh, a).normalized().dot(area_of(mesh, b).normalized()) < 1.0 - 1e-11) continue;
      of[a] = of[b] = std::min(of[a], of[b]);
      changed = true;
    }
  }
  std::map<std::uint32_t, std::size_t> index;
  std::vector<Polygon> polygons;
  for (std::uint32_t t = 0; t < of.size(); ++t) {
    const auto [at, fresh] = index.try_emplace(of[t], polygons.size());
    if (fresh) polygons.emplace_back();
    Polygon& p = polygons[at->second];
    p.triangles.push_back(t);
    p.normal += area_of(mesh, t);
    for (const std::uint32_t i : mesh.triangles[t]) p.corners.push_back(i);
  }
  for (Polygon& p : polygons) {
    p.area2 = p.normal.norm();
    p.normal /= p.area2;
    std::sort(p.corners.begin(), p.corners.end());
    p.corners.erase(std::unique(p.corners.begin(), p.corners.end()), p.corners.end());
  }
  for (const auto& [edge, sides] : edges) {
    const std::size_t a = index.at(of[sides[0]]), b = index.at(of[sides[1]]);
    if (a == b) continue;
    polygons[a].beside.insert(b);
    polygons[b].beside.insert(a);
  }
  return polygons;
}

using Three = std::array<const Polygon*, 3>;

std::vector<Vec3> corners_of(const TriangleMesh& mesh, const Three& three) {
  std::set<std::uint32_t> ids;
  for (const Polygon* p : three) ids.insert(p->corners.begin(), p->corners.end());
  std::vector<Vec3> corners;
  for (const std::uint32_t i : ids) corners.push_back(mesh.points_mm[i]);
  return corners;
}

// Circle (columns: 2) or sphere (3) through points: |x|^2 = 2 c x + d, least squares.
std::optional<Surface> ball_through(const std::vector<Vec3>& points, const Vec3& axis,
                                    bool cylinder) {
  const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u), origin = points.front();
  const int columns = cylinder ? 3 : 4;
  Eigen::MatrixXd a(points.size(), columns);
  Eigen::VectorXd b(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 d = points[i] - origin;
    const Vec3 x(d.dot(u), d.dot(v), cylinder ? 0.0 : d.dot(axis));
    const auto row = static_cast<Eigen::Index>(i);
    a(row, 0) = 2.0 * x.x();
    a(row, 1) = 2.0 * x.y();
    if (!cylinder) a(row, 2) = 2.0 * x.z();
    a(row, columns - 1) = 1.0;
    b[row] = x.squaredNorm();
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
  if (qr.rank() < columns) return std::nullopt;
  const Eigen::VectorXd s = qr.solve(b);
  const Vec3 middle = origin + s[0] * u + s[1] * v + (cylinder ? 0.0 : s[2]) * axis;
  Surface out;
  out.kind = cylinder ? SurfaceKind::kCylinder : SurfaceKind::kSphere;
  out.point = middle;
  out.axis = axis;
  const double r2 = s[columns - 1] + s.head(columns - 1).squaredNorm();
  if (!(r2 > 0.0)) return std::nullopt;
  out.radius_mm = std::sqrt(r2);
  return out;
}

// The planes of three facets meet in the apex; their normals are inclined alike to the axis.
std::optional<Surface> cone_of(const TriangleMesh& mesh, const Three& three,
                               const std::vector<Vec3>& points) {
  Mat3 rows;
  Vec3 rhs;
  for (int k = 0; k < 3; ++k) {
    rows.row(k) = three[k]->normal.transpose();
    rhs[k] = three[k]->normal.dot(mesh.points_mm[three[k]->corners.front()] - points.front());
  }
  const Eigen::ColPivHouseholderQR<Mat3> qr(rows);
  const Vec3 n = (three[1]->normal - three[0]->normal).cross(three[2]->normal - three[0]->normal);
  if (qr.rank() < 3 || n.norm() < 1e-9) return std::nullopt;
  Surface s;
  s.kind = SurfaceKind::kCone;
  s.point = points.front() + qr.solve(rhs);
  s.axis = n.normalized();
  if ((points.front() - s.point).dot(s.axis) < 0.0) s.axis = -s.axis;
  double angle = 0.0;
  for (const Vec3& x : points) {
    const Vec3 d = x - s.point;
    angle += std::atan2(d.cross(s.axis).norm(), d.dot(s.axis)) / static_cast<double>(points.size());
  }
  s.half_angle_rad = angle;
  if (!(angle > 1e-3 && angle < 1.569)) return std::nullopt;
  return s;
}

std::optional<Surface> surface_of(const TriangleMesh& mesh, const Three& three, SurfaceKind kind) {
  const std::vector<Vec3> points = corners_of(mesh, three);
  if (points.size() < 6) return std::nullopt;
  if (kind == SurfaceKind::kCone) return cone_of(mesh, three, points);
  if (kind == SurfaceKind::kSphere) return ball_through(points, Vec3::UnitZ(), false);
  const Vec3 axis = three[0]->normal.cross(three[1]->normal);
  if (axis.norm() < 1e-6) return std::nullopt;
  return ball_through(points, axis.normalized(), true);
}

bool lies_on(const TriangleMesh& mesh, const Polygon& p, const Surface& s, double size) {
  Vec3 middle = Vec3::Zero();
  for (const std::uint32_t i : p.corners) {
    if (!(std::fabs(s.signed_distance_mm(mesh.points_mm[i])) <= kOn * size)) return false;
    middle += mesh.points_mm[i] / static_cast<double>(p.corners.size());
  }
  return std::fabs(p.normal.dot(s.outward_normal(middle))) > kLooksAlong;
}

struct Candidate {
  Surface surface;
  std::set<std::size_t> polygons;
  std::size_t triangles = 0;
};

std::optional<Candidate> grown(const TriangleMesh& mesh, const std::vector<Polygon>& polygons,
                               std::array<std::size_t, 3> seed, SurfaceKind kind) {
  const Three three{&polygons[seed[0]], &polygons[seed[1]], &polygons[seed[2]]};
  const auto surface = surface_of(mesh, three, kind);
  if (!surface) return std::nullopt;
  double size = surface->radius_mm;
  if (kind == SurfaceKind::kCone)
    for (const Vec3& x : corners_of(mesh, three))
      size = std::max(size, (x - surface->point).cross(surface->axis).norm());
  Candidate c{*surface, {}, 0};
  for (const std::size_t i : seed)
    if (!lies_on(mesh, polygons[i], c.surface, size)) return std::nullopt;
  c.surface.inward = three[0]->normal.dot(
                         c.surface.outward_normal(mesh.points_mm[three[0]->corners.front()])) < 0.0;
  std::vector<std::size_t> open(seed.begin(), seed.end());
  c.polygons.insert(seed.begin(), seed.end());
  while (!open.empty()) {
    const std::size_t p = open.back();
    open.pop_back();
    for (const std::size_t next : polygons[p].beside)
      if (!c.polygons.contains(next) && lies_on(mesh, polygons[next], c.surface, size)) {
        c.polygons.insert(next);
        open.push_back(next);
      }
  }
  for (const std::size_t p : c.polygons) c.triangles += polygons[p].triangles.size();
  return c;
}

TwinSurface plane_of(const TriangleMesh& mesh, const Polygon& p) {
  TwinSurface out;
  out.surface.kind = SurfaceKind::kPlane;
  out.surface.axis = p.normal;
  out.surface.point = mesh.points_mm[p.corners.front()];
  out.triangles = p.triangles;
  return out;
}

}  // namespace

std::vector<TwinSurface> surfaces_by_brute_force(const TriangleMesh& mesh) {
  const std::vector<Polygon> polygons = polygons_of(mesh);
  std::vector<Candidate> candidates;
  const auto bends = [&](std::size_t a, std::size_t b) {
    return polygons[a].normal.dot(polygons[b].normal) > kTurnCosine;
  };
  for (const SurfaceKind kind : {SurfaceKind::kCylinder, SurfaceKind::kCone, SurfaceKind::kSphere})
    for (std::size_t i = 0; i < polygons.size(); ++i)
      for (const std::size_t a : polygons[i].beside)
        for (const std::size_t b : polygons[i].beside)
          if (a < b && bends(i, a) && bends(i, b))
            if (auto c = grown(mesh, polygons, {i, a, b}, kind)) candidates.push_back(*c);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.triangles > b.triangles; });
  std::vector<bool> taken(polygons.size(), false);
  std::vector<TwinSurface> found;
  for (const Candidate& c : candidates) {
    if (std::any_of(c.polygons.begin(), c.polygons.end(), [&](std::size_t p) { return taken[p]; }))
      continue;
    TwinSurface out{c.surface, {}};
    for (const std::size_t p : c.polygons) {
      taken[p] = true;
      out.triangles.insert(out.triangles.end(), polygons[p].triangles.begin(),
                           polygons[p].triangles.end());
    }
    std::sort(out.triangles.begin(), out.triangles.end());
    found.push_back(std::move(out));
  }
  for (std::size_t p = 0; p < polygons.size(); ++p)
    if (!taken[p]) found.push_back(plane_of(mesh, polygons[p]));
  return found;
}

}  // namespace mortise::test
