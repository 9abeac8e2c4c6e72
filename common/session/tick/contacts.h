#pragma once
#include <span>

#include "common/ccd/distance.h"
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Stage 3. First contact of every pair; for policy stop, when it becomes real.
void find_contacts(const World& world, Scratch::Impl& work);

/// Asks pairs over the segments set in them; used by stage 3 and by the rounds of stage 3b.
void ask_pairs(const World& world, Scratch::Impl& work, std::span<const std::uint32_t> pairs);

/// When do the meshes touch in the segment? Sets what the pair knows of it.
FirstContact ask_touch(PairWork& pair, CcdScratch& ccd);

/// Counts what a question of first contact took.
void note_contact_work(PairWork& pair, const CcdWork& work);

/// Distance of the meshes of a pair at these poses, mm, up to limit_mm; counted, and begun where
/// the last one was found.
DistanceResult pair_distance(PairWork& pair, const Pose& X_WA, const Pose& X_WB, double limit_mm,
                             CcdScratch& ccd);

}  // namespace mortise
