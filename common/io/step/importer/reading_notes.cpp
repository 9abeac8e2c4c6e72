#include "common/io/step/importer/reading_notes.h"

#include <Interface_Check.hxx>
#include <Interface_ReportEntity.hxx>
#include <StepBasic_ConversionBasedUnitAndLengthUnit.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepGeom_GeometricRepresentationItem.hxx>
#include <StepRepr_ItemDefinedTransformation.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepRepr_RepresentationContext.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <StepRepr_RepresentationRelationship.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <StepShape_TopologicalRepresentationItem.hxx>
#include <TDF_LabelSequence.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <unordered_set>

#include "common/io/step/step_objections.h"

namespace mortise {
namespace {

using Entity = Handle(Standard_Transient);

// Is a shape or a place made of it? All the rest (names, colours, statements) may be damaged.
bool bears_shape(const Entity& entity) {
  if (std::string(entity->DynamicType()->Name()).starts_with("StepVisual_")) return false;
  const auto kinds = {STANDARD_TYPE(StepGeom_GeometricRepresentationItem),
                      STANDARD_TYPE(StepShape_TopologicalRepresentationItem),
                      STANDARD_TYPE(StepShape_ShapeRepresentation),
                      STANDARD_TYPE(StepShape_ShapeDefinitionRepresentation),
                      STANDARD_TYPE(StepShape_ContextDependentShapeRepresentation),
                      STANDARD_TYPE(StepRepr_MappedItem),
                      STANDARD_TYPE(StepRepr_RepresentationMap),
                      STANDARD_TYPE(StepRepr_RepresentationContext),
                      STANDARD_TYPE(StepRepr_RepresentationRelationship),
                      STANDARD_TYPE(StepRepr_ItemDefinedTransformation),
                      STANDARD_TYPE(StepRepr_ProductDefinitionShape),
                      STANDARD_TYPE(StepRepr_NextAssemblyUsageOccurrence),
                      STANDARD_TYPE(StepBasic_ProductDefinition),
                      STANDARD_TYPE(StepBasic_ConversionBasedUnitAndLengthUnit)};
  return std::ranges::any_of(kinds, [&](const auto& kind) { return entity->IsKind(kind); });
}

// Nothing hangs on a name, and the dimensions of a unit are those of its kind.
bool says_nothing(const std::string& failure) {
  return failure.find("name)") != std::string::npos ||
         failure.find("description)") != std::string::npos ||
         failure.find("(dimensions)") != std::string::npos;
}

class NotRead {
 public:
  explicit NotRead(const StepTree& tree)
      : text_(*tree.text),
        model_(Handle(StepData_StepModel)::DownCast(tree.reader.Reader().WS()->Model())) {}

  std::vector<std::string> notes() {
    if (model_.IsNull()) return {};
    std::vector<std::string> notes = syntax();
    add_unknown();
    for (int i = 1; i <= model_->NbEntities(); ++i)
      if (model_->IsReportEntity(i) && bears_shape(model_->Value(i)))
        failures(model_->Value(i), *model_->ReportEntity(i)->Check());
    if (count_ > 0)
      notes.push_back(first_ +
                      (count_ > 1 ? " (the first of " + std::to_string(count_) + ")" : "") +
                      "; what is made of it is missing or in a wrong place; export it again");
    return notes;
  }

 private:
  // What is no STEP text; what is said of references is said of the text itself.
  std::vector<std::string> syntax() const {
    const Handle(Interface_Check) check = model_->GlobalCheck();
    for (int i = 1; i <= check->NbFails(); ++i)
      if (const std::string text = check->CFail(i); !text.starts_with("Unresolved Reference"))
        return {"it is damaged (" + text + "); export it again"};
    return {};
  }

  void failures(const Entity& entity, const Interface_Check& check) {
    for (int i = 1; i <= check.NbFails(); ++i)
      if (const std::string text = check.CFail(i); !says_nothing(text)) {
        add(model_->IdentLabel(entity), text);
        return;
      }
  }

  // Of a kind that the library does not know, where a shape or place is made of it.
  void add_unknown() {
    std::unordered_set<int> unknown;
    for (int i = 1; i <= model_->NbEntities(); ++i)
      if (model_->Value(i)->IsKind(STANDARD_TYPE(StepData_UndefinedEntity)))
        unknown.insert(model_->IdentLabel(model_->Value(i)));
    if (unknown.empty()) return;
    for (int i = 1; i <= model_->NbEntities(); ++i) {
      if (!bears_shape(model_->Value(i))) continue;
      for (const int named : step_references(text_.entity(model_->IdentLabel(model_->Value(i))))) {
        const std::string_view entity = text_.entity(named);
        if (unknown.contains(named) && entity.find("TESSELLATED") == std::string_view::npos)
          add(named, "its kind is not known");
      }
    }
  }

  void add(int label, const std::string& why) {
    if (count_++ > 0) return;
    const auto keywords = step_keywords(text_.entity(label));
    first_ = step_place(text_, label) + (keywords.empty() ? "" : " " + keywords.front()) +
             " was not read as it stands: " + why;
  }

  const StepText& text_;
  Handle(StepData_StepModel) model_;
  std::string first_;
  std::size_t count_ = 0;
};

// Places in assemblies that the library made something of.
std::size_t places_read(const StepTree& tree) {
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(tree.document->Main());
  TDF_LabelSequence all;
  shapes->GetShapes(all);
  std::size_t places = 0;
  for (int i = 1; i <= all.Length(); ++i)
    if (shapes->IsAssembly(all.Value(i)))
      places += static_cast<std::size_t>(shapes->NbComponents(all.Value(i)));
  return places;
}

}  // namespace

std::vector<std::string> reading_notes(const StepTree& tree) {
  std::vector<std::string> notes = step_missing(*tree.text);
  for (std::string& note : step_crowded_points(*tree.text)) notes.push_back(std::move(note));
  for (std::string& note : NotRead(tree).notes()) notes.push_back(std::move(note));
  const std::size_t stated = step_places(*tree.text), read = places_read(tree);
  if (read < stated)
    notes.push_back(std::to_string(stated - read) + " of its " + std::to_string(stated) +
                    " places in assemblies (NEXT_ASSEMBLY_USAGE_OCCURRENCE) could not be read: "
                    "what stands there is not judged; export it again");
  return notes;
}

}  // namespace mortise
