#include "tests/assemblies/exact_pairs.h"

#include <BRepAlgoAPI_Common.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <Standard_Failure.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <map>
#include <random>
#include <vector>

namespace mortise::test {
namespace {

// The depth of thinner overlaps is not asked.
constexpr double kThick_mm = 0.02;
// The distance from the face of an ellipse fails at times: a depth of so many thicknesses is wrong.
constexpr double kBelieved = 20.0;

bool read_document(const std::string& file, Handle(TDocStd_Document) & document) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  STEPCAFControl_Reader reader;
  reader.SetNameMode(true);
  reader.SetGDTMode(true);
  return reader.ReadFile(file.c_str()) == IFSelect_RetDone && reader.Transfer(document);
}

// All leaves below a label, placed.
void leaves(const TDF_Label& label, const TopLoc_Location& above,
            std::vector<TopoDS_Shape>& found) {
  TDF_Label product = label;
  TopLoc_Location at = above;
  if (XCAFDoc_ShapeTool::IsReference(label)) {
    at = above * XCAFDoc_ShapeTool::GetLocation(label);
    XCAFDoc_ShapeTool::GetReferredShape(label, product);
  }
  if (XCAFDoc_ShapeTool::IsAssembly(product)) {
    TDF_LabelSequence below;
    XCAFDoc_ShapeTool::GetComponents(product, below);
    for (int i = 1; i <= below.Length(); ++i) leaves(below.Value(i), at, found);
    return;
  }
  TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(product);
  shape.Location(TopLoc_Location());
  TopoDS_Compound solids;
  BRep_Builder builder;
  builder.MakeCompound(solids);
  bool any = false;
  for (TopExp_Explorer x(shape, TopAbs_SOLID); x.More(); x.Next(), any = true)
    builder.Add(solids, x.Current());
  if (any) found.push_back(solids.Moved(at));
}

GProp_GProps volume_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-5, true);
  return properties;
}

// The deepest that was found of points in a piece that two solids have in common: their distances
// from the surfaces of both, added. From below.
double depth_of(const TopoDS_Shape& piece, const TopoDS_Shape& a, const TopoDS_Shape& b) {
  constexpr int kTries = 120;
  const TopoDS_Shape shell_a = TopExp_Explorer(a, TopAbs_SHELL).Current(),
                     shell_b = TopExp_Explorer(b, TopAbs_SHELL).Current();
  Bnd_Box box;
  BRepBndLib::AddOptimal(piece, box, false, false);
  const gp_Pnt lo = box.CornerMin(), hi = box.CornerMax();
  BRepClass3d_SolidClassifier inside(piece);
  std::mt19937 random(1);
  const auto near = [&](double x, double half) {
    return std::uniform_real_distribution<double>(x - half, x + half)(random);
  };
  gp_Pnt best((lo.XYZ() + hi.XYZ()) / 2.0), found = best;
  gp_XYZ half = (hi.XYZ() - lo.XYZ()) / 2.0;
  double deepest = 0.0;
  for (int i = 0; i < 2 * kTries; ++i) {
    const gp_Pnt x(near(best.X(), half.X()), near(best.Y(), half.Y()), near(best.Z(), half.Z()));
    inside.Perform(x, 1e-7);
    if (inside.State() != TopAbs_IN) continue;
    const TopoDS_Shape point = BRepBuilderAPI_MakeVertex(x).Shape();
    const double depth = BRepExtrema_DistShapeShape(point, shell_a).Value() +
                         BRepExtrema_DistShapeShape(point, shell_b).Value();
    if (depth > deepest) deepest = depth, found = x;
    if (i >= kTries) best = found, half *= 0.97;
  }
  return deepest;
}

