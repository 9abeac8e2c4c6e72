#include "client/client_commands.h"

#include <utility>

namespace mortise {
namespace {

Details of_group(std::vector<PartId> parts) {
  Details details;
  details.parts = std::move(parts);
  return details;
}

Details of_pair(PartId other, const std::string& text) {
  Details details;
  details.other_part = other;
  details.text = text;
  return details;
}

Details of_text(const std::string& text) {
  Details details;
  details.text = text;
  return details;
}

Details of_edit(PartEdit edit) {
  Details details;
  details.edit = std::move(edit);
  return details;
}

}  // namespace

std::uint64_t ClientCommands::grab(LocalUser user, PartId part) {
  return command(user, CommandKind::kGrab, part);
}
std::uint64_t ClientCommands::grab(LocalUser user, std::vector<PartId> parts) {
  return command(user, CommandKind::kGrab, PartId{}, of_group(std::move(parts)));
}
std::uint64_t ClientCommands::release(LocalUser user, PartId part) {
  return command(user, CommandKind::kRelease, part);
}
std::uint64_t ClientCommands::release(LocalUser user, std::vector<PartId> parts) {
  return command(user, CommandKind::kRelease, PartId{}, of_group(std::move(parts)));
}
std::uint64_t ClientCommands::undo(LocalUser user, PartId part) {
  return command(user, CommandKind::kUndo, part);
}
std::uint64_t ClientCommands::redo(LocalUser user, PartId part) {
  return command(user, CommandKind::kRedo, part);
}
std::uint64_t ClientCommands::reset(LocalUser user, PartId part) {
  return command(user, CommandKind::kReset, part);
}
std::uint64_t ClientCommands::ask_hand_over(LocalUser user, PartId part) {
  return command(user, CommandKind::kAskHandOver, part);
}

std::uint64_t ClientCommands::withdraw(LocalUser user, PartId part) {
  return command(user, CommandKind::kWithdraw, part);
}
std::uint64_t ClientCommands::consent(LocalUser user, PartId part) {
  return command(user, CommandKind::kConsent, part);
}
std::uint64_t ClientCommands::decline(LocalUser user, PartId part, const std::string& why) {
  return command(user, CommandKind::kDecline, part, of_text(why));
}
std::uint64_t ClientCommands::set_policy(LocalUser user, const std::string& policy) {
  return command(user, CommandKind::kSetPolicy, PartId{}, of_text(policy));
}
std::uint64_t ClientCommands::set_tolerance(LocalUser user, PartId part, const std::string& feature,
                                            const std::string& text) {
  Details details = of_text(text);
  details.feature = feature;
  return command(user, CommandKind::kSetTolerance, part, std::move(details));
}
std::uint64_t ClientCommands::set_fit(LocalUser user, const FeatureOf& a, const FeatureOf& b,
                                      const std::string& text) {
  Details details = of_pair(b.part, text);
  details.feature = a.feature;
  details.other_feature = b.feature;
  return command(user, CommandKind::kSetTolerance, a.part, std::move(details));
}
std::uint64_t ClientCommands::exclude(LocalUser user, PartId a, PartId b,
                                      const std::string& reason) {
  return command(user, CommandKind::kSetExclusion, a, of_pair(b, reason));
}
std::uint64_t ClientCommands::include(LocalUser user, PartId a, PartId b) {
  return command(user, CommandKind::kDropExclusion, a, of_pair(b, ""));
}
std::uint64_t ClientCommands::review(LocalUser user, ClashId clash, ReviewStatus status,
                                     const std::string& comment, UserId assignee) {
  Details details = of_text(comment);
  details.other_user = assignee;
  details.clash = clash;
  details.status = status;
  return command(user, CommandKind::kReview, PartId{}, std::move(details));
}
std::uint64_t ClientCommands::add_constraint(LocalUser user, const Constraint& constraint) {
  Details details;
  details.constraint = constraint;
  return command(user, CommandKind::kAddConstraint, constraint.held.part, std::move(details));
}
std::uint64_t ClientCommands::snap(LocalUser user, PartId held, const FeatureOf& other,
                                   const std::string& feature, ConstraintKind kind) {
  Details details;
  details.constraint = {kind, {held, feature}, other, 0.0, true};
  return command(user, CommandKind::kSnap, held, std::move(details));
}
std::uint64_t ClientCommands::add_part(LocalUser user, const std::string& name,
                                       const std::string& mesh_hash, const Pose& X_WP,
                                       bool moving) {
  return command(user, CommandKind::kAddPart, PartId{},
                 of_edit({name, mesh_hash, X_WP, moving, 0.0}));
}
std::uint64_t ClientCommands::replace_part(LocalUser user, PartId part,
                                           const std::string& mesh_hash) {
  return command(user, CommandKind::kReplacePart, part, of_edit({"", mesh_hash, {}, false, 0.0}));
}
std::uint64_t ClientCommands::remove_part(LocalUser user, PartId part) {
  return command(user, CommandKind::kRemovePart, part);
}
std::uint64_t ClientCommands::set_moving(LocalUser user, PartId part, bool moving) {
  return command(user, CommandKind::kSetMoving, part, of_edit({"", "", {}, moving, 0.0}));
}
std::uint64_t ClientCommands::drop_constraint(LocalUser user, PartId held,
                                              ConstraintId constraint) {
  Details details;
  details.constraint_id = constraint;
  return command(user, CommandKind::kDropConstraint, held, std::move(details));
}

}  // namespace mortise
