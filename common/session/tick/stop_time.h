#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Time of the pair's segment up to which it is proven not to be real; 1: all of it. For pairs with
/// a band.
struct SearchedTime {
  double t = 0.0;
  bool known = false;  ///< a search would give the same
};

/// Time of the segment up to which the covers of the parts prove that nothing is certain; some
/// microseconds. 0 for pairs without a band.
double free_by_covers(PairWork& pair);

/// As far as first contact knows it (`touch`: of the meshes), or the place that held the pair
/// before, or covers: a few evaluations.
SearchedTime stop_time_without_search(PairWork& pair, const FirstContact& touch);

/// Is a part that is pushed again where its last push left it held by the same place? The poses at
/// the start are already proven, so that nothing has to be searched. True: PairWork::place is that
/// place.
bool is_held_again(PairWork& pair);

/// The same by a search from that time on, with at most PairWork::cap evaluations. `slides`: the
/// part may slide along what holds it.
double stop_time_with_bands(PairWork& pair, bool slides, CcdScratch& ccd);

/// Notes whether the search ended without a result.
void note_stalled(PairWork& pair);

/// Is it the same push from the same place whose search ended without a result before?
bool is_stalled(const PairWork& pair);

/// Number of consecutive searches with full work, for any push, that ended without a result from
/// the present poses.
std::uint8_t times_in_vain(const PairWork& pair);

/// Time up to which a pair that is real at the start of its segment gets no deeper. Checked at the
/// quarters of the segment only.
double withdrawal_time(PairWork& pair, CcdScratch& ccd);

}  // namespace mortise
