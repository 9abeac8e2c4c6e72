#include "common/io/step/importer/pmi.h"

#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <StepAP242_ItemIdentifiedRepresentationUsage.hxx>
#include <StepAP242_ItemIdentifiedRepresentationUsageDefinition.hxx>
#include <StepBasic_MeasureWithUnit.hxx>
#include <StepBasic_NamedUnit.hxx>
#include <StepBasic_Unit.hxx>
#include <StepData_StepModel.hxx>
#include <StepDimTol_Datum.hxx>
#include <StepDimTol_DatumTarget.hxx>
#include <StepRepr_HArray1OfRepresentationItem.hxx>
#include <StepRepr_MeasureRepresentationItem.hxx>
#include <StepRepr_ReprItemAndMeasureWithUnit.hxx>
#include <StepRepr_ReprItemAndMeasureWithUnitAndQRI.hxx>
#include <StepRepr_ShapeAspect.hxx>
#include <StepRepr_ShapeAspectRelationship.hxx>
#include <StepShape_AngularLocation.hxx>
#include <StepShape_AngularSize.hxx>
#include <StepShape_DimensionalCharacteristicRepresentation.hxx>
#include <StepShape_DimensionalLocation.hxx>
#include <StepShape_DimensionalSize.hxx>
#include <StepShape_Face.hxx>
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
#include <array>
#include <cctype>
#include <map>
#include <numbers>
#include <optional>

#include "common/io/step/importer/mesh_part.h"
#include "common/io/step/step_text.h"

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

// "SURFACE_PROFILE_TOLERANCE" as "surface profile"; empty for another keyword.
std::string tolerance_name(const std::string& keyword) {
  constexpr std::array<std::string_view, 15> kKinds = {
      "ANGULARITY", "CIRCULAR_RUNOUT", "COAXIALITY",      "CONCENTRICITY",    "CYLINDRICITY",
      "FLATNESS",   "LINE_PROFILE",    "PARALLELISM",     "PERPENDICULARITY", "POSITION",
      "ROUNDNESS",  "STRAIGHTNESS",    "SURFACE_PROFILE", "SYMMETRY",         "TOTAL_RUNOUT"};
  constexpr std::string_view kEnd = "_TOLERANCE";
  if (!keyword.ends_with(kEnd)) return {};
  std::string name = keyword.substr(0, keyword.size() - kEnd.size());
  if (std::find(kKinds.begin(), kKinds.end(), name) == kKinds.end()) return {};
  for (char& c : name) c = c == '_' ? ' ' : static_cast<char>(c - 'A' + 'a');
  return name;
}

class PmiReader {
 public:
  PmiReader(const StepTree& tree, StepDocument& document)
      : document_(document),
        text_(*tree.text),
        session_(tree.reader.Reader().WS()),
        process_(session_->TransferReader()->TransientProcess()),
        model_(Handle(StepData_StepModel)::DownCast(session_->Model())),
        graph_(session_->Graph()) {
    for (std::size_t p = 0; p < tree.as_read.size(); ++p) {
      const std::vector<TopoDS_Shape> faces = faces_of(tree.as_read[p]);
      for (std::size_t f = 0; f < faces.size(); ++f)
        faces_of_[faces[f].TShape().get()].push_back(
            {static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(f)});
    }
  }

  void run() {
    if (model_.IsNull()) return;
    for (int i = 1; i <= model_->NbEntities(); ++i) {
      const Entity entity = model_->Value(i);
      const int label = model_->IdentLabel(entity);
      of_label_.emplace(label, entity);
      StepStatement statement;
      statement.entity = static_cast<std::uint32_t>(label);
      if (read(entity, statement)) document_.statements.push_back(std::move(statement));
    }
    read_geometric();
    std::stable_sort(document_.statements.begin(), document_.statements.end(),
                     [](const auto& a, const auto& b) { return a.entity < b.entity; });
  }

