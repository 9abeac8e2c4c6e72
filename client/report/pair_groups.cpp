#include "client/report/pair_groups.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "client/report/cells.h"

namespace mortise {
namespace {

struct Rank {
  int collision_class;
  bool known;  // within the class: those of a known probability first
  double within;
  friend auto operator<=>(const Rank&, const Rank&) = default;
};

Rank rank_of(const Cells& clash) {
  const std::string klass = clash.raw("class");
  const auto finite = [&](const char* column) {
    const double x = clash.number(column);
    return std::isfinite(x) ? x : 0.0;
  };
  if (klass == "real") return {3, true, finite("margin_mm")};
  if (klass != "potential") return {klass == "fake" ? 1 : 0, true, -finite("margin_mm")};
  const bool known = clash["probability"].is_number();
  return {2, known, finite(known ? "probability" : "overlap_lo_mm")};
}

bool at_one_time(const Cells& x, const Cells& y) {
  const auto end = [](const Cells& clash) {
    const double tick = clash.number("end_tick");  // none: it is open
    return std::isfinite(tick) ? tick : std::numeric_limits<double>::infinity();
  };
  return x.number("begin_tick") < end(y) && y.number("begin_tick") < end(x);
}

std::string counted(std::size_t count, const char* one) {
  return "+" + std::to_string(count) + " " + one + (count == 1 ? "" : "s");
}

}  // namespace

std::vector<PairGroup> pair_groups(const Table& clashes) {
  std::vector<Rank> ranks;
  for (const auto& row : clashes.rows) ranks.push_back(rank_of(Cells(clashes, row)));
  std::vector<std::size_t> order(ranks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t x, std::size_t y) { return ranks[x] > ranks[y]; });
  std::vector<PairGroup> groups;
  std::map<std::pair<std::string, std::string>, std::size_t> group_of;
  for (const std::size_t row : order) {
    const Cells clash(clashes, clashes.rows[row]);
    const auto [at, is_new] =
        group_of.try_emplace({clash.raw("part_a"), clash.raw("part_b")}, groups.size());
    if (is_new) {
      groups.push_back({row, {}, 0});
      continue;
    }
    PairGroup& group = groups[at->second];
    group.others.push_back(row);
    group.places += at_one_time(clash, Cells(clashes, clashes.rows[group.lead]));
  }
  return groups;
}

std::string also_text(const PairGroup& group) {
  std::string text = group.places > 0 ? counted(group.places, "place") : "";
  if (group.times() > 0) text += (text.empty() ? "" : ", ") + counted(group.times(), "time");
  return text;
}

}  // namespace mortise
