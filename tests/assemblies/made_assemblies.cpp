#include "tests/assemblies/made_assemblies.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shell.hxx>

#include "tests/assemblies/made_shapes.h"
#include "tests/assemblies/product_tree.h"

namespace mortise::test {
namespace {

const gp_Dir kUp(0, 0, 1);

TopoDS_Shape tensioner_base() {
  TopoDS_Shape base = block(0, 0, 0, 120, 80, 20);
  for (const double x : {10.0, 110.0})
    for (const double y : {10.0, 70.0}) base = cut(base, rod(x, y, 5, 2.5, 15));  // M3
  base = cut(base, rod(40, 40, 0, 12, 20));                                       // bush
  for (const double x : {60.0, 100.0}) base = cut(base, rod(x, 20, 8, 6, 12));    // dowel
  for (const double x : {60.0, 100.0}) base = cut(base, rod(x, 60, 12, 4.2, 8));  // insert
  return base;
}

TopoDS_Shape tensioner_cover() {
  TopoDS_Shape cover = block(0, 0, 20, 120, 80, 6);
  for (const double x : {10.0, 110.0})
    for (const double y : {10.0, 70.0}) cover = cut(cover, rod(x, y, 20, 3.4, 6));
  cover = cut(cover, rod(40, 40, 20, 16, 6));
  for (const double x : {60.0, 100.0}) cover = cut(cover, rod(x, 20, 20, 6, 6));
  for (const double x : {60.0, 100.0}) cover = cut(cover, rod(x, 60, 20, 5.5, 6));
  return cover;
}

TopoDS_Shape ring(double outer, double inner, double width) {
  return cut(rod(0, 0, 0, outer, width), rod(0, 0, 0, inner, width));
}

}  // namespace

bool write_tensioner(const std::string& file) {
  ProductTree tree;
  const TDF_Label all = tree.assembly("tensioner");
  const TDF_Label base = tree.part("base", tensioner_base(), 0x8899aa);
  const TDF_Label cover = tree.part("cover", tensioner_cover(), 0xaabbcc);
  const TDF_Label bush = tree.part("bush", ring(12.02, 10, 20), 0xcc9944);
  const TDF_Label shaft = tree.part("shaft", rod(0, 0, 0, 10, 60), 0xdddddd);
  const TDF_Label screw_m3 = tree.part("screw_m3", screw(3, 14, 5.5, 3), 0x444444);
  const TDF_Label insert = tree.part("insert", ring(4.6, 2.5, 6), 0xddaa33);
  const TDF_Label dowel = tree.part("dowel", rod(0, 0, 0, 6, 20), 0xdddddd);
  const TDF_Label bracket =
      tree.part("bracket", cut(block(0, 0, 0, 30, 12, 10), rod(15, 6, 0, 4, 10)), 0xcc4444);
  const TDF_Label roller = tree.assembly("roller");
  const TDF_Label wheel = tree.part("wheel", ring(18, 5, 8), 0x336699);
  const TDF_Label axle = tree.part("axle", rod(0, 0, -4, 5, 20), 0xdddddd);
  tree.place(roller, wheel, "wheel", moved(0, 0, 0));
  tree.place(roller, axle, "axle", moved(0, 0, 0));

  tree.place(all, base, "base", moved(0, 0, 0));
  tree.place(all, cover, "cover", moved(0, 0, 0));
  int number = 0;
  for (const double x : {10.0, 110.0})
    for (const double y : {10.0, 70.0})
      tree.place(all, screw_m3, "screw_" + std::to_string(++number), moved(x, y, 26));
  tree.place(all, bush, "bush", moved(40, 40, 0));
  tree.place(all, shaft, "shaft", moved(40, 40, -10));
  tree.place(all, insert, "insert_1", moved(60, 60, 14));
  tree.place(all, insert, "insert_2", moved(100, 60, 14));
  tree.place(all, dowel, "dowel_1", moved(60, 20, 8));
  tree.place(all, dowel, "dowel_2", moved(100, 20, 8));
  // It stands 0.4 mm too low in the cover.
  tree.place(all, bracket, "bracket", moved(70, 34, 25.6));
  for (int i = 0; i < 3; ++i)
    tree.place(all, roller, "roller_" + std::to_string(i + 1), moved(140, 15 + 25 * i, 0));

  tree.state_diameter(bush, 10, 0.0, 0.015);       // H7
  tree.state_diameter(shaft, 10, -0.014, -0.005);  // g6
  tree.state_position(shaft, 10, 0.002);
  return tree.write(file);
}

namespace {

// A drive as it is bought: two halves of a case, a lid, a gear on its pin, a horn, and screws.
TDF_Label drive_of(ProductTree& tree) {
  const TDF_Label drive = tree.assembly("drive");
  TopoDS_Shape lower = cut(block(-20, -12, 0, 40, 24, 18), block(-18, -10, 2, 36, 20, 16));
  TopoDS_Shape upper = cut(block(-20, -12, 18, 40, 24, 12), block(-18, -10, 18, 36, 20, 10));
  for (const double x : {-16.0, 16.0})
    for (const double y : {-8.0, 8.0}) {
      lower = joined(lower, rod(x, y, 2, 4.5, 16));
      lower = cut(lower, rod(x, y, 6, 1.6, 12));
      upper = joined(upper, rod(x, y, 18, 4.5, 10));
      upper = cut(upper, rod(x, y, 18, 2.4, 12));
    }
  upper = cut(upper, rod(0, 0, 26, 10, 6));
  const TDF_Label screw_m2 = tree.part("screw_m2", screw(2, 20, 3.8, 1.6), 0x444444);
  tree.place(drive, tree.part("case_lower", lower, 0x222222), "case_lower", moved(0, 0, 0));
  tree.place(drive, tree.part("case_upper", upper, 0x333333), "case_upper", moved(0, 0, 0));
  int number = 0;
  for (const double x : {-16.0, 16.0})
    for (const double y : {-8.0, 8.0})
      tree.place(drive, screw_m2, "screw_" + std::to_string(++number), moved(x, y, 30));
  TopoDS_Shape gear = rod(0, 0, 8, 14, 4);
  for (int i = 0; i < 14; ++i) {
    const double a = 0.448798950512828 * i;
    gear = cut(gear, rod(7 * std::cos(a), 7 * std::sin(a), 8, 1.8, 4));
  }
  gear = cut(gear, rod(0, 0, 8, 3, 4));
  tree.place(drive, tree.part("gear", gear, 0xccaa66), "gear", moved(0, 0, 0));
  tree.place(drive, tree.part("pin", rod(0, 0, 2, 3, 22), 0xdddddd), "pin", moved(0, 0, 0));
  TopoDS_Shape horn = joined(rod(0, 0, 26, 9.6, 7), rod(0, 0, 33, 22, 3));
  for (int i = 0; i < 4; ++i) {
    const double a = 1.5707963267948966 * i;
    horn = cut(horn, rod(8 * std::cos(a), 8 * std::sin(a), 33, 2, 3));
  }
  tree.place(drive, tree.part("horn", horn, 0x666666), "horn", moved(0, 0, 0));
  const TDF_Label pad = tree.part("pad", block(-6, -1, 2, 12, 2, 3), 0x229944);
  for (int i = 0; i < 5; ++i)
    tree.place(drive, pad, "pad_" + std::to_string(i + 1), moved(0, -8 + 4 * i, 0));
  return drive;
}

// A plate with rows of holes, some of them countersunk.
TopoDS_Shape link_of(int number) {
  const double length = 90.0 + 5.0 * number;
  TopoDS_Shape link = block(-12, -14, 36, length, 28, 6);
  for (int i = 0; i < 4; ++i) {
    const double a = 1.5707963267948966 * i;
    link = cut(link, rod(8 * std::cos(a), 8 * std::sin(a), 36, 2.2, 6));
  }
  for (int i = 0; i < 10 + number; ++i)
    for (int j = 0; j < 4; ++j) {
      const double x = 16 + 5.0 * i, y = -10.5 + 7.0 * j;
      link = cut(link, rod(x, y, 36, 3.2, 6));
      if ((i + j) % 2 == 0)
        link =
            cut(link, BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(x, y, 40.5), kUp), 1.6, 3.1, 1.5).Shape());
    }
  return link;
}

}  // namespace

