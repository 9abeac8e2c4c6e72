#include "common/io/step/importer/pmi.h"

#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <Interface_InterfaceModel.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <StepAP242_ItemIdentifiedRepresentationUsage.hxx>
#include <StepAP242_ItemIdentifiedRepresentationUsageDefinition.hxx>
#include <StepBasic_MeasureWithUnit.hxx>
#include <StepBasic_NamedUnit.hxx>
#include <StepBasic_Unit.hxx>
#include <StepDimTol_Datum.hxx>
#include <StepDimTol_GeometricTolerance.hxx>
#include <StepDimTol_GeometricToleranceTarget.hxx>
#include <StepDimTol_GeometricToleranceWithModifiers.hxx>
#include <StepDimTol_HArray1OfGeometricToleranceModifier.hxx>
#include <StepRepr_HArray1OfRepresentationItem.hxx>
#include <StepRepr_MeasureRepresentationItem.hxx>
#include <StepRepr_ReprItemAndMeasureWithUnit.hxx>
#include <StepRepr_ReprItemAndMeasureWithUnitAndQRI.hxx>
#include <StepRepr_ShapeAspect.hxx>
#include <StepRepr_ShapeAspectRelationship.hxx>
#include <StepShape_AdvancedFace.hxx>
#include <StepShape_AngularLocation.hxx>
#include <StepShape_AngularSize.hxx>
#include <StepShape_DimensionalCharacteristicRepresentation.hxx>
#include <StepShape_DimensionalLocation.hxx>
#include <StepShape_DimensionalSize.hxx>
#include <StepShape_LimitsAndFits.hxx>
#include <StepShape_PlusMinusTolerance.hxx>
#include <StepShape_ShapeDimensionRepresentation.hxx>
#include <StepShape_ToleranceMethodDefinition.hxx>
#include <StepShape_ToleranceValue.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "common/io/step/importer/mesh_part.h"

namespace mortise {
namespace {

using Entity = Handle(Standard_Transient);

std::string text_of(const Handle(TCollection_HAsciiString) & text) {
  return text.IsNull() ? std::string() : std::string(text->ToCString());
}

struct Measured {
  double value = 0.0;
  bool is_angle = false;
  std::string name;
};

class PmiReader {
 public:
  PmiReader(const StepTree& tree, StepDocument& document)
      : document_(document),
        session_(tree.reader.Reader().WS()),
        process_(session_->TransferReader()->TransientProcess()),
        model_(session_->Model()),
        graph_(session_->Graph()) {
    for (std::size_t p = 0; p < tree.solids.size(); ++p) {
      const std::vector<TopoDS_Shape> faces = faces_of(tree.solids[p]);
      for (std::size_t f = 0; f < faces.size(); ++f)
        face_of_.emplace(faces[f].TShape().get(),
                         StepFaceRef{static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(f)});
    }
  }

  void run() {
    for (int i = 1; i <= model_->NbEntities(); ++i) {
      const Entity entity = model_->Value(i);
      StepStatement statement;
      statement.entity = static_cast<std::uint32_t>(i);
      if (!read(entity, statement)) continue;
      document_.statements.push_back(std::move(statement));
    }
  }

