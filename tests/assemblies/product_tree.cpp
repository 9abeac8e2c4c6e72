#include "tests/assemblies/product_tree.h"

#include <BRepAdaptor_Surface.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Controller.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDimTolObjects_DimensionObject.hxx>
#include <XCAFDimTolObjects_GeomToleranceObject.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DimTolTool.hxx>
#include <XCAFDoc_Dimension.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_GeomTolerance.hxx>
#include <cmath>
#include <fstream>
#include <gp_Ax1.hxx>
#include <iterator>
#include <numbers>
#include <regex>

namespace mortise::test {

ProductTree::ProductTree() {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Controller::Init();  // or it knows no schema
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document_);
  shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
}

TDF_Label ProductTree::part(const std::string& name, const TopoDS_Shape& shape, int colour) {
  const TDF_Label label = shapes_->AddShape(shape, false);
  TDataStd_Name::Set(label, name.c_str());
  const auto channel = [&](int shift) { return ((colour >> shift) & 0xff) / 255.0; };
  XCAFDoc_DocumentTool::ColorTool(document_->Main())
      ->SetColor(label, Quantity_Color(channel(16), channel(8), channel(0), Quantity_TOC_sRGB),
                 XCAFDoc_ColorSurf);
  return label;
}

TDF_Label ProductTree::assembly(const std::string& name) {
  const TDF_Label label = shapes_->NewShape();
  TDataStd_Name::Set(label, name.c_str());
  return label;
}

void ProductTree::place(const TDF_Label& assembly, const TDF_Label& product,
                        const std::string& name, const gp_Trsf& at) {
  const TDF_Label component = shapes_->AddComponent(assembly, product, TopLoc_Location(at));
  TDataStd_Name::Set(component, name.c_str());
}

TDF_Label ProductTree::face_of(const TDF_Label& part, double diameter_mm) {
  for (TopExp_Explorer x(XCAFDoc_ShapeTool::GetShape(part), TopAbs_FACE); x.More(); x.Next()) {
    const BRepAdaptor_Surface surface(TopoDS::Face(x.Current()));
    if (surface.GetType() == GeomAbs_Cylinder &&
        std::fabs(2.0 * surface.Cylinder().Radius() - diameter_mm) < 1e-6)
      return shapes_->AddSubShape(part, x.Current());
  }
  return {};
}

void ProductTree::state_diameter(const TDF_Label& part, double diameter_mm, double lower_mm,
                                 double upper_mm) {
  const Handle(XCAFDoc_DimTolTool) tool = XCAFDoc_DocumentTool::DimTolTool(document_->Main());
  const TDF_Label label = tool->AddDimension();
  const Handle(XCAFDoc_Dimension) dimension = XCAFDoc_Dimension::Set(label);
  Handle(XCAFDimTolObjects_DimensionObject) said = new XCAFDimTolObjects_DimensionObject();
  said->SetType(XCAFDimTolObjects_DimensionType_Size_Diameter);
  said->SetValue(diameter_mm);
  said->SetUpperTolValue(upper_mm);
  said->SetLowerTolValue(-lower_mm);  // it writes the opposite
  dimension->SetObject(said);
  tool->SetDimension(face_of(part, diameter_mm), label);
}

void ProductTree::state_position(const TDF_Label& part, double diameter_mm, double zone_mm) {
  const Handle(XCAFDoc_DimTolTool) tool = XCAFDoc_DocumentTool::DimTolTool(document_->Main());
  const TDF_Label label = tool->AddGeomTolerance();
  const Handle(XCAFDoc_GeomTolerance) tolerance = XCAFDoc_GeomTolerance::Set(label);
  Handle(XCAFDimTolObjects_GeomToleranceObject) said = new XCAFDimTolObjects_GeomToleranceObject();
  said->SetType(XCAFDimTolObjects_GeomToleranceType_Position);
  said->SetTypeOfValue(XCAFDimTolObjects_GeomToleranceTypeValue_Diameter);
  said->SetValue(zone_mm);
  tolerance->SetObject(said);
  tool->SetGeomTolerance(face_of(part, diameter_mm), label);
}

bool ProductTree::write(const std::string& file, const std::string& unit) {
  shapes_->UpdateAssemblies();
  Interface_Static::SetCVal("write.step.schema", "AP242DIS");
  Interface_Static::SetCVal("write.step.unit", unit.c_str());
  STEPCAFControl_Writer writer;
  writer.SetColorMode(true);
  writer.SetNameMode(true);
  writer.SetDimTolMode(true);
  if (!writer.Transfer(document_, STEPControl_AsIs)) return false;
  if (writer.Write(file.c_str()) != IFSelect_RetDone) return false;
  // The hour of writing is no part of it.
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << std::regex_replace(text, std::regex("'[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9:]*'"),
                            "'2026-01-01T00:00:00'", std::regex_constants::format_first_only);
  return out.good();
}

gp_Trsf moved(double x, double y, double z) {
  gp_Trsf at;
  at.SetTranslation(gp_Vec(x, y, z));
  return at;
}

gp_Trsf turned(double ax, double ay, double az, double degrees, double x, double y, double z) {
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(ax, ay, az)), degrees * std::numbers::pi / 180.0);
  return moved(x, y, z) * turn;
}

}  // namespace mortise::test
