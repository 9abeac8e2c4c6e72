#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/session/world/world.h"

namespace mortise {

/// How long a holder keeps a part that is not used: World::lease_s. What somebody asks the holder
/// stays until it is answered or withdrawn.
class Leases {
 public:
  /// Before each drain. The parts of a world do not change.
  void begin_drain(const World& world, std::int64_t now_ns);

  void renew(PartId part, std::int64_t now_ns) { renewed_ns_[part.value - 1] = now_ns; }
  void renew_all(const World& world, UserId user, std::int64_t now_ns);
  /// A grab or hand-over begins a lease.
  void note(const Decision& decision, std::int64_t now_ns);

  /// Leases that end now. A part keeps its lease while increments of it wait (`moved`).
  std::vector<Decision> ended(const World& world, std::int64_t now_ns,
                              const std::function<bool(UserId, PartId)>& moved) const;

  /// Parts that can be held, by index: not all of a scene.
  std::span<const std::uint32_t> moving() const { return moving_; }

 private:
  std::uint64_t edits_ = 0;  ///< World::edits when the list was made
  std::vector<std::uint32_t> moving_;
  std::vector<std::int64_t> renewed_ns_;  ///< by part index
};

}  // namespace mortise
