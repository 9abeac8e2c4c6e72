#pragma once
#include "common/depth/depth.h"
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Of the pair as it stands at time t of its segment.
inline OverlapQuery overlap_query(const PairWork& pair, double t) {
  OverlapQuery query;
  query.a = pair.ids.solid_a;
  query.b = pair.ids.solid_b;
  query.band_a = pair.ids.band_a;
  query.band_b = pair.ids.band_b;
  query.X_WA = pair.segment.motion_a.pose_at(t);
  query.X_WB = pair.segment.motion_b.pose_at(t);
  return query;
}

/// Of its whole segment; `at_target` at its end.
inline SweptQuery swept_query(const PairWork& pair) {
  SweptQuery query;
  query.at_target = overlap_query(pair, 1.0);
  query.motion_a = pair.segment.motion_a;
  query.motion_b = pair.segment.motion_b;
  query.certain_free = pair.answer.certain_free;
  return query;
}

}  // namespace mortise
