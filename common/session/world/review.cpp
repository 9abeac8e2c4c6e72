#include "common/session/world/review.h"

#include <algorithm>
#include <cstdio>
#include <set>

#include "common/messages/names.h"

namespace mortise {
namespace {

// Most remarks of one clash; the oldest go.
constexpr std::size_t kMostRemarks = 64;

void add_remark(World& world, const Decision& decision) {
  std::set<ClashId> open;
  for (const auto& [pair, clashes] : world.state->open)
    for (const OpenClash& clash : clashes) open.insert(clash.last.clash);
  std::vector<Remark>& remarks = world.remarks;
  std::erase_if(remarks, [&](const Remark& remark) { return !open.contains(remark.clash); });
  const Details& said = decision.details;
  const auto of_clash = [&](const Remark& remark) { return remark.clash == said.clash; };
  if (std::ranges::count_if(remarks, of_clash) >= static_cast<std::ptrdiff_t>(kMostRemarks))
    remarks.erase(std::ranges::find_if(remarks, of_clash));
  remarks.push_back(
      {said.clash, decision.user, said.other_user, said.status, world.tick + 1, said.text});
}

std::string depth_text(const Interval& delta_mm) {
  char text[64];
  std::snprintf(text, sizeof text, "%.4g mm deep", delta_mm.lo);
  return text;
}

}  // namespace

const OpenClash* find_open(const World& world, ClashId clash) {
  if (!world.state || !clash) return nullptr;
  for (const auto& [pair, clashes] : world.state->open)
    for (const OpenClash& open : clashes)
      if (open.last.clash == clash) return &open;
  return nullptr;
}

OpenClash* find_open(World& world, ClashId clash) {
  return const_cast<OpenClash*>(find_open(std::as_const(world), clash));
}

void review(World& world, const Decision& decision) {
  OpenClash* clash = find_open(world, decision.details.clash);
  if (clash == nullptr) return;
  clash->last.review = {decision.details.status, decision.details.text, decision.user,
                        world.tick + 1};
  add_remark(world, decision);
  clash->approved_class = clash->now.collision_class;
  clash->approved_delta_mm = clash->now.delta_mm;
  ClashEvent event = clash->last;
  event.kind = ClashEvent::Kind::kReview;
  event.user = decision.user;
  event.cause = Decision::Kind::kReview;
  event.approval_lost = false;
  world.state->reviews.push_back(std::move(event));
  world.state->clashes_changed = true;
}

void approve_where_it_starts(const World& world, const SessionState& state, OpenClash& clash) {
  const auto approval = world.approved_at_start.find({clash.last.part_a, clash.last.part_b});
  if (approval == world.approved_at_start.end()) return;
  for (const PartId id : {clash.last.part_a, clash.last.part_b})
    if (const PartState& part = state.parts[id.value - 1]; part.last_tick + part.placements > 0)
      return;
  clash.last.review = {ReviewStatus::kApproved, approval->second, UserId{}, world.tick};
  clash.approved_class = clash.now.collision_class;
  clash.approved_delta_mm = clash.now.delta_mm;
}

void tell_reviews(const World& world, SessionState& state, StepReport& report) {
  for (ClashEvent& event : state.reviews) {
    event.seq = ++state.event_seq;
    event.tick = world.tick;
    report.events.push_back(std::move(event));
  }
  state.reviews.clear();
}

bool is_worse_than_approved(const OpenClash& clash, double hysteresis_mm) {
  if (clash.last.review.status != ReviewStatus::kApproved) return false;
  if (clash.now.collision_class != clash.approved_class)
    return clash.now.collision_class > clash.approved_class;
  return clash.now.delta_mm.lo > clash.approved_delta_mm.hi + hysteresis_mm;
}

void take_back_approval(OpenClash& clash, std::uint64_t tick) {
  const bool other_class = clash.now.collision_class != clash.approved_class;
  Review& review = clash.last.review;
  const std::string before = other_class ? std::string(name_of(clash.approved_class))
                                         : depth_text(clash.approved_delta_mm);
  const std::string now = other_class ? std::string(name_of(clash.now.collision_class))
                                      : depth_text(clash.now.delta_mm);
  review.comment = "no longer approved: was " + before + ", is " + now +
                   (review.comment.empty() ? "" : "; before: " + review.comment);
  review.status = ReviewStatus::kActive;
  review.user = UserId{};
  review.tick = tick;
}

}  // namespace mortise