void print_pair(std::size_t i, std::size_t j, const TopoDS_Shape& a, const TopoDS_Shape& b) {
  const std::clock_t begin = std::clock();
  double volume = -1.0, thickness = 0.0;
  TopoDS_Shape thickest;
  try {
    BRepAlgoAPI_Common common(a, b);
    if (common.IsDone() && !common.HasErrors()) {
      volume = 0.0;
      for (TopExp_Explorer x(common.Shape(), TopAbs_SOLID); x.More(); x.Next()) {
        GProp_GProps surface;
        BRepGProp::SurfaceProperties(x.Current(), surface);
        const double own = volume_of(x.Current()).Mass();
        volume += std::max(0.0, own);
        if (surface.Mass() > 0.0 && 2.0 * own / surface.Mass() > thickness) {
          thickness = 2.0 * own / surface.Mass();
          thickest = x.Current();
        }
      }
    }
  } catch (const Standard_Failure&) {
    volume = -1.0;
  }
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  double depth = thickness > kThick_mm ? depth_of(thickest, a, b) : 0.0;
  if (depth > kBelieved * thickness) depth = 0.0;
  std::printf("pair %zu %zu %.9g %.9g %.6f %.9g\n", i, j, volume, thickness, seconds, depth);
  std::fflush(stdout);
}

}  // namespace

bool print_exact_pairs(const std::string& file) {
  Handle(TDocStd_Document) document;
  if (!read_document(file, document)) return false;
  TDF_LabelSequence roots;
  XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(roots);
  std::vector<TopoDS_Shape> all;
  for (int i = 1; i <= roots.Length(); ++i) leaves(roots.Value(i), TopLoc_Location(), all);
  std::vector<Bnd_Box> boxes(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const GProp_GProps p = volume_of(all[i]);
    std::printf("part %zu %.9g %.9g %.9g %.9g\n", i, p.CentreOfMass().X(), p.CentreOfMass().Y(),
                p.CentreOfMass().Z(), p.Mass());
    BRepBndLib::AddOptimal(all[i], boxes[i], false, false);
  }
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j)
      if (!boxes[i].IsOut(boxes[j])) print_pair(i, j, all[i], all[j]);
  return true;
}

namespace {

// The same solid with the faces of its shells in the opposite order.
TopoDS_Shape turned_over(const TopoDS_Shape& shape) {
  if (shape.ShapeType() == TopAbs_FACE) return shape;
  TopoDS_Shape copy = shape.EmptyCopied();
  std::vector<TopoDS_Shape> below;
  for (TopoDS_Iterator x(shape, false, false); x.More(); x.Next()) below.push_back(x.Value());
  std::reverse(below.begin(), below.end());
  BRep_Builder builder;
  for (const TopoDS_Shape& b : below) builder.Add(copy, turned_over(b));
  copy.Closed(shape.Closed());
  return copy;
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  return label.FindAttribute(TDataStd_Name::GetID(), name)
             ? TCollection_AsciiString(name->Get()).ToCString()
             : "";
}

}  // namespace

bool rewrite(const std::string& from, const std::string& to) {
  Handle(TDocStd_Document) in, out;
  if (!read_document(from, in)) return false;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", out);
  const Handle(XCAFDoc_ShapeTool) tool = XCAFDoc_DocumentTool::ShapeTool(out->Main());
  std::vector<std::pair<TDF_Label, TDF_Label>> known;
  const std::function<TDF_Label(const TDF_Label&)> copy = [&](const TDF_Label& product) {
    for (const auto& [old, made] : known)
      if (old == product) return made;
    TDF_Label made;
    if (XCAFDoc_ShapeTool::IsAssembly(product)) {
      made = tool->NewShape();
      TDF_LabelSequence below;
      XCAFDoc_ShapeTool::GetComponents(product, below);
      for (int i = below.Length(); i >= 1; --i) {
        TDF_Label referred;
        XCAFDoc_ShapeTool::GetReferredShape(below.Value(i), referred);
        const TDF_Label component = tool->AddComponent(
            made, copy(referred), XCAFDoc_ShapeTool::GetLocation(below.Value(i)));
        TDataStd_Name::Set(component, name_of(below.Value(i)).c_str());
      }
    } else {
      made = tool->AddShape(turned_over(XCAFDoc_ShapeTool::GetShape(product)), false);
    }
    TDataStd_Name::Set(made, name_of(product).c_str());
    known.emplace_back(product, made);
    return made;
  };
  TDF_LabelSequence roots;
  XCAFDoc_DocumentTool::ShapeTool(in->Main())->GetFreeShapes(roots);
  for (int i = roots.Length(); i >= 1; --i) copy(roots.Value(i));
  tool->UpdateAssemblies();
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  STEPCAFControl_Writer writer;
  writer.SetNameMode(true);
  return writer.Transfer(out, STEPControl_AsIs) && writer.Write(to.c_str()) == IFSelect_RetDone;
}

}  // namespace mortise::test
