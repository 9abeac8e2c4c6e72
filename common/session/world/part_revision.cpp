#include "common/session/world/part_revision.h"

#include <algorithm>
#include <utility>

#include "common/geometry/same_face.h"
#include "common/messages/names.h"
#include "common/session/guide/guidance.h"
#include "common/session/memory/session_state.h"
#include "common/session/world/standing.h"
#include "common/session/world/surface_rules.h"

namespace mortise {
namespace {

double reach_mm(const Solid& solid) {
  return solid.sphere().center_mm.norm() + solid.sphere().radius_mm;
}

// The name that a face of the part has in the mesh of the shape; nothing: it has no such face.
// Faces with a name keep it; those that only the mesh shows are found by their geometry.
std::optional<std::string> name_in(const World& world, const Part& part, const PartShape& shape,
                                   const std::string& name) {
  const auto has = [&](const std::vector<Feature>& features) {
    return std::ranges::any_of(features, [&](auto& f) { return f.name == name; });
  };
  if (has(part.features)) return has(shape.features) ? std::optional(name) : std::nullopt;
  const Feature* face = find_feature(world, part.id, name);
  if (face == nullptr) return std::nullopt;
  const SoughtFace sought{face->surface, middle_of(*face, part.solid->mesh())};
  const auto again = [&](const std::vector<Feature>& features) -> std::optional<std::string> {
    const auto found = find_again({&sought, 1}, features, shape.solid->mesh(),
                                  std::max(reach_mm(*part.solid), reach_mm(*shape.solid)));
    return found[0] ? std::optional(features[*found[0]].name) : std::nullopt;
  };
  if (auto found = again(shape.features)) return found;
  const std::vector<Feature>* shown = recognized_in(world, *shape.solid);
  return shown != nullptr ? again(*shown) : std::nullopt;
}

// Counts, and the first of what is gone or new.
std::string counted(std::size_t as_before, const std::vector<std::string>& gone,
                    const std::vector<std::string>& fresh) {
  constexpr std::size_t kShown = 4;  // names that a sentence bears
  std::string text = std::to_string(as_before) + " as before";
  const auto add = [&](const std::vector<std::string>& names, const char* what) {
    if (names.empty()) return;
    text += ", " + std::to_string(names.size()) + " " + what + " (";
    for (std::size_t i = 0; i < std::min(kShown, names.size()); ++i)
      text += (i == 0 ? "" : ", ") + names[i];
    text += names.size() > kShown ? ", …)" : ")";
  };
  add(gone, "gone");
  add(fresh, "new");
  return text;
}

std::string told_of_faces(const Part& part, const PartShape& shape) {
  std::size_t as_before = 0;
  std::vector<std::string> gone, fresh;
  const auto split = [](const std::vector<Feature>& of, const std::vector<Feature>& in,
                        std::vector<std::string>& missing) {
    std::size_t both = 0;
    for (const Feature& feature : of)
      if (std::ranges::any_of(in, [&](auto& f) { return f.name == feature.name; }))
        ++both;
      else
        missing.push_back(feature.name);
    return both;
  };
  as_before = split(part.features, shape.features, gone);
  split(shape.features, part.features, fresh);
  if (as_before + gone.size() + fresh.size() == 0) return "";
  return "faces: " + counted(as_before, gone, fresh);
}

std::string told_statement(const World& world, const Decision& said, PartId part) {
  const Details& d = said.details;
  const bool constrains = said.kind == Decision::Kind::kAddConstraint;
  const PartId held = constrains ? d.constraint.held.part : said.part;
  const PartId other = constrains ? d.constraint.other.part : d.other_part;
  const std::string what = constrains ? std::string(name_of(d.constraint.kind)) : d.text;
  if (!other) return what;
  const Part* with = world.find(held == part ? other : held);
  return what + " with " + (with != nullptr ? with->name : "?");
}

std::string told_of_statements(const World& world, const Part& part, const PartShape& shape) {
  std::size_t as_before = 0;
  std::vector<std::string> gone;
  for (const Decision& said : standing_decisions(world)) {
    const Details& d = said.details;
    std::string name;
    if (said.kind == Decision::Kind::kSetTolerance) {
      if (said.part == part.id) name = d.feature;
      if (d.other_part == part.id) name = d.other_feature;
    } else if (said.kind == Decision::Kind::kAddConstraint) {
      if (d.constraint.held.part == part.id) name = d.constraint.held.feature;
      if (d.constraint.other.part == part.id) name = d.constraint.other.feature;
    }
    if (name.empty()) continue;
    if (name_in(world, part, shape, name))
      ++as_before;
    else
      gone.push_back(told_statement(world, said, part.id));
  }
  if (as_before + gone.size() == 0) return "";
  return "statements: " + counted(as_before, gone, {});
}

// Constraints that name faces of the part, with what their faces are called from now on.
std::vector<std::optional<Constraint>> followed(const World& world, const Part& part,
                                                const PartShape& shape) {
  std::vector<std::optional<Constraint>> all;
  for (const Guide& guide : world.guides) {
    std::optional<Constraint>& next = all.emplace_back(guide.constraint);
    for (FeatureOf Constraint::*side : {&Constraint::held, &Constraint::other}) {
      if (!next || ((*next).*side).part != part.id) continue;
      const auto name = name_in(world, part, shape, ((*next).*side).feature);
      if (name)
        ((*next).*side).feature = *name;
      else
        next.reset();
    }
  }
  return all;
}

}  // namespace

PartShapes::AsPart as_part(const World& world, const Part& part) {
  if (world.rules) return world.rules->as_part(part);
  return {part.id, 1, world.shapes->make()};
}

PartShapePtr shape_as(const World& world, const Part& part, const std::string& mesh_hash) {
  if (!world.shapes || !world.shapes->find(mesh_hash).solid) return nullptr;
  return world.shapes->shape(mesh_hash, as_part(world, part));
}

bool is_made_as(const World& world, const Part& part, const std::string& mesh_hash) {
  return world.shapes && world.shapes->is_made(mesh_hash, as_part(world, part));
}

std::string told_of_revision(const World& world, const Part& part, const PartShape& shape) {
  const std::string faces = told_of_faces(part, shape);
  const std::string statements = told_of_statements(world, part, shape);
  std::string told = faces + (faces.empty() || statements.empty() ? "" : "; ") + statements;
  for (const std::string& note : shape.notes) told += (told.empty() ? "" : "; ") + note;
  return told;
}

void revise(World& world, Part& part, const PartShape& shape, const Decision& by) {
  const std::vector<std::optional<Constraint>> constraints = followed(world, part, shape);
  part.solid = shape.solid;
  part.features = shape.features;
  part.band = shape.band;
  std::uint32_t kind = 0;
  for (const Part& other : world.parts) kind = std::max(kind, other.kind + 1);
  part.kind = kind;
  note_mesh(world, part.id.value - 1);
  if (world.rules) {
    Decision about = by;
    about.part = part.id;
    about.details.other_part = PartId{};
    apply_change(world, about, world.rules->revise(world, part.id, shape));
  }
  world.evaluates = evaluates(world);
  std::vector<Guide> kept;
  for (std::size_t i = 0; i < constraints.size(); ++i)
    if (constraints[i] && resolve_again(world, world.guides[i], *constraints[i]))
      kept.push_back(world.guides[i]);
  world.guides = std::move(kept);
  Decision& again = world.restated.emplace_back();  // what has to be said to come here again
  again.kind = Decision::Kind::kReplacePart;
  again.part = part.id;
  PartEdit& edit = again.details.edit.emplace();
  edit.mesh_hash = part.solid->hash();
  edit.quantum_mm = world.shapes->find(edit.mesh_hash).quantum_mm;
}

}  // namespace mortise