 private:
  bool read(const Entity& entity, StepStatement& s) {
    const auto size = Handle(StepShape_DimensionalSize)::DownCast(entity);
    const auto location = Handle(StepShape_DimensionalLocation)::DownCast(entity);
    const auto geometric = Handle(StepDimTol_GeometricTolerance)::DownCast(entity);
    const auto datum = Handle(StepDimTol_Datum)::DownCast(entity);
    if (!size.IsNull()) {
      s.kind = entity->IsKind(STANDARD_TYPE(StepShape_AngularSize)) ? StepStatement::Kind::kAngle
                                                                    : StepStatement::Kind::kSize;
      s.name = text_of(size->Name());
      dimension(entity, s);
      faces_of_aspect(size->AppliesTo(), s.faces, s.faces_lost, 0);
    } else if (!location.IsNull()) {
      s.kind = entity->IsKind(STANDARD_TYPE(StepShape_AngularLocation))
                   ? StepStatement::Kind::kAngle
                   : StepStatement::Kind::kDistance;
      s.name = text_of(location->Name());
      dimension(entity, s);
      faces_of_aspect(location->RelatingShapeAspect(), s.faces, s.faces_lost, 0);
      faces_of_aspect(location->RelatedShapeAspect(), s.other_faces, s.faces_lost, 0);
    } else if (!geometric.IsNull()) {
      geometric_tolerance(geometric, s);
    } else if (!datum.IsNull()) {
      s.kind = StepStatement::Kind::kDatum;
      s.name = "datum " + text_of(datum->Identification());
      faces_of_aspect(datum, s.faces, s.faces_lost, 0);
    } else {
      return false;
    }
    return true;
  }

  // 1. numbers

  static bool read_measure(const Handle(StepBasic_MeasureWithUnit) & measure, Measured& out) {
    if (measure.IsNull()) return false;
    out.value = measure->ValueComponent();
    StepBasic_Unit unit = measure->UnitComponent();
    if (unit.IsNull() || unit.CaseNum(unit.Value()) != 1) return true;
    STEPConstruct_UnitContext factors;
    factors.ComputeFactors(unit.NamedUnit());
    if (factors.PlaneAngleDone()) {
      out.value *= factors.PlaneAngleFactor() * 180.0 / std::numbers::pi;
      out.is_angle = true;
    } else if (factors.LengthDone()) {
      out.value *= factors.LengthFactor();
    }
    return true;
  }

  static bool read_item(const Entity& item, Measured& out) {
    auto measure = Handle(StepBasic_MeasureWithUnit)::DownCast(item);
    const auto named = [&](const auto& of, const Handle(StepBasic_MeasureWithUnit) & its) {
      if (of.IsNull()) return;
      measure = its;
      out.name = text_of(of->Name());
    };
    if (measure.IsNull()) {
      const auto plain = Handle(StepRepr_ReprItemAndMeasureWithUnit)::DownCast(item);
      const auto qualified = Handle(StepRepr_ReprItemAndMeasureWithUnitAndQRI)::DownCast(item);
      const auto simple = Handle(StepRepr_MeasureRepresentationItem)::DownCast(item);
      if (!plain.IsNull()) named(plain, plain->GetMeasureWithUnit());
      if (!qualified.IsNull()) named(qualified, qualified->GetMeasureWithUnit());
      if (!simple.IsNull()) named(simple, simple->Measure());
    }
    return read_measure(measure, out);
  }

  void characteristic(const Handle(StepShape_DimensionalCharacteristicRepresentation) & of,
                      StepStatement& s) {
    if (of.IsNull() || of->Representation().IsNull()) return;
    const auto items = of->Representation()->Items();
    if (items.IsNull()) return;
    for (int k = items->Lower(); k <= items->Upper(); ++k) {
      Measured measured;
      if (!read_item(items->Value(k), measured)) continue;
      if (measured.name.find("upper") != std::string::npos)
        s.limit_upper = measured.value;
      else if (measured.name.find("lower") != std::string::npos)
        s.limit_lower = measured.value;
      else
        s.value = measured.value;
      if (measured.is_angle) s.kind = StepStatement::Kind::kAngle;
    }
  }

  void plus_minus(const Handle(StepShape_PlusMinusTolerance) & of, StepStatement& s) {
    if (of.IsNull()) return;
    const Entity range = of->Range().Value();
    const auto value = Handle(StepShape_ToleranceValue)::DownCast(range);
    if (!value.IsNull()) {
      Measured upper, lower;
      if (read_item(value->UpperBound(), upper)) s.upper = upper.value;
      if (read_item(value->LowerBound(), lower)) s.lower = lower.value;
    }
    const auto fit = Handle(StepShape_LimitsAndFits)::DownCast(range);
    if (fit.IsNull()) return;
    // "H7" may be in one of these or in pieces: variance of form and zone, and grade.
    const std::string form = text_of(fit->FormVariance()), zone = text_of(fit->ZoneVariance());
    const std::string grade = text_of(fit->Grade());
    s.code = form.find_first_of("0123456789") != std::string::npos ? form : form + grade;
    if (s.modifiers.empty()) s.modifiers = zone;
  }