bool write_arm(const std::string& file, int joints) {
  ProductTree tree;
  const TDF_Label arm = tree.assembly("arm");
  const TDF_Label drive = drive_of(tree);
  const TDF_Label screw_m2 = tree.part("screw_m2x6", screw(2, 6, 3.8, 1.6), 0x444444);
  gp_Trsf at;
  for (int i = 0; i < joints; ++i) {
    const std::string number = std::to_string(i + 1);
    tree.place(arm, drive, "drive_" + number, at);
    const TDF_Label link = tree.part("link_" + number, link_of(i), 0x4477aa);
    tree.place(arm, link, "link_" + number, at);
    for (int k = 0; k < 4; ++k) {
      const double a = 1.5707963267948966 * k;
      tree.place(arm, screw_m2, "screw_" + number + "_" + std::to_string(k + 1),
                 at * moved(8 * std::cos(a), 8 * std::sin(a), 42));
    }
    // The next drive stands on the far end of the link.
    at = at * moved(60.0 + 5.0 * i, 0, 42) * turned(1, 0, 0.3, 20.0, 0, 0, 12);
  }
  return tree.write(file);
}

bool write_odd(const std::string& file, const std::string& unit) {
  ProductTree tree;
  const TDF_Label all = tree.assembly("odd \"assembly\": [1]");
  const TopoDS_Shape plate = cut(block(-20, -20, -20, 40, 40, 20), rod(0, 0, -20, 10, 20));
  tree.place(all, tree.part("plate/with 'a' slash", plate, 0x888888), "plate/1", moved(0, 0, 0));
  // Two products of one name, one of them far too thick for the hole.
  tree.place(all, tree.part("pin", rod(0, 0, -20, 10, 30), 0xdddddd), "pin", moved(0, 0, 0));
  tree.place(all, tree.part("pin", rod(0, 0, -20, 14, 5), 0xdddddd), "pin", moved(0, 0, 0));
  tree.place(all, tree.part("", block(0, 0, 0, 5, 5, 5), 0xdddddd), "", moved(100, 0, 0));
  tree.place(all, tree.part("*", block(0, 0, 0, 5, 5, 5), 0xdddddd), "Ø10 µm – *.{}#\n\t%s",
             moved(105, 0, 0));
  const TDF_Label upper = tree.assembly("sub"), lower = tree.assembly("sub");
  tree.place(lower, tree.part("deep", block(0, 0, 0, 2, 2, 2), 0xdddddd), "deep", moved(0, 0, 0));
  tree.place(upper, lower, "sub", turned(0, 0, 1, 30, 0, 0, 5));
  tree.place(all, upper, "sub", turned(1, 0, 0, 30, 200, 0, 0));
  tree.place(all, tree.assembly("empty"), "empty", moved(0, 0, 0));
  // A product of two solids, a box without a lid, an edge.
  TopoDS_Compound two;
  TopoDS_Shell open;
  BRep_Builder builder;
  builder.MakeCompound(two);
  builder.Add(two, block(300, 0, 0, 4, 4, 4));
  builder.Add(two, block(300, 0, 10, 4, 4, 4));
  tree.place(all, tree.part("two", two, 0xdddddd), "two", moved(0, 0, 0));
  builder.MakeShell(open);
  int faces = 0;
  for (TopExp_Explorer x(block(400, 0, 0, 4, 4, 4), TopAbs_FACE); x.More() && faces < 5; x.Next())
    builder.Add(open, x.Current()), ++faces;
  tree.place(all, tree.part("open", open, 0xdddddd), "open", moved(0, 0, 0));
  tree.place(all,
             tree.part("edge", BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(0, 0, 9)).Shape(),
                       0xdddddd),
             "edge", moved(0, 0, 0));
  return tree.write(file, unit);
}

}  // namespace mortise::test
