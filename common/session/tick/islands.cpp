#include "common/session/tick/islands.h"

#include <algorithm>
#include <numeric>

#include "common/session/tick/tick_work.h"

namespace mortise {

void Islands::find(std::span<const Move> moves, std::span<const PairWork> pairs, bool as_one) {
  leaders_.resize(moves.size());
  std::iota(leaders_.begin(), leaders_.end(), 0);
  if (as_one) std::fill(leaders_.begin(), leaders_.end(), 0);
  join_groups(moves);
  for (const PairWork& pair : pairs)
    if (pair.ids.move_a >= 0 && pair.ids.move_b >= 0) join(pair.ids.move_a, pair.ids.move_b);

  count_ = 0;
  numbers_.resize(moves.size());
  for (std::int32_t move = 0; move < static_cast<std::int32_t>(moves.size()); ++move) {
    if (leader_of(move) == move) {
      numbers_[static_cast<std::size_t>(move)] = count_;
      next();
    }
    island_of(move).moves.push_back(move);
  }
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    const PairIds& ids = pairs[i].ids;
    if (ids.move_a >= 0 || ids.move_b >= 0)
      island_of(std::max(ids.move_a, ids.move_b)).pairs.push_back(i);
  }
}

void Islands::join_groups(std::span<const Move> moves) {
  grouped_.clear();
  for (std::size_t i = 0; i < moves.size(); ++i)
    if (moves[i].group) grouped_.emplace_back(moves[i].group.value, static_cast<std::int32_t>(i));
  std::sort(grouped_.begin(), grouped_.end());
  for (std::size_t i = 1; i < grouped_.size(); ++i)
    if (grouped_[i].first == grouped_[i - 1].first)
      join(grouped_[i - 1].second, grouped_[i].second);
}

// The first move of the two islands leads both.
void Islands::join(std::int32_t x, std::int32_t y) {
  x = leader_of(x);
  y = leader_of(y);
  leaders_[static_cast<std::size_t>(std::max(x, y))] = std::min(x, y);
}

// Halves the way for who asks next.
std::int32_t Islands::leader_of(std::int32_t move) {
  while (true) {
    std::int32_t& leader = leaders_[static_cast<std::size_t>(move)];
    if (leader == move) return move;
    leader = leaders_[static_cast<std::size_t>(leader)];
    move = leader;
  }
}

Island& Islands::island_of(std::int32_t move) {
  return islands_[numbers_[static_cast<std::size_t>(leader_of(move))]];
}

Island& Islands::next() {
  if (count_ == islands_.size()) islands_.emplace_back();
  Island& island = islands_[count_++];
  island.moves.clear();
  island.pairs.clear();
  island.t = 1.0;
  island.changed_at = 0.0;
  island.counts = {};
  return island;
}

}  // namespace mortise
