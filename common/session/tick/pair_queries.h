#pragma once
#include "common/depth/interference_time.h"
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Of the pair as it stands at time t of its segment.
inline OverlapQuery overlap_query(const PairWork& pair, double t) {
  OverlapQuery query;
  query.a = pair.solid_a;
  query.b = pair.solid_b;
  query.band_a = pair.band_a;
  query.band_b = pair.band_b;
  query.X_WA = pair.motion_a.pose_at(t);
  query.X_WB = pair.motion_b.pose_at(t);
  return query;
}

/// Of its whole segment; `at_target` at its end.
inline SweptQuery swept_query(const PairWork& pair) {
  SweptQuery query;
  query.at_target = overlap_query(pair, 1.0);
  query.motion_a = pair.motion_a;
  query.motion_b = pair.motion_b;
  query.certain_free = pair.certain_free;
  return query;
}

}  // namespace mortise
