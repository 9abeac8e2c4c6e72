#pragma once
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Ax2.hxx>

namespace mortise::test {

/// The only solid of the result of an operation.
inline TopoDS_Shape solid_of(const TopoDS_Shape& shape) {
  return TopExp_Explorer(shape, TopAbs_SOLID).Current();
}

inline TopoDS_Shape block(double x, double y, double z, double dx, double dy, double dz) {
  return BRepPrimAPI_MakeBox(gp_Pnt(x, y, z), dx, dy, dz).Shape();
}

/// Along z unless another direction is said.
inline TopoDS_Shape rod(double x, double y, double z, double diameter, double length,
                        const gp_Dir& along = gp_Dir(0, 0, 1)) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, y, z), along), 0.5 * diameter, length).Shape();
}

inline TopoDS_Shape cut(const TopoDS_Shape& from, const TopoDS_Shape& what) {
  return solid_of(BRepAlgoAPI_Cut(from, what).Shape());
}

inline TopoDS_Shape joined(const TopoDS_Shape& a, const TopoDS_Shape& b) {
  return solid_of(BRepAlgoAPI_Fuse(a, b).Shape());
}

/// A screw with its head above z = 0 and its shank below.
inline TopoDS_Shape screw(double diameter, double length, double head, double height) {
  return joined(rod(0, 0, 0, head, height), rod(0, 0, -length, diameter, length));
}

}  // namespace mortise::test
