#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/messages/report.h"
#include "common/session/tick/pair_work.h"

namespace mortise {

struct Move;

/// Moves that can change each other's paths in this tick: those of a pair, and those of a group.
/// What stands still joins nobody.
struct Island {
  std::vector<std::int32_t> moves;   ///< indices, rising
  std::vector<std::uint32_t> pairs;  ///< indices of the pairs of these moves, rising

  // Its response; times are of the tick.
  double t = 1.0;           ///< of the present round; 1: it is at its end
  double changed_at = 0.0;  ///< a little before, where those who respond take another path
  std::vector<std::int32_t> responding;
  std::vector<std::uint32_t> to_ask;
  StepCounters counts;
};

/// All islands of a tick, each with its moves and pairs. They keep their room for the next tick.
class Islands {
 public:
  /// In the order of their first moves. O(n log n) for the moves of groups, else nearly O(n).
  /// as_one: all moves are one island, as if each pair had something to do with all others.
  void find(std::span<const Move> moves, std::span<const PairWork> pairs, bool as_one);

  std::size_t size() const { return count_; }
  Island& operator[](std::size_t i) { return islands_[i]; }

 private:
  void join_groups(std::span<const Move> moves);
  void join(std::int32_t x, std::int32_t y);
  std::int32_t leader_of(std::int32_t move);
  Island& island_of(std::int32_t move);
  Island& next();

  std::vector<Island> islands_;  // count_ of them are in use
  std::size_t count_ = 0;
  std::vector<std::int32_t> leaders_;  // by move: itself, or one before it of the same island
  std::vector<std::size_t> numbers_;   // by move that is the first of its island
  std::vector<std::pair<std::uint32_t, std::int32_t>> grouped_;  // group, move
};

}  // namespace mortise
