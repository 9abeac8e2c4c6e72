#include "common/io/step/importer/known_surface.h"

#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Dense>
#include <GeomLProp_SLProps.hxx>
#include <Geom_Surface.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Cone.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Pln.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>

namespace mortise {
namespace {

Vec3 vec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }
Vec3 vec(const gp_Dir& d) { return {d.X(), d.Y(), d.Z()}; }

// A cone by apex, axis from apex to its wide side and half angle. The file gives a circle of radius
// R and the angle at which it grows; the face may lie on the far side of the apex.
Surface cone_of(const gp_Cone& cone, const std::vector<Vec3>& corners) {
  Surface s;
  s.kind = SurfaceKind::kCone;
  s.axis = vec(cone.Axis().Direction());
  const double angle = cone.SemiAngle();
  s.point = vec(cone.Location()) - cone.RefRadius() / std::tan(angle) * s.axis;
  if (angle < 0.0) s.axis = -s.axis;
  s.half_angle_rad = std::fabs(angle);
  double along = 0.0;
  for (const Vec3& x : corners) along += (x - s.point).dot(s.axis);
  if (along < 0.0) s.axis = -s.axis;
  return s;
}

}  // namespace

std::optional<Surface> stated_surface(const BRepAdaptor_Surface& adaptor, const TopoDS_Face& face,
                                      const std::vector<Vec3>& corners) {
  const bool reversed = face.Orientation() == TopAbs_REVERSED;
  bool direct = true;
  Surface s;
  switch (adaptor.GetType()) {
    case GeomAbs_Plane: {
      const gp_Pln plane = adaptor.Plane();
      s.kind = SurfaceKind::kPlane;
      s.point = vec(plane.Location());
      s.axis = vec(plane.Axis().Direction());
      if (reversed == (plane.Direct() != 0)) s.axis = -s.axis;
      return s;
    }
    case GeomAbs_Cylinder: {
      const gp_Cylinder cylinder = adaptor.Cylinder();
      s.kind = SurfaceKind::kCylinder;
      s.point = vec(cylinder.Location());
      s.axis = vec(cylinder.Axis().Direction());
      s.radius_mm = cylinder.Radius();
      direct = cylinder.Direct() != 0;
      break;
    }
    case GeomAbs_Cone: {
      const gp_Cone cone = adaptor.Cone();
      s = cone_of(cone, corners);
      direct = cone.Direct() != 0;
      // On the far nappe the normal of the parametrization points to the axis.
      double radius = 0.0;  // of all corners
      for (const Vec3& x : corners)
        radius += cone.RefRadius() + (x - vec(cone.Location())).dot(vec(cone.Axis().Direction())) *
                                         std::tan(cone.SemiAngle());
      direct = direct != (radius < 0.0);
      break;
    }
    case GeomAbs_Sphere: {
      const gp_Sphere sphere = adaptor.Sphere();
      s = {.kind = SurfaceKind::kSphere, .point = vec(sphere.Location())};
      s.axis = vec(sphere.Position().Direction());
      s.radius_mm = sphere.Radius();
      direct = sphere.Direct() != 0;
      break;
    }
    case GeomAbs_Torus: {
      const gp_Torus torus = adaptor.Torus();
      if (torus.MajorRadius() <= torus.MinorRadius()) return {};
      s.kind = SurfaceKind::kTorus;
      s.point = vec(torus.Location());
      s.axis = vec(torus.Axis().Direction());
      s.radius_mm = torus.MajorRadius();
      s.tube_radius_mm = torus.MinorRadius();
      direct = torus.Direct() != 0;
      break;
    }
    default:
      return std::nullopt;
  }
  s.inward = reversed == direct;
  return s;
}

