#pragma once
#include <optional>
#include <string>

#include "common/session/world/part_shapes.h"
#include "common/session/world/world.h"

namespace mortise {

/// Ids of parts that a session may have used, those of removed parts included: each costs memory,
/// and a place in every snapshot of the state. A scenario with more gets none added.
inline constexpr std::size_t kMostSceneParts = 4096;

struct EditReply {
  Refusal refusal = Refusal::kNone;
  std::string text;
};

/// May the user edit the scene so now? Changes nothing. The mesh of an added part is not asked for.
EditReply check_edit(const World& world, const User& user, const Command& command);
/// May the user take this form of a part back, or give it again (undo, redo)?
EditReply check_form(const World& world, const User& user, const Part& part, const PartForm& form);

/// Completes an edit: number and mesh of an added part; mesh of a replaced one, and what becomes of
/// the statements about it. Fails where the mesh is not here.
EditReply complete_edit(const World& world, Decision& decision);

/// Applies a decision that edits_scene(). One that cannot apply changes nothing. Returns whether it
/// did. Costs the pairs of the part in the next tick.
bool apply_edit(World& world, const Decision& decision);

/// The mesh that has to be made usable before the command is carried out, which is slow for a large
/// one: `as` says as what.
struct WantedMesh {
  std::string hash;
  std::optional<PartShapes::AsPart> as;  ///< nothing: as a part of its own
};
/// Nothing: none is missing. Of a command that check_edit() or the history allows.
std::optional<WantedMesh> wanted_mesh(const World& world, const Command& command);

PartForm form_of(const Part& part);
/// Gives the part another form: it comes, goes, begins or ceases to move, or has another mesh,
/// which must be here. Whoever holds what can no longer be held loses it; clashes that can no
/// longer be judged end in the next tick.
void take_form(World& world, Part& part, const PartForm& form, const Decision& by);

/// Applies a decision kAddPart, or kReplacePart, to a scene that is restored: the part stands as it
/// came in, and is judged by nobody yet. False: its mesh is not here.
bool restate_edit(World& world, const Decision& decision);

/// A part with the next number, as a decision kAddPart says. Null: its mesh is not here.
Part* append_part(World& world, const Decision& decision);

}  // namespace mortise
