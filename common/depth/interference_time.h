#pragma once
#include <cstdint>
#include <optional>

#include "common/depth/overlap.h"

namespace mortise {

/// What covers prove of a path.
struct FreeUntil {
  double t = 0.0;        ///< at no time up to this is anything certain deeper than 1e-6 mm, or four
                         ///< times the accuracy where they are deeper than that at the start;
                         ///< 0: nothing is proven, 1: nothing is in the whole tick
  bool touches = false;  ///< nothing is deeper where the path begins
  bool closely = false;  ///< and the depth is 1e-6 mm: a word may rest on it
};

struct SweptQuery {
  OverlapQuery at_target;  ///< poses of the query are ignored
  Motion motion_a, motion_b;
  bool slides = true;         ///< the certain place is wanted where a part can slide along a face
  double accuracy_mm = 1e-4;  ///< how closely the answer is known, along the path of any point
  /// What certain_free_until() says of this query; nullopt: nobody has asked.
  std::optional<FreeUntil> certain_free;
};

/// When the overlap becomes certain (real) in the tick.
struct InterferenceTime {
  bool becomes_real = false;
  double t_free = 1.0;  ///< at no t <= t_free is anything certain deeper than accuracy_mm, or than
                        ///< FreeUntil says, proven; the pose at which `stop` leaves the part
  double t_real = 1.0;  ///< real at t_real, when becomes_real
  bool capped = false;  ///< work cap: t_free is still proven, nothing is known beyond it
  bool real_at_start = false;
  CertainPlace certain_place;  ///< at t_real, where one was found
  std::uint64_t evaluations = 0;
};

/// First time at which certain_mm > 0 somewhere (README, section 6), found by branch and bound
/// over the swept surface, so that a thin wall cannot be passed between ticks even when the meshes
/// overlapped before.
InterferenceTime find_interference_time(const SweptQuery& query, CcdScratch& scratch);

/// By the covers of both parts (README, section 11) alone. Costs a few microseconds for parts that
/// keep apart or slide. Adds the bounds it has looked at to `evaluations`.
FreeUntil certain_free_until(const SweptQuery& query, std::uint64_t& evaluations);
/// Proven by covers: nothing is possible in the whole tick.
bool is_free_of_possible(const SweptQuery& query, std::uint64_t& evaluations);

/// When an overlap becomes possible in the tick.
struct PossibleTime {
  bool becomes_possible = false;
  double t_clear = 1.0;     ///< at no t <= t_clear do any admissible surfaces interfere deeper than
                            ///< accuracy_mm, proven
  double t_possible = 1.0;  ///< some admissible pair interferes there, when becomes_possible
  bool capped = false;      ///< work cap: t_clear is still proven, nothing is known beyond it
  std::uint64_t evaluations = 0;
};

/// The same for possible_mm > 0, over the largest surfaces that the bands admit. With trivial bands
/// both times are those at which the meshes interfere.
PossibleTime find_possible_time(const SweptQuery& query, CcdScratch& scratch);

}  // namespace mortise