 private:
  bool read(const Entity& entity, StepStatement& s) {
    const auto size = Handle(StepShape_DimensionalSize)::DownCast(entity);
    const auto location = Handle(StepShape_DimensionalLocation)::DownCast(entity);
    const auto datum = Handle(StepDimTol_Datum)::DownCast(entity);
    const auto target = Handle(StepDimTol_DatumTarget)::DownCast(entity);
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
    } else if (!datum.IsNull()) {
      s.kind = StepStatement::Kind::kDatum;
      s.name = "datum " + text_of(datum->Identification());
      faces_of_aspect(datum, s.faces, s.faces_lost, 0);
    } else if (!target.IsNull()) {
      s.kind = StepStatement::Kind::kDatum;
      s.name = "datum target " + text_of(target->TargetId());
    } else {
      return false;
    }
    return true;
  }

  // 1. numbers

  static void in_our_unit(const Handle(StepBasic_NamedUnit) & unit, Measured& out) {
    if (unit.IsNull()) return;
    STEPConstruct_UnitContext factors;
    factors.ComputeFactors(unit);
    if (factors.PlaneAngleDone()) {
      out.value *= factors.PlaneAngleFactor() * 180.0 / std::numbers::pi;
      out.is_angle = true;
    } else if (factors.LengthDone()) {
      out.value *= factors.LengthFactor();
    }
  }

  static bool read_measure(const Handle(StepBasic_MeasureWithUnit) & measure, Measured& out) {
    if (measure.IsNull()) return false;
    out.value = measure->ValueComponent();
    StepBasic_Unit unit = measure->UnitComponent();
    if (unit.IsNull() || unit.CaseNum(unit.Value()) != 1) return true;
    in_our_unit(unit.NamedUnit(), out);
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
      if (!read_item(items->Value(k), measured)) continue;  // a text
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
    // Capitals are of holes. Some files write capitals only, and say which it is beside them.
    if (zone.find("shaft") != std::string::npos)
      for (char& c : s.code) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }

  void dimension(const Entity& entity, StepStatement& s) {
    for (Interface_EntityIterator it = graph_.Sharings(entity); it.More(); it.Next()) {
      characteristic(
          Handle(StepShape_DimensionalCharacteristicRepresentation)::DownCast(it.Value()), s);
      plus_minus(Handle(StepShape_PlusMinusTolerance)::DownCast(it.Value()), s);
    }
  }

  // Geometric tolerances come from the text: of some kinds the library makes nothing, and a
  // magnitude that is a complex entity it leaves out.
  void read_geometric() {
    for (const int label : text_.labels_with("_TOLERANCE")) {
      StepStatement s;
      s.kind = StepStatement::Kind::kGeometric;
      s.entity = static_cast<std::uint32_t>(label);
      const std::string_view entity = text_.entity(label);
      std::string simple;
      for (const std::string& keyword : step_keywords(entity))
        if (const std::string name = tolerance_name(keyword); !name.empty()) {
          s.name = name;
          simple = keyword;
        }
      // A simple entity has all arguments itself, a complex one those of its general part.
      auto arguments = step_arguments(entity, "GEOMETRIC_TOLERANCE");
      if (!arguments && !simple.empty()) arguments = step_arguments(entity, simple);
      if (!arguments || arguments->size() < 4) continue;
      if (s.name.empty()) s.name = "geometric tolerance";
      if (const auto value = text_measure((*arguments)[2])) s.value = *value;
      modifiers_of(entity, s);
      geometric_faces((*arguments)[3], s);
      document_.statements.push_back(std::move(s));
    }
  }

  void modifiers_of(std::string_view entity, StepStatement& s) const {
    const auto with = step_arguments(entity, "GEOMETRIC_TOLERANCE_WITH_MODIFIERS");
    if (with && !with->empty())
      for (const char c : with->front()) {  // (.MAXIMUM_MATERIAL_REQUIREMENT.,.STATISTICAL.)
        if (c == ',') s.modifiers += ", ";
        if (c == '_') s.modifiers += ' ';
        if (std::isalpha(static_cast<unsigned char>(c)) != 0)
          s.modifiers += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      }
    const auto unequal = step_arguments(entity, "UNEQUALLY_DISPOSED_GEOMETRIC_TOLERANCE");
    if (unequal && !unequal->empty())
      if (const auto outside = text_measure(unequal->back())) s.outside = *outside;
  }

  // The measure that an argument names, in mm or degrees.
  std::optional<double> text_measure(std::string_view argument) const {
    const std::string_view entity = text_.entity(step_reference(argument));
    for (const std::string& keyword : step_keywords(entity)) {
      if (!keyword.ends_with("MEASURE_WITH_UNIT")) continue;
      const auto arguments = step_arguments(entity, keyword);
      if (!arguments || arguments->size() < 2) continue;
      const auto value = step_number((*arguments)[0]);
      const auto unit = of_label_.find(step_reference((*arguments)[1]));
      if (!value || unit == of_label_.end()) continue;
      Measured measured;
      measured.value = *value;
      in_our_unit(Handle(StepBasic_NamedUnit)::DownCast(unit->second), measured);
      return measured.value;
    }
    return std::nullopt;
  }

  void geometric_faces(std::string_view argument, StepStatement& s) {
    const auto target = of_label_.find(step_reference(argument));
    if (target == of_label_.end()) return;
    faces_of_aspect(target->second, s.faces, s.faces_lost, 0);
    if (!s.faces.empty()) return;
    if (const auto size = Handle(StepShape_DimensionalSize)::DownCast(target->second);
        !size.IsNull())
      faces_of_aspect(size->AppliesTo(), s.faces, s.faces_lost, 0);
  }

  // 2. faces

  // Callouts and curves are no faces of a body; a face that is not found is told as lost.
  void add_face(const Entity& item, std::vector<StepFaceRef>& faces, std::uint32_t& lost) {
    if (item.IsNull()) return;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process_, item);
    bool found = false;
    if (!shape.IsNull())
      for (TopExp_Explorer x(shape, TopAbs_FACE); x.More(); x.Next()) {
        const auto known = faces_of_.find(x.Current().TShape().get());
        if (known == faces_of_.end()) continue;
        found = true;
        for (const StepFaceRef& ref : known->second)
          if (std::find(faces.begin(), faces.end(), ref) == faces.end()) faces.push_back(ref);
      }
    if (!found && item->IsKind(STANDARD_TYPE(StepShape_Face))) ++lost;
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
  const StepText& text_;
  Handle(XSControl_WorkSession) session_;
  Handle(Transfer_TransientProcess) process_;
  Handle(StepData_StepModel) model_;
  const Interface_Graph& graph_;
  std::map<const void*, std::vector<StepFaceRef>> faces_of_;  // a mirrored part has the same
  std::map<int, Entity> of_label_;
};

}  // namespace

void read_pmi(const StepTree& tree, StepDocument& document) { PmiReader(tree, document).run(); }

}  // namespace mortise
