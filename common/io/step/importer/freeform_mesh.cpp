#include "common/io/step/importer/freeform_mesh.h"

#include <algorithm>
#include <cmath>

namespace mortise {
namespace {

constexpr int kSteps = 4;   // samples a side of a triangle
constexpr int kRounds = 6;  // of refinement
// Bounds what refinement adds: triangles of a face, times this.
constexpr std::size_t kMostGrowth = 4;

struct Sample {
  double off_mm = 0.0;  // of the surface, along its outward normal
  double u = 0.0, v = 0.0;
  Vec3 on_surface = Vec3::Zero();
  bool inside = false;  // of the triangle, not on its edges
};

Vec3 vec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }
Vec3 vec(const gp_Vec& v) { return {v.X(), v.Y(), v.Z()}; }

class Measure {
 public:
  Measure(const BRepAdaptor_Surface& adaptor, bool reversed, const FreeformMesh& mesh)
      : adaptor_(adaptor), reversed_(reversed), mesh_(mesh) {}

  // The worst inner sample of a triangle; the hull of all goes to `all`.
  Sample worst(std::size_t triangle, Interval& all) const {
    Sample worst;
    const auto& t = mesh_.triangles[triangle];
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j) {
        const double a = static_cast<double>(i) / kSteps, b = static_cast<double>(j) / kSteps;
        const double c = 1.0 - a - b;
        const Vec3 x = a * mesh_.points[t[0]] + b * mesh_.points[t[1]] + c * mesh_.points[t[2]];
        const auto uv = [&](std::size_t k) {
          return a * mesh_.uv[t[0]][k] + b * mesh_.uv[t[1]][k] + c * mesh_.uv[t[2]][k];
        };
        Sample sample = nearest(x, uv(0), uv(1));
        sample.inside = i > 0 && j > 0 && i + j < kSteps;
        all = hull(all, {sample.off_mm, sample.off_mm});
        if (sample.inside && std::fabs(sample.off_mm) >= std::fabs(worst.off_mm)) worst = sample;
      }
    return worst;
  }

 private:
  Sample nearest(const Vec3& x, double u, double v) const {
    gp_Pnt p;
    gp_Vec du, dv;
    adaptor_.D1(u, v, p, du, dv);
    Sample best{0.0, u, v, vec(p), false};
    Vec3 normal = vec(du).cross(vec(dv));
    double distance = (x - vec(p)).norm();
    // Newton doubles the digits each step: three are enough, and a picometre is rounding.
    for (int step = 0; step < 3 && distance > 1e-9; ++step) {
      const Vec3 w = x - vec(p), a = vec(du), b = vec(dv);
      const double E = a.dot(a), F = a.dot(b), G = b.dot(b), D = E * G - F * F;
      // Both ways along the face are one within rounding: no step.
      if (!(D > 1e-14 * E * G)) break;
      u += (w.dot(a) * G - w.dot(b) * F) / D;
      v += (w.dot(b) * E - w.dot(a) * F) / D;
      adaptor_.D1(u, v, p, du, dv);
      const double now = (x - vec(p)).norm();
      if (!(now < distance)) break;
      distance = now;
      normal = vec(du).cross(vec(dv));
      best = {0.0, u, v, vec(p), false};
    }
    const double outward = (reversed_ ? -1.0 : 1.0) * (best.on_surface - x).dot(normal);
    best.off_mm = outward < 0.0 ? -distance : distance;
    return best;
  }

  const BRepAdaptor_Surface& adaptor_;
  bool reversed_;
  const FreeformMesh& mesh_;
};

Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

// Three triangles in place of one, unless one of them would be turned over or have no area.
bool split(FreeformMesh& mesh, std::size_t triangle, const Sample& at) {
  const auto t = mesh.triangles[triangle];
  const Vec3 whole = area_vector(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 piece = area_vector(mesh.points[t[k]], mesh.points[t[(k + 1) % 3]], at.on_surface);
    // A millionth of the triangle is a sliver: the point lies on its edge.
    if (!(piece.dot(whole) > 1e-6 * whole.squaredNorm())) return false;
  }
  const auto point = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.push_back(at.on_surface);
  mesh.uv.push_back({at.u, at.v});
  mesh.triangles[triangle] = {t[0], t[1], point};
  mesh.triangles.push_back({t[1], t[2], point});
  mesh.triangles.push_back({t[2], t[0], point});
  return true;
}

}  // namespace

FreeformDeviation refine_freeform(const BRepAdaptor_Surface& adaptor, const TopoDS_Face& face,
                                  double target_mm, FreeformMesh& mesh) {
  FreeformDeviation reached;
  if (mesh.uv.size() != mesh.points.size()) return reached;
  const std::size_t most = kMostGrowth * mesh.triangles.size() + 64;
  const Measure measure(adaptor, face.Orientation() == TopAbs_REVERSED, mesh);
  Interval all;
  std::vector<std::size_t> open(mesh.triangles.size());
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = i;
  for (int round = 0; round < kRounds && !open.empty(); ++round) {
    std::vector<std::size_t> next;
    for (const std::size_t i : open) {
      Interval of_triangle;
      const Sample worst = measure.worst(i, of_triangle);
      const bool within = std::fabs(worst.off_mm) * (1.0 + kSamplesMiss) <= target_mm;
      const std::size_t before = mesh.triangles.size();
      if (!within && before < most && round + 1 < kRounds && split(mesh, i, worst)) {
        next.push_back(i);
        next.push_back(before);
        next.push_back(before + 1);
      } else {
        all = hull(all, of_triangle);
      }
    }
    open = std::move(next);
  }
  reached.known = std::isfinite(all.lo) && std::isfinite(all.hi);
  if (reached.known)
    reached.outward_mm = {all.lo * (1.0 + kSamplesMiss), all.hi * (1.0 + kSamplesMiss)};
  return reached;
}

}  // namespace mortise
