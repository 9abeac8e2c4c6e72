#include "common/session/tick/statistics.h"

#include <algorithm>
#include <set>

namespace mortise {
namespace {

std::size_t index_of(CollisionClass c) { return static_cast<std::size_t>(c); }

bool is_worse(const Verdict& x, const Verdict& y) {
  if (x.collision_class != y.collision_class) return x.collision_class > y.collision_class;
  return x.delta_mm.lo > y.delta_mm.lo;
}

void add(StageCount& into, const StageCount& from) {
  into.in += from.in;
  into.out += from.out;
}

}  // namespace

void accumulate(StepCounters& into, const StepCounters& from) {
  add(into.increments, from.increments);
  for (std::size_t i = 0; i < into.refused.size(); ++i) into.refused[i] += from.refused[i];
  add(into.moves, from.moves);
  into.moves_below_rounding += from.moves_below_rounding;
  add(into.pairs, from.pairs);
  into.pairs_static += from.pairs_static;
  into.pairs_still += from.pairs_still;
  into.pairs_excluded += from.pairs_excluded;
  into.pairs_boxes_apart += from.pairs_boxes_apart;
  into.pairs_budget += from.pairs_budget;
  add(into.contacts, from.contacts);
  into.contacts_clear += from.contacts_clear;
  into.contacts_undecided += from.contacts_undecided;
  into.first_contact_queries += from.first_contact_queries;
  into.distance_queries += from.distance_queries;
  into.depth_queries += from.depth_queries;
  into.event_time_queries += from.event_time_queries;
  into.event_times_at_latest += from.event_times_at_latest;
  into.judged_with_bands += from.judged_with_bands;
  into.judged_plain += from.judged_plain;
  into.regions_decided_early += from.regions_decided_early;
  into.regions_refined += from.regions_refined;
  add(into.verdicts, from.verdicts);
  for (int i = 0; i < 4; ++i) into.verdicts_by_class[i] += from.verdicts_by_class[i];
  into.stopped_parts += from.stopped_parts;
  into.rounds += from.rounds;
  into.slid_parts += from.slid_parts;
  into.slide_legs += from.slide_legs;
  into.slide_holds += from.slide_holds;
  into.slides_cut_short += from.slides_cut_short;
  into.box_tests += from.box_tests;
  into.triangle_tests += from.triangle_tests;
  into.depth_evaluations += from.depth_evaluations;
  into.parts_without_inside += from.parts_without_inside;
  into.pairs_waiting += from.pairs_waiting;
  into.pairs_held_again += from.pairs_held_again;
  into.pushes_cut += from.pushes_cut;
  into.not_examined += from.not_examined;
}

template <class Change>
void SessionStatistics::for_rows_of(const ClashRow& clash, const Change& change) {
  change(by_pair_[{clash.a, clash.b}]);
  change(by_part_[clash.a]);
  change(by_part_[clash.b]);
  if (clash.user) change(by_user_[clash.user]);
}

void SessionStatistics::take_in(const ClashEvent& event) {
  // A log may hold anything: one that begins twice, or ends twice, does so once.
  if (event.kind == ClashEvent::Kind::kBegin && !clashes_.contains(event.clash)) {
    open_.push_back(event.clash);
    ClashRow& row = clashes_[event.clash];
    row.clash = event.clash;
    row.a = event.part_a;
    row.b = event.part_b;
    row.user = event.user;  // who caused it: later events may name who moved on
    row.begin_tick = event.begin_tick;
    row.worst = event.verdict;
    ++total_[index_of(row.worst_class)];
    for_rows_of(row, [&](Row& sum) { ++sum.clashes[index_of(row.worst_class)]; });
  }
  const auto known = clashes_.find(event.clash);
  if (known == clashes_.end()) return;  // its begin was never seen: a report is missing
  ClashRow& clash = known->second;
  const CollisionClass worst = std::max(clash.worst_class, event.worst_class);
  if (is_worse(event.verdict, clash.worst)) clash.worst = event.verdict;
  --total_[index_of(clash.worst_class)];
  ++total_[index_of(worst)];
  for_rows_of(clash, [&](Row& row) {
    --row.clashes[index_of(clash.worst_class)];
    ++row.clashes[index_of(worst)];
    if (row.first_tick == 0) row.first_tick = event.tick;
    row.last_tick = event.tick;
    if (row.worst_tick != 0 && !is_worse(event.verdict, row.worst)) return;
    row.worst = event.verdict;
    row.worst_tick = event.tick;
  });
  clash.worst_class = worst;
  clash.now = event.verdict.collision_class;
  if (event.kind == ClashEvent::Kind::kEnd) end(clash, event.tick);
}

void SessionStatistics::end(ClashRow& clash, std::uint64_t tick) {
  if (std::erase(open_, clash.clash) > 0) ended_.push_back(clash.clash);
  clash.end_tick = tick;
  clash.now = CollisionClass::kNone;
  drop_old_rows();
}

void SessionStatistics::keep_ended_rows(std::size_t most) {
  most_ended_ = most;
  drop_old_rows();
}

void SessionStatistics::drop_old_rows() {
  if (ended_.size() <= most_ended_) return;
  const auto kept = ended_.end() - static_cast<std::ptrdiff_t>(most_ended_);
  for (auto id = ended_.begin(); id != kept; ++id, ++rows_left_out_) clashes_.erase(*id);
  ended_.erase(ended_.begin(), kept);
}

void SessionStatistics::add(const StepReport& report) {
  ++ticks_;
  accumulate(counters_, report.counters);
  for (const ClashEvent& event : report.events) take_in(event);
  last_longer(1);
}

void SessionStatistics::add_idle(std::uint64_t ticks) {
  ticks_ += ticks;
  last_longer(ticks);
}

void SessionStatistics::last_longer(std::uint64_t ticks) {
  for (const ClashId id : open_) {
    ClashRow& clash = clashes_.at(id);
    clash.ticks[index_of(clash.now)] += ticks;
    for_rows_of(clash, [&](Row& row) { row.ticks[index_of(clash.now)] += ticks; });
  }
}

void SessionStatistics::forget_users(std::span<const Decision> decisions) {
  for (const Decision& decision : decisions) {
    if (!takes_over_id(decision)) continue;
    by_user_.erase(decision.user);
    for (auto& [id, clash] : clashes_)
      if (clash.user == decision.user) clash.user = UserId{};
  }
}

bool SessionStatistics::is_whole() const {
  std::set<ClashId> told;  // each is open or ended, once
  const auto known = [&](ClashId id) { return clashes_.contains(id) && told.insert(id).second; };
  const auto is_class = [](CollisionClass c) { return index_of(c) < 4; };
  return open_.size() + ended_.size() == clashes_.size() &&
         std::all_of(open_.begin(), open_.end(), known) &&
         std::all_of(ended_.begin(), ended_.end(), known) &&
         std::all_of(clashes_.begin(), clashes_.end(), [&](const auto& entry) {
           return is_class(entry.second.now) && is_class(entry.second.worst_class);
         });
}

std::uint64_t SessionStatistics::clashes_open(CollisionClass c) const {
  return static_cast<std::uint64_t>(std::count_if(
      open_.begin(), open_.end(), [&](ClashId id) { return clashes_.at(id).now == c; }));
}

std::uint64_t SessionStatistics::clashes_total(CollisionClass c) const {
  return total_[index_of(c)];
}

}  // namespace mortise
