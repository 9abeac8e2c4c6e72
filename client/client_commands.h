#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "client/client_update.h"

namespace mortise {

/// The commands of a client's users, each by its name.
class ClientCommands {
 public:
  /// Commands return the sequence number that the reply will echo, or 0 when the user has not
  /// joined (counted). The reason of a refusal is in the reply; what was done is in
  /// ClientUpdate::decisions.
  std::uint64_t command(LocalUser user, CommandKind kind, PartId part, Details details = {}) {
    return send_command(user, kind, part, std::move(details));
  }
  std::uint64_t grab(LocalUser user, PartId part);
  std::uint64_t grab(LocalUser user, std::vector<PartId> parts);  ///< all or none, as one body
  std::uint64_t release(LocalUser user, PartId part);
  std::uint64_t release(LocalUser user, std::vector<PartId> parts);
  std::uint64_t undo(LocalUser user, PartId part);
  std::uint64_t redo(LocalUser user, PartId part);
  std::uint64_t reset(LocalUser user, PartId part);
  /// Asks its holder for a part, until the decision kHandOver, kDecline or kAskEnd, or until the
  /// holder has let it go.
  std::uint64_t ask_hand_over(LocalUser user, PartId part);
  std::uint64_t withdraw(LocalUser user, PartId part);  ///< asks no longer
  std::uint64_t consent(LocalUser user, PartId part);   ///< to the user who asked for it
  std::uint64_t decline(LocalUser user, PartId part, const std::string& why = "");
  std::uint64_t set_policy(LocalUser user, const std::string& policy);
  /// text as in a scenario ("±0.05", "H7"), of the whole part or one feature; empty: nothing.
  std::uint64_t set_tolerance(LocalUser user, PartId part, const std::string& feature,
                              const std::string& text);
  /// Of a pair, as a fit of a scenario ("H7/g6", "±0.05"); features may be empty.
  std::uint64_t set_fit(LocalUser user, const FeatureOf& a, const FeatureOf& b,
                        const std::string& text);
  std::uint64_t exclude(LocalUser user, PartId a, PartId b, const std::string& reason);
  std::uint64_t include(LocalUser user, PartId a, PartId b);  ///< drops the exclusion
  std::uint64_t review(LocalUser user, ClashId clash, ReviewStatus status,
                       const std::string& comment = "", UserId assignee = {});
  std::uint64_t add_constraint(LocalUser user, const Constraint& constraint);
  /// Constrains a held part to the nearest feature that fits, and moves it there. The server
  /// chooses what is left empty; the reply says in words what it chose, the decision kAddConstraint
  /// in values.
  std::uint64_t snap(LocalUser user, PartId held, const FeatureOf& other = {},
                     const std::string& feature = "",
                     ConstraintKind kind = ConstraintKind::kUnknown);
  std::uint64_t drop_constraint(LocalUser user, PartId held, ConstraintId constraint);

  /// Scene edits. mesh_hash: content_hash() of a file that this user uploads (see Client::upload),
  /// or PartInfo::mesh_hash of any mesh of the session. The reply comes once the mesh is prepared;
  /// the number of an added part is in the decision kAddPart.
  std::uint64_t add_part(LocalUser user, const std::string& name, const std::string& mesh_hash,
                         const Pose& X_WP, bool moving);
  /// The part keeps number, name, pose and what is said of it.
  std::uint64_t replace_part(LocalUser user, PartId part, const std::string& mesh_hash);
  std::uint64_t remove_part(LocalUser user, PartId part);
  std::uint64_t set_moving(LocalUser user, PartId part, bool moving);

 protected:
  ~ClientCommands() = default;

 private:
  virtual std::uint64_t send_command(LocalUser user, CommandKind kind, PartId part,
                                     Details details) = 0;
};

}  // namespace mortise
