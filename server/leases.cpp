#include "server/leases.h"

namespace mortise {
namespace {

std::int64_t lease_ns(const World& world) { return static_cast<std::int64_t>(world.lease_s * 1e9); }

}  // namespace

void Leases::begin_drain(const World& world, std::int64_t now_ns) {
  if (renewed_ns_.size() == world.parts.size() && edits_ == world.edits) return;
  edits_ = world.edits;
  renewed_ns_.resize(world.parts.size(), now_ns);
  moving_.clear();
  for (std::uint32_t i = 0; i < world.parts.size(); ++i)
    if (world.parts[i].present && world.parts[i].moving) moving_.push_back(i);
}

void Leases::renew_all(const World& world, UserId user, std::int64_t now_ns) {
  for (const std::uint32_t i : moving_)
    if (world.parts[i].holder == user) renewed_ns_[i] = now_ns;
}

void Leases::note(const Decision& decision, std::int64_t now_ns) {
  std::vector<PartId> parts = decision.details.parts;
  if (parts.empty() && decision.part) parts.push_back(decision.part);
  if (decision.kind != Decision::Kind::kGrab && decision.kind != Decision::Kind::kHandOver) return;
  for (const PartId part : parts) renew(part, now_ns);
}

std::vector<Decision> Leases::ended(const World& world, std::int64_t now_ns,
                                    const std::function<bool(UserId, PartId)>& moved) const {
  std::vector<Decision> decisions;
  for (const std::uint32_t i : moving_) {
    const Part& part = world.parts[i];
    if (!part.holder || now_ns - renewed_ns_[i] <= lease_ns(world)) continue;
    if (moved(part.holder, part.id)) continue;
    decisions.push_back({Decision::Kind::kLeaseEnd, part.holder, part.id, {}});
  }
  return decisions;
}

}  // namespace mortise
