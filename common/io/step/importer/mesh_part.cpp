#include "common/io/step/importer/mesh_part.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <map>

#include "common/base/union_find.h"
#include "common/io/step/importer/freeform_mesh.h"
#include "common/io/step/importer/known_surface.h"

namespace mortise {
namespace {

void tessellate(const TopoDS_Shape& shape, const MeshOptions& options) {
  IMeshTools_Parameters parameters;
  parameters.Deflection = options.chord_mm;
  parameters.Angle = options.angle_rad;
  parameters.InParallel = false;
  parameters.InternalVerticesMode = true;
  parameters.ControlSurfaceDeflection = true;
  BRepMesh_IncrementalMesh mesher;
  mesher.SetShape(shape);
  mesher.ChangeParameters() = parameters;
  mesher.Perform();
}

// Joins the nodes of one solid's faces along its edges and at its vertices: the k-th node of an
// edge is the same in every face that has it. Joining by place would join edges that touch.
class SolidMesher {
 public:
  SolidMesher(const TopoDS_Shape& solid, const MeshOptions& options, StepPart& part)
      : options_(options), part_(part) {
    for (TopExp_Explorer x(solid, TopAbs_FACE); x.More(); x.Next())
      faces_.push_back(TopoDS::Face(x.Current()));
  }

  void run() {
    // 1. a class for every node of every face
    TopTools_IndexedMapOfShape distinct;
    for (const TopoDS_Face& face : faces_) {
      if (distinct.Contains(face)) continue;
      distinct.Add(face);
      add_nodes(face);
      first_node_.push_back(static_cast<std::uint32_t>(places_.size()));
    }
    first_node_.insert(first_node_.begin(), 0);
    // 2. joined along edges and at vertices
    for (int i = 1; i <= distinct.Extent(); ++i)
      join_edges(TopoDS::Face(distinct(i)), first_node_[static_cast<std::size_t>(i - 1)]);
    // 3. triangles, turned outward
    point_of_.assign(places_.size(), kNone);
    for (const TopoDS_Face& face : faces_) {
      const auto index = static_cast<std::size_t>(distinct.FindIndex(face) - 1);
      add_face(face, first_node_[index]);
    }
  }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  void add_nodes(const TopoDS_Face& face) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull()) return;
    for (int k = 1; k <= mesh->NbNodes(); ++k) {
      const gp_Pnt p = mesh->Node(k).Transformed(location.Transformation());
      places_.push_back({p.X(), p.Y(), p.Z()});
      classes_.add();
    }
  }

  std::uint32_t class_of(const TopoDS_Vertex& vertex, std::uint32_t node) {
    const int index = vertices_.Add(vertex);
    if (static_cast<std::size_t>(index) > node_of_vertex_.size()) node_of_vertex_.push_back(node);
    return node_of_vertex_[static_cast<std::size_t>(index - 1)];
  }

