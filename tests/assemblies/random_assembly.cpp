#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepFilletAPI_MakeChamfer.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <GeomAPI_PointsToBSpline.hxx>
#include <Geom_BSplineCurve.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopoDS.hxx>
#include <gp_Elips.hxx>
#include <random>

#include "tests/assemblies/made_assemblies.h"
#include "tests/assemblies/made_shapes.h"
#include "tests/assemblies/product_tree.h"

namespace mortise::test {
namespace {

struct Two {
  TopoDS_Shape host, mate;
};

// Pairs of every kind of surface: a hole in a block, and what stands in it. Lengths in mm.
class Maker {
 public:
  explicit Maker(unsigned seed) : random_(seed) {}

  double between(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random_);
  }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  gp_Trsf turn(double x, double y, double z) {
    return turned(between(-1, 1), between(-1, 1), between(-1, 1), between(0, 360), x, y, z);
  }

  Two pair() {
    switch (below(7)) {
      case 0:
        return plug();
      case 1:
        return cone();
      case 2:
        return ball();
      case 3:
        return ring();
      case 4:
        return stacked();
      case 5:
        return ellipse();
      default:
        return freeform();
    }
  }

 private:
  // How much the one is too large: mostly nothing, as in drawings of nominal sizes.
  double excess() {
    static constexpr double kOf[] = {0.0, 0.0, -0.2, -0.01, 0.05, 0.1, 0.4};
    return kOf[below(7)];
  }
  TopoDS_Shape rounded(const TopoDS_Shape& shape) {
    const int how = below(3);
    if (how == 0) return shape;
    const double size = between(0.2, 0.8);
    BRepFilletAPI_MakeFillet fillet(shape);
    BRepFilletAPI_MakeChamfer chamfer(shape);
    const int only = below(4);  // every edge, or one of them
    int number = 0;
    for (TopExp_Explorer x(shape, TopAbs_EDGE); x.More(); x.Next(), ++number) {
      if (only != 0 && number != only) continue;
      if (how == 1) fillet.Add(size, TopoDS::Edge(x.Current()));
      if (how == 2) chamfer.Add(size, TopoDS::Edge(x.Current()));
    }
    try {
      return solid_of(how == 1 ? fillet.Shape() : chamfer.Shape());
    } catch (const Standard_Failure&) {
      return shape;
    }
  }
  TopoDS_Shape host() { return block(-20, -20, -20, 40, 40, 20); }

  Two plug() {
    const double d = between(4, 16), deep = between(6, 14);
    const bool through = below(2) == 0;
    return {cut(host(), rod(0, 0, through ? -20 : -deep, d, 20)),
            rounded(rod(0, 0, -deep - (through ? 0.0 : excess()), d + excess(), deep + 8))};
  }
  Two cone() {
    const double r = between(4, 9), tip = between(0, 0.8) * r, deep = between(4, 12);
    const auto of = [&](double more) {
      return solid_of(
          BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0, 0, -deep - more), gp_Dir(0, 0, 1)), tip, r, deep)
              .Shape());
    };
    return {cut(host(), of(0.0)), of(excess())};
  }
  Two ball() {
    const double r = between(3, 9), up = between(-0.3, 0.8) * r;
    return {cut(host(), BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, up), r).Shape()),
            BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, up), r + excess()).Shape()};
  }
  Two ring() {
    const double r = between(8, 12), tube = between(1, 3);
    return {cut(host(), BRepPrimAPI_MakeTorus(r, tube).Shape()),
            BRepPrimAPI_MakeTorus(r, tube + excess()).Shape()};
  }
  Two stacked() {
    const double up = -excess();
    return {rounded(host()), rounded(block(between(-25, 0), between(-25, 0), up, between(5, 25),
                                           between(5, 25), between(3, 9)))};
  }
  Two ellipse() {
    const double a = between(5, 12), b = between(0.4, 0.9) * a;
    const auto of = [&](double more, double z, double height) {
      const gp_Elips curve(gp_Ax2(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)), a + more, b + more);
      return solid_of(
          BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(
                                    BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(curve)).Wire())
                                    .Face(),
                                gp_Vec(0, 0, height))
              .Shape());
    };
    return {cut(host(), of(0.0, -12, 12)), of(0.5 * excess(), -12, 20)};
  }
  // A turned part with a free curve as its outline, in its own impression.
  Two freeform() {
    TColgp_Array1OfPnt points(1, 6);
    const double more = excess(), middle = between(4, 9);
    TColgp_Array1OfPnt larger(1, 6);
    for (int i = 1; i <= 6; ++i) {
      const double r = middle + between(-1, 1), z = -14 + 4.0 * (i - 1);
      points(i) = gp_Pnt(r, 0, z);
      larger(i) = gp_Pnt(r + more, 0, z);
    }
    const auto of = [](const TColgp_Array1OfPnt& p) {
      const Handle(Geom_BSplineCurve) curve = GeomAPI_PointsToBSpline(p).Curve();
      BRepBuilderAPI_MakeWire wire(BRepBuilderAPI_MakeEdge(curve).Edge());
      const gp_Pnt low(0, 0, p(1).Z()), high(0, 0, p(6).Z());
      wire.Add(BRepBuilderAPI_MakeEdge(p(6), high).Edge());
      wire.Add(BRepBuilderAPI_MakeEdge(high, low).Edge());
      wire.Add(BRepBuilderAPI_MakeEdge(low, p(1)).Edge());
      return solid_of(BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(wire.Wire()).Face(),
                                            gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)))
                          .Shape());
    };
    return {cut(host(), of(points)), of(larger)};
  }

  std::mt19937 random_;
};

}  // namespace

bool write_random(const std::string& file, int seed) {
  Maker make(static_cast<unsigned>(seed));
  ProductTree tree;
  const TDF_Label all = tree.assembly("random");
  constexpr int kPairs = 6;
  for (int i = 0; i < kPairs; ++i) {
    Two two;
    try {
      two = make.pair();
    } catch (const Standard_Failure&) {  // that the library cannot make
      continue;
    }
    const std::string number = std::to_string(i + 1);
    const gp_Trsf at = make.turn(120.0 * i, 0, 0);
    tree.place(all, tree.part("host_" + number, two.host, 0x888888), "host_" + number, at);
    tree.place(all, tree.part("mate_" + number, two.mate, 0x4444aa), "mate_" + number, at);
  }
  return tree.write(file);
}

}  // namespace mortise::test
