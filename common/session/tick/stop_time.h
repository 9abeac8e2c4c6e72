#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Time of the pair's segment up to which it is proven not to be real; 1: for all of it. For pairs
/// of which a part has a band.
struct SearchedTime {
  double t = 0.0;
  bool known = false;  ///< a search would say nothing else
};

/// As far as first contact knows it (`touch`: of the meshes), or the place that held the pair
/// before: a few evaluations.
SearchedTime stop_time_without_search(PairWork& pair, const FirstContact& touch);

/// A part that is pushed on where its last push has left it: is it the same place that holds it?
/// The poses at the start are proven already, so that nothing has to be searched. True: it is, and
/// PairWork::place names it.
bool is_held_again(PairWork& pair);

/// By the search from there, at most PairWork::cap evaluations of it.
double stop_time_with_bands(PairWork& pair, CcdScratch& ccd);

/// Remembers that the search came to nothing, or that it did not.
void note_stalled(PairWork& pair);

/// Is it the push that came to nothing before, from the same place?
bool is_stalled(const PairWork& pair);

/// How many searches in a row, whatever the push, have come to nothing from where the parts stand,
/// with all the work that they may have.
std::uint8_t times_in_vain(const PairWork& pair);

/// How far a pair that is real at the start of its segment may go: as long as it gets no deeper.
/// Looked at in quarters of the segment; between them it is not looked at.
double withdrawal_time(PairWork& pair, CcdScratch& ccd);

}  // namespace mortise
