#pragma once
#include <TDF_Label.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Shape.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp_Trsf.hxx>
#include <string>

namespace mortise::test {

/// A STEP document in the making: products, where they stand, and what is stated of their sizes.
class ProductTree {
 public:
  ProductTree();

  /// `colour`: 0xRRGGBB.
  TDF_Label part(const std::string& name, const TopoDS_Shape& shape, int colour);
  TDF_Label assembly(const std::string& name);
  void place(const TDF_Label& assembly, const TDF_Label& product, const std::string& name,
             const gp_Trsf& at);

  /// "diameter ±" of the cylinder with this radius: deviations as on a drawing.
  void state_diameter(const TDF_Label& part, double diameter_mm, double lower_mm, double upper_mm);
  /// Position of the axis of that cylinder.
  void state_position(const TDF_Label& part, double diameter_mm, double zone_mm);

  /// AP242, without the hour of writing. False when the library fails.
  bool write(const std::string& file, const std::string& unit = "MM");

 private:
  TDF_Label face_of(const TDF_Label& part, double diameter_mm);

  Handle(TDocStd_Document) document_;
  Handle(XCAFDoc_ShapeTool) shapes_;
};

gp_Trsf moved(double x, double y, double z);
/// About an axis through the origin, then moved.
gp_Trsf turned(double ax, double ay, double az, double degrees, double x, double y, double z);

}  // namespace mortise::test
