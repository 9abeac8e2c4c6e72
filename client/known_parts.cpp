#include "client/known_parts.h"

#include <algorithm>
#include <utility>

namespace mortise {

PartId KnownParts::find(const std::string& name) const {
  for (const auto& [id, part] : parts_) {
    if (part.info.name == name) return id;
  }
  return {};
}

std::vector<PartId> KnownParts::take_changed() {
  const std::set<PartId> changed = std::exchange(changed_, {});
  return {changed.begin(), changed.end()};
}

void KnownParts::set_holder(PartId id, UserId holder) {
  const auto found = parts_.find(id);
  if (found == parts_.end() || found->second.info.holder == holder) return;
  found->second.info.holder = holder;
  changed_.insert(id);
}

bool KnownParts::apply_edit(const Decision& decision) {
  if (!edits_scene(decision.kind)) return false;
  if (decision.kind == Decision::Kind::kRemovePart) {
    parts_.erase(decision.part);
    return true;
  }
  if (!decision.details.edit) return false;
  const PartEdit& edit = *decision.details.edit;
  if (decision.kind == Decision::Kind::kAddPart) {
    PartInfo& info = parts_[decision.part].info;
    info.part = decision.part;
    info.name = edit.name;
    info.mesh_hash = edit.mesh_hash;
    info.moving = edit.moving;
    info.X_WP = edit.X_WP;
  } else if (const auto known = parts_.find(decision.part); known != parts_.end()) {
    if (decision.kind == Decision::Kind::kSetMoving)
      known->second.info.moving = edit.moving;
    else
      known->second.info.mesh_hash = edit.mesh_hash;
  }
  changed_.insert(decision.part);
  return true;
}

bool KnownParts::take(const Snapshot& snapshot) {
  std::map<PartId, KnownPart> parts;
  for (const PartInfo& info : snapshot.parts) {
    KnownPart& part = parts[info.part];
    part.info = info;
    part.tick = snapshot.tick;
    const auto known = parts_.find(info.part);
    if (known != parts_.end() && known->second.tick > snapshot.tick) {
      part.info.X_WP = known->second.info.X_WP;
      part.info.holder = known->second.info.holder;
      part.tick = known->second.tick;
    }
    if (known == parts_.end() || known->second.info.holder != part.info.holder ||
        !identical(known->second.info.X_WP, part.info.X_WP)) {
      changed_.insert(info.part);
    }
  }
  const bool is_other = !std::ranges::equal(parts, parts_, [](const auto& x, const auto& y) {
    return x.first == y.first && x.second.info.name == y.second.info.name &&
           x.second.info.mesh_hash == y.second.info.mesh_hash &&
           x.second.info.moving == y.second.info.moving &&
           // Of a part that was added, a snapshot alone tells these.
           x.second.info.radius_mm == y.second.info.radius_mm &&
           x.second.info.reference_P == y.second.info.reference_P;
  });
  parts_ = std::move(parts);
  return is_other;
}

bool KnownParts::take(const PartPose& pose, std::uint64_t tick, bool may_be_new) {
  if (!may_be_new && !parts_.contains(pose.part)) return true;
  KnownPart& part = parts_[pose.part];
  part.info.part = pose.part;
  if (tick < part.tick) return false;
  part.tick = tick;
  part.info.X_WP = pose.X_WP;
  part.info.holder = pose.holder;
  changed_.insert(pose.part);
  return true;
}

void KnownParts::forget_server() {
  for (auto& [id, part] : parts_) part.tick = 0;  // another server counts anew
}

}  // namespace mortise