  void dimension(const Entity& entity, StepStatement& s) {
    for (Interface_EntityIterator it = graph_.Sharings(entity); it.More(); it.Next()) {
      characteristic(
          Handle(StepShape_DimensionalCharacteristicRepresentation)::DownCast(it.Value()), s);
      plus_minus(Handle(StepShape_PlusMinusTolerance)::DownCast(it.Value()), s);
    }
  }

  void geometric_tolerance(const Handle(StepDimTol_GeometricTolerance) & of, StepStatement& s) {
    s.kind = StepStatement::Kind::kGeometric;
    std::string type = of->DynamicType()->Name();
    const std::size_t underscore = type.find('_');
    if (underscore != std::string::npos) type.erase(0, underscore + 1);
    s.name = type;
    Measured magnitude;
    if (read_item(of->Magnitude(), magnitude) && magnitude.value != 0.0) s.value = magnitude.value;
    const Entity target = of->TolerancedShapeAspect().Value();
    faces_of_aspect(target, s.faces, s.faces_lost, 0);
    if (s.faces.empty())
      if (const auto size = Handle(StepShape_DimensionalSize)::DownCast(target); !size.IsNull())
        faces_of_aspect(size->AppliesTo(), s.faces, s.faces_lost, 0);
  }

  // 2. faces

  void add_face(const Entity& item, std::vector<StepFaceRef>& faces, std::uint32_t& lost) {
    if (item.IsNull()) return;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process_, item);
    bool found = false;
    if (!shape.IsNull())
      for (TopExp_Explorer x(shape, TopAbs_FACE); x.More(); x.Next()) {
        const auto known = face_of_.find(x.Current().TShape().get());
        if (known == face_of_.end()) continue;
        found = true;
        if (std::find(faces.begin(), faces.end(), known->second) == faces.end())
          faces.push_back(known->second);
      }
    if (!found) ++lost;
  }

  void faces_of_aspect(const Entity& aspect, std::vector<StepFaceRef>& faces, std::uint32_t& lost,
                       int depth) {
    if (aspect.IsNull() || depth > 4) return;
    for (Interface_EntityIterator it = graph_.Sharings(aspect); it.More(); it.Next()) {
      const Entity sharing = it.Value();
      const auto usage = Handle(StepAP242_ItemIdentifiedRepresentationUsage)::DownCast(sharing);
      if (!usage.IsNull()) {
        if (usage->Definition().Value() != aspect) continue;
        for (int k = 1; k <= usage->NbIdentifiedItem(); ++k)
          add_face(usage->IdentifiedItemValue(k), faces, lost);
        continue;
      }
      const auto relation = Handle(StepRepr_ShapeAspectRelationship)::DownCast(sharing);
      if (!relation.IsNull() && relation->RelatingShapeAspect() == aspect &&
          !sharing->IsKind(STANDARD_TYPE(StepShape_DimensionalLocation)))
        faces_of_aspect(relation->RelatedShapeAspect(), faces, lost, depth + 1);
    }
  }

  StepDocument& document_;
  Handle(XSControl_WorkSession) session_;
  Handle(Transfer_TransientProcess) process_;
  Handle(Interface_InterfaceModel) model_;
  const Interface_Graph& graph_;
  std::map<const void*, StepFaceRef> face_of_;
};

}  // namespace

void read_pmi(const StepTree& tree, StepDocument& document) { PmiReader(tree, document).run(); }

}  // namespace mortise
