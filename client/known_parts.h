#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "client/client_update.h"

namespace mortise {

/// What a client knows of the parts of its session: from snapshots, poses and scene edits.
class KnownParts {
 public:
  const std::map<PartId, KnownPart>& all() const { return parts_; }
  PartId find(const std::string& name) const;  ///< none when unknown

  /// Parts with a new pose or holder since the last call, by id.
  std::vector<PartId> take_changed();

  void set_holder(PartId part, UserId holder);
  /// Returns whether it edits the scene. The rest of an added or replaced part, and what an undo
  /// brings back, is in the snapshot that follows.
  bool apply_edit(const Decision& decision);
  /// Returns whether parts were added, removed or changed.
  bool take(const Snapshot& snapshot);
  /// False where a later pose is known. `may_be_new`: a part may be known by its pose alone.
  bool take(const PartPose& pose, std::uint64_t tick, bool may_be_new);
  void forget_server();

 private:
  std::map<PartId, KnownPart> parts_;
  std::set<PartId> changed_;
};

}  // namespace mortise
