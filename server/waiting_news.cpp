#include "server/waiting_news.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/messages/names.h"

namespace mortise {
namespace {

std::string name_of_part(const World& world, PartId id) {
  const Part* part = world.find(id);
  return part != nullptr ? part->name : "?";
}

}  // namespace

std::string WaitingNews::after_tick(const StepReport& report, const World& world) {
  decltype(since_tick_) since;
  const UnexaminedPair* longest = nullptr;
  std::uint64_t from_tick = report.tick;
  for (const UnexaminedPair& pair : report.unexamined) {
    const auto before = since_tick_.find({pair.a, pair.b});
    const std::uint64_t tick = before != since_tick_.end() ? before->second : report.tick;
    since[{pair.a, pair.b}] = tick;
    if (longest == nullptr || tick < from_tick) {
      longest = &pair;
      from_tick = tick;
    }
  }
  since_tick_ = std::move(since);
  if (longest == nullptr) told_ = false;
  const double waited_s = static_cast<double>(report.tick - from_tick) / world.tick_rate_hz;
  if (longest == nullptr || told_ || waited_s <= kTellWaiting_s) return "";
  told_ = true;
  const std::size_t others = since_tick_.size() - 1;
  return fmt::format("{} × {} {}{}; no pair is reported as clear before it is judged",
                     name_of_part(world, longest->a), name_of_part(world, longest->b),
                     in_words(longest->why),
                     others == 0   ? ""
                     : others == 1 ? ", and one other pair waits"
                                   : fmt::format(", and {} other pairs wait", others));
}

}  // namespace mortise