namespace {

// Points with outward unit normals of a face, on a grid over its bounds of parameters.
struct Samples {
  std::vector<Vec3> points, normals;
};

Samples samples_of(const BRepAdaptor_Surface& adaptor, const TopoDS_Face& face, int per_side) {
  double u0, u1, v0, v1;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  Samples samples;
  for (int i = 0; i < per_side; ++i)
    for (int j = 0; j < per_side; ++j) {
      gp_Pnt p;
      gp_Vec du, dv;
      adaptor.D1(u0 + (u1 - u0) * (i + 0.5) / per_side, v0 + (v1 - v0) * (j + 0.5) / per_side, p,
                 du, dv);
      gp_Vec normal = du ^ dv;
      // A pole: it has no normal.
      if (normal.Magnitude() < 1e-14) continue;
      normal.Normalize();
      if (face.Orientation() == TopAbs_REVERSED) normal.Reverse();
      samples.points.push_back(vec(p));
      samples.normals.push_back({normal.X(), normal.Y(), normal.Z()});
    }
  return samples;
}

class Fitter {
 public:
  Fitter(Samples coarse, Samples fine) : coarse_(std::move(coarse)), fine_(std::move(fine)) {
    middle_ = Vec3::Zero();
    for (const Vec3& p : coarse_.points) middle_ += p / static_cast<double>(size());
    mean_normal_ = Vec3::Zero();
    for (const Vec3& n : coarse_.normals) mean_normal_ += n / static_cast<double>(size());
    double extent = 0.0;
    for (const Vec3& p : coarse_.points) extent = std::max(extent, (p - middle_).norm());
    allowed_mm_ = std::max(1e-6, 1e-5 * extent);
  }

  std::optional<RecognizedSurface> run(double curvature_a, double curvature_b) {
    for (const auto& found :
         {plane(), cylinder(), sphere(), cone(), torus(curvature_a), torus(curvature_b)})
      if (found) return found;
    return std::nullopt;
  }

 private:
  std::size_t size() const { return coarse_.points.size(); }

  std::optional<RecognizedSurface> accept(const Surface& s) const {
    // Beyond a hundred metres a face is as flat as its own rounding.
    if (!s.point.allFinite() || !(s.radius_mm < 1e5)) return std::nullopt;
    RecognizedSurface found{s, 0.0};
    for (std::size_t i = 0; i < fine_.points.size(); ++i) {
      found.gap_mm = std::max(found.gap_mm, std::fabs(s.signed_distance_mm(fine_.points[i])));
      if (!(s.outward_normal(fine_.points[i]).dot(fine_.normals[i]) > 0.99)) return std::nullopt;
    }
    if (found.gap_mm > allowed_mm_) return std::nullopt;
    return found;
  }

  std::optional<RecognizedSurface> plane() const {
    // Normals within some 1.4 mrad of each other: accept() measures the rest.
    if (mean_normal_.norm() < 0.999999) return std::nullopt;
    Surface s;
    s.kind = SurfaceKind::kPlane;
    s.point = middle_;
    s.axis = mean_normal_.normalized();
    return accept(s);
  }

  // All normals are across one axis; the points stand off it by r along them.
  std::optional<RecognizedSurface> cylinder() const {
    Mat3 spread = Mat3::Zero();
    for (const Vec3& n : coarse_.normals) spread += n * n.transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(spread);
    if (solver.eigenvalues()[0] > 1e-8 * static_cast<double>(size())) return std::nullopt;
    const Vec3 e1 = solver.eigenvectors().col(1), e2 = solver.eigenvectors().col(2);
    Eigen::MatrixXd A(2 * size(), 3);
    Eigen::VectorXd b(2 * size());
    for (std::size_t i = 0; i < size(); ++i) {
      const auto row = static_cast<Eigen::Index>(2 * i);
      A.row(row) << 1, 0, coarse_.normals[i].dot(e1);
      A.row(row + 1) << 0, 1, coarse_.normals[i].dot(e2);
      b[row] = (coarse_.points[i] - middle_).dot(e1);
      b[row + 1] = (coarse_.points[i] - middle_).dot(e2);
    }
    const Eigen::VectorXd x = A.colPivHouseholderQr().solve(b);
    Surface s;
    s.kind = SurfaceKind::kCylinder;
    s.point = middle_ + e1 * x[0] + e2 * x[1];
    s.axis = solver.eigenvectors().col(0).normalized();
    s.radius_mm = std::fabs(x[2]);
    s.inward = x[2] < 0.0;
    return accept(s);
  }

