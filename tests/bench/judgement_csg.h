#pragma once
#include <array>
#include <string>
#include <vector>

#include "tests/bench/judgement_oracle.h"
#include "tests/bench/judgement_parts.h"

/// Parts as unions and differences of prisms, cones, cylinders, balls and tori, with an exact
/// membership function of their sharp offset bodies, and meshes of them made here.
namespace mortise::bench {

enum class CsgLayer { kLeast = 0, kModelled, kLargest };

/// A true face: material where height_mm(x) <= offset. Part frame; the axis is along z.
struct CsgFace {
  enum class Kind {
    kPlane,     ///< n · x <= c
    kMeridian,  ///< a round about the axis: across rho + up z <= c; cylinder or cone
    kBall,      ///< about (axis, z): |x - centre| <= radius
    kTorus,     ///< centre circle of radius `ring` at height z
  };
  Kind kind = Kind::kPlane;
  Vec3 n = Vec3::UnitZ();
  double c = 0.0;
  double axis_x = 0.0, axis_y = 0.0;
  double across = 1.0, up = 0.0;
  double radius = 0.0, ring = 0.0, z = 0.0;
  bool hollow = false;  ///< ball, torus: the material is outside
  Interval offset_mm;
  bool cut = false;  ///< no face of the part but a cut inside of it, always where it is
  std::string name;

  /// Distance outwards of the material, 1-Lipschitz, and its gradient.
  double height_mm(const Vec3& x) const;
  Vec3 gradient(const Vec3& x) const;
  double offset(CsgLayer layer) const;
  Surface surface() const;  ///< as the scenario would declare it
};

/// A union of cells, a cell the intersection of the materials of its faces.
struct CsgPart {
  std::vector<CsgFace> faces;
  std::vector<std::vector<std::uint32_t>> cells;
  TriangleMesh mesh;
  std::vector<std::uint32_t> face_of_triangle;
  double size_mm = 0.0;
  std::string text;

  std::uint32_t add(CsgFace face, const std::string& name);
  /// Depth of a point, facewise: > 0 exactly inside the body of a layer, <= 0 outside; never more
  /// than its distance from the surface.
  double depth_mm(const Vec3& x, CsgLayer layer) const;
  double depth_in_cell_mm(std::size_t cell, const Vec3& x, CsgLayer layer) const;
};

/// Both parts at a pose, in the frame of B.
struct CsgPair {
  const CsgPart* a = nullptr;
  const CsgPart* b = nullptr;
  Pose X_BA;

  /// Lesser depth of a point in both.
  double depth_mm(const Vec3& x_B, CsgLayer layer) const;
};

/// The point that lies deepest in both bodies, as far as the search finds it: twice its lesser
/// depth is a lower bound of the margin, which is verified at the point, and mostly its value.
/// Starts are corners of the meshes and points between; from each of the best, sequential linear
/// programs.
struct CsgPoint {
  Vec3 x_B = Vec3::Zero();
  double depth_mm = -1e300;
};
CsgPoint deepest_point(const CsgPair& pair, CsgLayer layer, int starts);

/// Makes meshes whose triangles know their face.
class CsgMesher {
 public:
  explicit CsgMesher(CsgPart& part) : part_(part) {}
  struct Corner {
    double r_mm, z_mm;
    std::uint32_t face;  ///< of the piece that ends here
  };
  struct Round {
    double x_mm = 0.0, y_mm = 0.0;
    int facets = 24;
    double phase_rad = 0.0;
  };
  using Ring = std::vector<std::uint32_t>;  ///< one point: on the axis

  std::uint32_t point(const Vec3& x);
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t face);
  Ring ring(const Round& round, double r_mm, double z_mm);
  /// Material on the left of the way from one ring to the next in the (r, z) half plane.
  void between(const Ring& from, const Ring& to, std::uint32_t face);
  /// A chain of corners from a ring on; returns the last ring.
  Ring chain(const Round& round, Ring from, const std::vector<Corner>& corners);
  /// A plane face of a convex outline (counter-clockwise from +z) around a ring inside it, or
  /// whole. down: seen from -z.
  void cap(const std::vector<std::uint32_t>& outline, const Round& round, const Ring* hole,
           bool down, std::uint32_t face);

 private:
  CsgPart& part_;
};

/// A part as it comes to the engine: every face declared with its statement, or recognized.
Part csg_known_part(std::uint32_t id, const CsgPart& part, bool recognized);

}  // namespace mortise::bench
