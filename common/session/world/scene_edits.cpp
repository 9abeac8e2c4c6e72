#include "common/session/world/scene_edits.h"

#include <algorithm>

#include "common/session/guide/guidance.h"
#include "common/session/memory/session_state.h"
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

EditReply check_add(const World& world, const PartEdit& edit) {
  if (const EditReply bad = check_name(world, edit.name, {}); bad.refusal != Refusal::kNone)
    return bad;
  if (!valid(edit.X_WP)) return bad_part("the pose of '" + edit.name + "' is out of the world");
  if (world.parts.size() < kMostSceneParts) return {};
  return {Refusal::kTooManyParts, "the session has had " + std::to_string(world.parts.size()) +
                                      " parts, removed ones included: no more are taken"};
}

}  // namespace

EditReply check_edit(const World& world, const User& user, const Command& command) {
  if (EditReply no = check_right(world, user); no.refusal != Refusal::kNone) return no;
  if (command.kind == CommandKind::kReplacePart)
    return {Refusal::kNotAllowed,
            "parts are not replaced here: remove this one and add the new one"};
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
  return {};
}

EditReply check_form(const World& world, const User& user, const Part& part, const PartForm& form) {
  if (EditReply no = check_right(world, user); no.refusal != Refusal::kNone) return no;
  if (EditReply no = check_free(world, user, part); no.refusal != Refusal::kNone) return no;
  return form.present ? check_name(world, part.name, part.id) : EditReply{};
}

EditReply complete_edit(const World& world, Decision& decision) {
  if (decision.kind != Decision::Kind::kAddPart) return {};
  PartEdit& edit = *decision.details.edit;
  const PartShapes::Mesh mesh =
      world.shapes ? world.shapes->find(edit.mesh_hash) : PartShapes::Mesh{};
  if (!mesh.solid)
    return {Refusal::kUnknownMesh, "no mesh " + edit.mesh_hash + " was uploaded: send it first"};
  edit.quantum_mm = mesh.quantum_mm;
  decision.part = PartId{static_cast<std::uint32_t>(world.parts.size() + 1)};
  return {};
}

PartForm form_of(const Part& part) { return {part.present, part.moving}; }

void take_form(World& world, Part& part, const PartForm& form, const Decision& by) {
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
  if (!decision.details.text.empty()) part.notes.push_back(decision.details.text);
  part.present = false;
  if (world.rules) world.rules->add_part(part);
  world.restated.push_back(decision);
  return &part;
}

bool apply_edit(World& world, const Decision& decision) {
  const bool adds = decision.kind == Decision::Kind::kAddPart;
  const auto& edit = decision.details.edit;
  // In a replay of a changed scene the numbers may be other ones: then it is another part.
  if (adds && decision.part.value != world.parts.size() + 1) return false;
  if (!edit && decision.kind != Decision::Kind::kRemovePart) return false;
  Part* part = adds ? append_part(world, decision) : world.find_present(decision.part);
  if (part == nullptr) return false;
  PartForm form = form_of(*part);
  part->history.note_edit(decision.user, part->X_WP, form);
  if (adds) form = {true, edit->moving};
  if (decision.kind == Decision::Kind::kRemovePart) form.present = false;
  if (decision.kind == Decision::Kind::kSetMoving) form.moving = edit->moving;
  take_form(world, *part, form, decision);
  return true;
}

}  // namespace mortise