  std::optional<RecognizedSurface> sphere() const {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * size()), 4);
    Eigen::VectorXd b(3 * size());
    for (std::size_t i = 0; i < size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const auto row = static_cast<Eigen::Index>(3 * i) + k;
        A(row, k) = 1.0;
        A(row, 3) = coarse_.normals[i][k];
        b[row] = coarse_.points[i][k] - middle_[k];
      }
    const Eigen::VectorXd x = A.colPivHouseholderQr().solve(b);
    Surface s;
    s.kind = SurfaceKind::kSphere;
    s.point = middle_ + Vec3(x.head<3>());
    s.radius_mm = std::fabs(x[3]);
    s.inward = x[3] < 0.0;
    return accept(s);
  }

  // All normals have one inclination to the axis, and all tangent planes meet in the apex.
  std::optional<RecognizedSurface> cone() const {
    Mat3 spread = Mat3::Zero();
    for (const Vec3& n : coarse_.normals)
      spread += (n - mean_normal_) * (n - mean_normal_).transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(spread);
    if (solver.eigenvalues()[0] > 1e-8 * static_cast<double>(size())) return std::nullopt;
    Eigen::MatrixXd A(size(), 3);
    Eigen::VectorXd b(size());
    for (std::size_t i = 0; i < size(); ++i) {
      A.row(static_cast<Eigen::Index>(i)) = coarse_.normals[i].transpose();
      b[static_cast<Eigen::Index>(i)] = coarse_.normals[i].dot(coarse_.points[i] - middle_);
    }
    const Vec3 apex = A.colPivHouseholderQr().solve(b);
    Surface s;
    s.kind = SurfaceKind::kCone;
    s.point = middle_ + apex;
    s.axis = solver.eigenvectors().col(0).normalized();
    if ((middle_ - s.point).dot(s.axis) < 0.0) s.axis = -s.axis;
    const double inclined = mean_normal_.dot(s.axis);
    s.inward = inclined > 0.0;
    s.half_angle_rad = std::asin(std::min(1.0, std::fabs(inclined)));
    // A cylinder, which is asked for by itself.
    if (s.half_angle_rad < 1e-4) return std::nullopt;
    return accept(s);
  }

  // With the radius of the tube known, all points along their normals come to lie on one circle.
  std::optional<RecognizedSurface> torus(double curvature) const {
    if (std::fabs(curvature) < 1e-5) return std::nullopt;
    const double tube = 1.0 / curvature;  // positive: the normal points away from the centre circle
    std::vector<Vec3> centres;
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < size(); ++i) {
      centres.push_back(coarse_.points[i] - tube * coarse_.normals[i]);
      mean += centres.back() / static_cast<double>(size());
    }
    Mat3 spread = Mat3::Zero();
    for (const Vec3& c : centres) spread += (c - mean) * (c - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(spread);
    const Vec3 e1 = solver.eigenvectors().col(1), e2 = solver.eigenvectors().col(2);
    Eigen::MatrixXd A(size(), 3);
    Eigen::VectorXd b(size());
    for (std::size_t i = 0; i < size(); ++i) {
      const double x = (centres[i] - mean).dot(e1), y = (centres[i] - mean).dot(e2);
      A.row(static_cast<Eigen::Index>(i)) << 2.0 * x, 2.0 * y, 1.0;
      b[static_cast<Eigen::Index>(i)] = x * x + y * y;
    }
    const Vec3 fit = A.colPivHouseholderQr().solve(b);
    const double square = fit[2] + fit[0] * fit[0] + fit[1] * fit[1];
    if (!(square > 0.0)) return std::nullopt;
    Surface s;
    s.kind = SurfaceKind::kTorus;
    s.point = mean + fit[0] * e1 + fit[1] * e2;
    s.axis = solver.eigenvectors().col(0).normalized();
    s.radius_mm = std::sqrt(square);
    s.tube_radius_mm = std::fabs(tube);
    s.inward = tube < 0.0;
    if (!(s.radius_mm > s.tube_radius_mm)) return std::nullopt;
    return accept(s);
  }

  Samples coarse_, fine_;
  Vec3 middle_, mean_normal_;
  double allowed_mm_ = 0.0;
};

}  // namespace

std::optional<RecognizedSurface> recognized_surface(const BRepAdaptor_Surface& adaptor,
                                                    const TopoDS_Face& face) {
  Samples coarse = samples_of(adaptor, face, 6);
  Samples fine = samples_of(adaptor, face, 17);
  if (coarse.points.size() < 12 || fine.points.size() < 50) return std::nullopt;
  // Principal curvatures in the middle, positive where the outward normal points away from the
  // centre of curvature.
  double u0, u1, v0, v1;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  double curvature_a = 0.0, curvature_b = 0.0;
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  GeomLProp_SLProps local(surface, 0.5 * (u0 + u1), 0.5 * (v0 + v1), 2, 1e-9);
  if (local.IsCurvatureDefined()) {
    const double sign = face.Orientation() == TopAbs_REVERSED ? 1.0 : -1.0;
    curvature_a = sign * local.MaxCurvature();
    curvature_b = sign * local.MinCurvature();
  }
  return Fitter(std::move(coarse), std::move(fine)).run(curvature_a, curvature_b);
}

}  // namespace mortise