  void join_edges(const TopoDS_Face& face, std::uint32_t first) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull()) return;
    // Walked as FORWARD: a seam comes twice, once in each orientation, with nodes of its own.
    const TopoDS_Shape forward = face.Oriented(TopAbs_FORWARD);
    for (TopExp_Explorer x(forward, TopAbs_EDGE); x.More(); x.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(x.Current());
      const Handle(Poly_PolygonOnTriangulation) polygon =
          BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
      if (polygon.IsNull() || polygon->NbNodes() < 1) continue;
      std::vector<std::uint32_t> nodes;
      for (int k = 1; k <= polygon->NbNodes(); ++k)
        nodes.push_back(first + static_cast<std::uint32_t>(polygon->Node(k) - 1));
      join_edge(edge, nodes);
    }
  }

  void join_edge(const TopoDS_Edge& edge, const std::vector<std::uint32_t>& nodes) {
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    const TopoDS_Vertex begin = TopExp::FirstVertex(forward), end = TopExp::LastVertex(forward);
    if (!begin.IsNull()) classes_.join(nodes.front(), class_of(begin, nodes.front()));
    if (!end.IsNull()) classes_.join(nodes.back(), class_of(end, nodes.back()));
    if (BRep_Tool::Degenerated(edge)) {
      for (const std::uint32_t node : nodes) classes_.join(node, nodes.front());
      return;
    }
    const auto index = static_cast<std::size_t>(edges_.Add(edge));
    if (index > nodes_of_edge_.size()) {
      nodes_of_edge_.push_back(nodes);
      return;
    }
    const std::vector<std::uint32_t>& known = nodes_of_edge_[index - 1];
    for (std::size_t k = 0; k < std::min(known.size(), nodes.size()); ++k)
      classes_.join(nodes[k], known[k]);
  }

  std::uint32_t point_of(std::uint32_t node) {
    const std::uint32_t root = classes_.leader_of(node);
    if (point_of_[root] == kNone) {
      point_of_[root] = static_cast<std::uint32_t>(part_.mesh.points_mm.size());
      part_.mesh.points_mm.push_back(places_[root]);
    }
    return point_of_[root];
  }

  void add_face(const TopoDS_Face& face, std::uint32_t first) {
    const auto number = static_cast<std::uint32_t>(part_.faces.size());
    part_.faces.emplace_back();
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull() || mesh->NbTriangles() == 0) {
      ++part_.untriangulated;
      return;
    }
    FreeformMesh local;
    std::vector<std::uint32_t> point;  // of the part, by local corner
    for (int k = 1; k <= mesh->NbNodes(); ++k) {
      point.push_back(point_of(first + static_cast<std::uint32_t>(k - 1)));
      local.points.push_back(part_.mesh.points_mm[point.back()]);
      if (mesh->HasUVNodes()) local.uv.push_back({mesh->UVNode(k).X(), mesh->UVNode(k).Y()});
    }
    for (int k = 1; k <= mesh->NbTriangles(); ++k) {
      int a, b, c;
      mesh->Triangle(k).Get(a, b, c);
      if (face.Orientation() == TopAbs_REVERSED) std::swap(b, c);
      const std::array<std::uint32_t, 3> corners{static_cast<std::uint32_t>(a - 1),
                                                 static_cast<std::uint32_t>(b - 1),
                                                 static_cast<std::uint32_t>(c - 1)};
      const auto at = [&](int i) { return point[corners[static_cast<std::size_t>(i)]]; };
      if (at(0) != at(1) && at(1) != at(2) && at(2) != at(0)) local.triangles.push_back(corners);
    }
    part_.faces[number] = known_face(face, local);
    for (std::size_t k = point.size(); k < local.points.size(); ++k) {
      point.push_back(static_cast<std::uint32_t>(part_.mesh.points_mm.size()));
      part_.mesh.points_mm.push_back(local.points[k]);
    }
    for (const auto& t : local.triangles) {
      part_.mesh.triangles.push_back({point[t[0]], point[t[1]], point[t[2]]});
      part_.face_of_triangle.push_back(number);
    }
  }

  StepFace known_face(const TopoDS_Face& face, FreeformMesh& local) const {
    StepFace known;
    const BRepAdaptor_Surface adaptor(face);
    std::vector<bool> used(local.points.size(), false);
    for (const auto& t : local.triangles)
      for (const std::uint32_t corner : t) used[corner] = true;
    std::vector<Vec3> corners;
    for (std::size_t i = 0; i < used.size(); ++i)
      if (used[i]) corners.push_back(local.points[i]);
    double gap_mm = 0.0;
    if (const auto stated = stated_surface(adaptor, face, corners)) {
      known.surface = *stated;
      known.grade = StepFaceGrade::kExact;
    } else if (const auto recognized = recognized_surface(adaptor, face)) {
      known.surface = recognized->surface;
      known.grade = StepFaceGrade::kRecognized;
      gap_mm = recognized->gap_mm;
    } else {
      const FreeformDeviation measured = refine_freeform(adaptor, face, options_.chord_mm, local);
      known.grade = measured.known ? StepFaceGrade::kMeasured : StepFaceGrade::kUnknown;
      known.deviation_mm = measured.outward_mm;
      return known;
    }
    for (const Vec3& x : corners)
      known.residual_mm =
          std::max(known.residual_mm, gap_mm + std::fabs(known.surface.signed_distance_mm(x)));
    return known;
  }

  const MeshOptions& options_;
  StepPart& part_;
  std::vector<TopoDS_Face> faces_;
  std::vector<std::uint32_t> first_node_;
  std::vector<Vec3> places_;
  UnionFind classes_;
  TopTools_IndexedMapOfShape vertices_, edges_;
  std::vector<std::uint32_t> node_of_vertex_, point_of_;
  std::vector<std::vector<std::uint32_t>> nodes_of_edge_;
};

// Edges that are not used once in each direction.
std::uint32_t open_edges_of(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  return static_cast<std::uint32_t>(
      std::count_if(balance.begin(), balance.end(), [](auto& edge) { return edge.second != 0; }));
}

}  // namespace

std::vector<TopoDS_Shape> faces_of(const TopoDS_Shape& solids) {
  std::vector<TopoDS_Shape> faces;
  for (TopExp_Explorer s(solids, TopAbs_SOLID); s.More(); s.Next())
    for (TopExp_Explorer x(s.Current(), TopAbs_FACE); x.More(); x.Next())
      faces.push_back(x.Current());
  return faces;
}

StepPart mesh_part(const TopoDS_Shape& solids, const MeshOptions& options) {
  StepPart part;
  tessellate(solids, options);
  for (TopExp_Explorer s(solids, TopAbs_SOLID); s.More(); s.Next()) {
    ++part.solids;
    SolidMesher(s.Current(), options, part).run();
    GProp_GProps properties;
    // Without an accuracy the integration is 4 % off on some files.
    BRepGProp::VolumeProperties(s.Current(), properties, 1e-5);
    part.volume_mm3 += properties.Mass();
  }
  part.open_edges = open_edges_of(part.mesh);
  return part;
}

}  // namespace mortise
