#include "common/session/world/scene_edits.h"

#include <algorithm>

#include "common/session/guide/guidance.h"
#include "common/session/memory/session_state.h"
#include "common/session/world/part_revision.h"
#include "common/session/world/part_shapes.h"
#include "common/session/world/placing.h"
#include "common/session/world/rights.h"
#include "common/session/world/surface_rules.h"

namespace mortise {
namespace {

EditReply bad_part(std::string text) { return {Refusal::kBadPart, std::move(text)}; }

EditReply check_right(const World& world, const User& user) {
  if (may_change(world, user, Right::kParts)) return {};
  return {Refusal::kNoRight, "'" + user.name + "' may not change parts in this scenario"};
}

EditReply check_name(const World& world, const std::string& name, PartId but) {
  if (!is_part_name(name))
    return bad_part("'" + name + "' is no name of a part: one word without '.' and '*'");
  const Part* other = world.find_part(name);
  if (other == nullptr || other->id == but) return {};
  return bad_part("the session has a part '" + name + "' already; choose another name");
}

EditReply check_free(const World& world, const User& user, const Part& part) {
  if (!part.holder || part.holder == user.id) return {};
  return {Refusal::kHeldByOther,
          "'" + part.name + "' is held by " + quoted_name(world, part.holder)};
}

EditReply unknown_mesh(const std::string& hash) {
  return {Refusal::kUnknownMesh, "no mesh " + hash + " was uploaded: send it first"};
}

EditReply check_add(const World& world, const PartEdit& edit) {
  if (const EditReply bad = check_name(world, edit.name, {}); bad.refusal != Refusal::kNone)
    return bad;
  if (!valid(edit.X_WP)) return bad_part("the pose of '" + edit.name + "' is out of the world");
  if (world.parts.size() < kMostSceneParts) return {};
  return {Refusal::kTooManyParts, "the session has had " + std::to_string(world.parts.size()) +
                                      " parts, removed ones included: no more are taken"};
}

bool names_mesh(Decision::Kind kind) {
  return kind == Decision::Kind::kAddPart || kind == Decision::Kind::kReplacePart;
}

std::vector<std::string> notes_of(const Decision& decision) {
  const std::string& text = decision.details.text;
  return text.empty() ? std::vector<std::string>{} : std::vector<std::string>{text};
}

// Is the mesh of a decision here? A log says in the decision alone how exact it is.
bool has_mesh(const World& world, const PartEdit& edit) {
  const SolidPtr solid = world.shapes ? world.shapes->find(edit.mesh_hash).solid : nullptr;
  if (solid) world.shapes->note_quantum(edit.mesh_hash, edit.quantum_mm);
  return solid != nullptr;
}

}  // namespace

EditReply check_edit(const World& world, const User& user, const Command& command) {
  if (EditReply no = check_right(world, user); no.refusal != Refusal::kNone) return no;
  const bool says_how = command.details.edit.has_value();
  if (!says_how && command.kind != CommandKind::kRemovePart)
    return bad_part("the command does not say how the part is to be");
  if (command.kind == CommandKind::kAddPart) return check_add(world, *command.details.edit);
  const Part* part = world.find_present(command.part);
  if (part == nullptr)
    return {Refusal::kUnknownPart, "there is no part " + std::to_string(command.part.value)};
  if (EditReply no = check_free(world, user, *part); no.refusal != Refusal::kNone) return no;
  if (command.kind == CommandKind::kSetMoving && part->moving == command.details.edit->moving)
    return bad_part("'" + part->name + "' is " + (part->moving ? "moving" : "static") + " already");
  if (command.kind == CommandKind::kReplacePart &&
      part->solid->hash() == command.details.edit->mesh_hash)
    return bad_part("'" + part->name + "' has this mesh already");
  return {};
}

EditReply check_form(const World& world, const User& user, const Part& part, const PartForm& form) {
  if (EditReply no = check_right(world, user); no.refusal != Refusal::kNone) return no;
  if (EditReply no = check_free(world, user, part); no.refusal != Refusal::kNone) return no;
  if (form.mesh != part.solid->hash() && (!world.shapes || !world.shapes->find(form.mesh).solid))
    return unknown_mesh(form.mesh);
  return form.present ? check_name(world, part.name, part.id) : EditReply{};
}

EditReply complete_edit(const World& world, Decision& decision) {
  if (!names_mesh(decision.kind)) return {};
  PartEdit& edit = *decision.details.edit;
  const PartShapes::Mesh mesh =
      world.shapes ? world.shapes->find(edit.mesh_hash) : PartShapes::Mesh{};
  if (!mesh.solid) return unknown_mesh(edit.mesh_hash);
  edit.quantum_mm = mesh.quantum_mm;
  if (decision.kind == Decision::Kind::kAddPart) {
    decision.part = PartId{static_cast<std::uint32_t>(world.parts.size() + 1)};
    return {};
  }
  const Part& part = *world.find(decision.part);
  edit.name = part.name;
  edit.moving = part.moving;
  const std::string told = told_of_revision(world, part, *shape_as(world, part, edit.mesh_hash));
  std::string& text = decision.details.text;
  text += (text.empty() || told.empty() ? "" : "; ") + told;
  return {};
}

std::optional<WantedMesh> wanted_mesh(const World& world, const Command& command) {
  const auto& edit = command.details.edit;
  if (command.kind == CommandKind::kAddPart && edit) return WantedMesh{edit->mesh_hash, {}};
  const Part* part = world.find(command.part);
  if (part == nullptr || !world.shapes) return std::nullopt;
  std::optional<std::string> hash;
  if (command.kind == CommandKind::kReplacePart && edit) hash = edit->mesh_hash;
  const bool undo = command.kind == CommandKind::kUndo;
  if (undo || command.kind == CommandKind::kRedo) {
    const auto form =
        undo ? part->history.form_of_undo() : part->history.form_of_redo(command.user);
    if (form && form->mesh != part->solid->hash()) hash = form->mesh;
  }
  if (!hash || is_made_as(world, *part, *hash)) return std::nullopt;
  return WantedMesh{*hash, as_part(world, *part)};
}

PartForm form_of(const Part& part) {
  return {part.present, part.moving, part.solid->hash(), part.notes};
}

void take_form(World& world, Part& part, const PartForm& form, const Decision& by) {
  if (form.mesh != part.solid->hash())
    if (const PartShapePtr shape = shape_as(world, part, form.mesh))
      revise(world, part, *shape, by);
  part.notes = form.notes;
  part.present = form.present;
  part.moving = form.moving;
  ++part.edits;
  ++world.edits;
  if (part.holder && !(part.present && part.moving)) give(world, part, UserId{});
  part.asked_by = UserId{};
  if (!part.present)
    std::erase_if(world.guides,
                  [&](const Guide& guide) { return guide.constraint.other.part == part.id; });
  note_form(world, part.id.value - 1, by);
}

Part* append_part(World& world, const Decision& decision) {
  if (!world.shapes || !decision.details.edit) return nullptr;
  const PartEdit& edit = *decision.details.edit;
  const PartShapePtr shape = world.shapes->shape(edit.mesh_hash, edit.quantum_mm);
  if (!shape || !valid(edit.X_WP)) return nullptr;
  Part& part = world.parts.emplace_back();
  part.id = PartId{static_cast<std::uint32_t>(world.parts.size())};
  part.name = edit.name;
  part.solid = shape->solid;
  part.features = shape->features;
  part.band = shape->band;
  part.X_WP = part.X_WP_scenario = edit.X_WP;
  for (const Part& other : world.parts) part.kind = std::max(part.kind, other.kind + 1);
  part.notes = notes_of(decision);
  part.present = false;
  if (world.rules) world.rules->add_part(part, *shape);
  world.evaluates = evaluates(world);
  world.restated.push_back(decision);
  return &part;
}

bool restate_edit(World& world, const Decision& decision) {
  if (decision.kind == Decision::Kind::kAddPart) return append_part(world, decision) != nullptr;
  Part* part = world.find(decision.part);
  const auto& edit = decision.details.edit;
  if (part == nullptr || !edit || !has_mesh(world, *edit)) return false;
  revise(world, *part, *shape_as(world, *part, edit->mesh_hash), decision);
  return true;
}

bool apply_edit(World& world, const Decision& decision) {
  const bool adds = decision.kind == Decision::Kind::kAddPart;
  const bool replaces = decision.kind == Decision::Kind::kReplacePart;
  const auto& edit = decision.details.edit;
  // In a replay of a changed scene the numbers may be other ones: then it is another part.
  if (adds && decision.part.value != world.parts.size() + 1) return false;
  if (!edit && decision.kind != Decision::Kind::kRemovePart) return false;
  Part* part = adds ? append_part(world, decision) : world.find_present(decision.part);
  if (part == nullptr) return false;
  if (replaces && !has_mesh(world, *edit)) return false;
  PartForm form = form_of(*part);
  part->history.note_edit(decision.user, part->X_WP, form);
  if (replaces) {
    form.mesh = edit->mesh_hash;
    form.notes = notes_of(decision);
  }
  if (adds) form.present = true, form.moving = edit->moving;
  if (decision.kind == Decision::Kind::kRemovePart) form.present = false;
  if (decision.kind == Decision::Kind::kSetMoving) form.moving = edit->moving;
  take_form(world, *part, form, decision);
  return true;
}

}  // namespace mortise
