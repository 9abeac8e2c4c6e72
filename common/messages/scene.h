#pragma once
#include <string>
#include <vector>

#include "common/base/ids.h"
#include "common/math/pose.h"
#include "common/messages/event.h"

namespace mortise {

/// What a participant is told of a part.
struct PartInfo {
  PartId part;
  std::string name;
  std::string mesh_hash;  ///< content hash of the mesh, see geometry/mesh.h
  bool moving = false;
  UserId holder;
  Pose X_WP;
  Vec3 reference_P = Vec3::Zero();  ///< centre of the bounding sphere, part frame, mm
  double radius_mm = 0.0;           ///< of the bounding sphere
};

/// What was found when the mesh of a part was read: its file states another unit, triangles were
/// turned or dropped, it has no inside. A sentence for people.
struct PartNote {
  PartId part;
  std::string text;
};

struct UserInfo {
  UserId user;
  std::string name;
  bool present = false;
  Role role = Role::kUnknown;
};

/// All that a late joiner needs; the live stream continues with event_seq + 1.
struct Snapshot {
  std::string session;
  std::uint64_t tick = 0;
  std::uint64_t event_seq = 0;
  double tick_rate_hz = 60.0;
  std::string policy;
  std::vector<PartInfo> parts;
  std::vector<UserInfo> users;
  std::vector<ClashEvent> open_clashes;
  /// Earlier decisions that are in force: policy, tolerances, exclusions, constraints, and
  /// hand-over requests that are not answered yet. Only the session knows which decision ends or
  /// replaces which; it tells changes to this list as StandingChange.
  std::vector<Decision> standing;
  std::vector<PartNote> notes;  ///< by part
  /// What was said of the open clashes, in order. Later ones are told as decisions of kind kReview.
  std::vector<Remark> remarks;
};

}  // namespace mortise
