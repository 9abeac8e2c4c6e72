#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "common/base/hash.h"
#include "common/messages/report.h"

namespace mortise {

inline void add(StateHash& hash, const Vec3& v) {
  for (int i = 0; i < 3; ++i) hash.add(v[i]);
}
inline void add(StateHash& hash, const std::string& text) {
  hash.add(std::as_bytes(std::span(text.data(), text.size())));
}
inline void add(StateHash& hash, const Verdict& v) {
  hash.add(static_cast<std::uint64_t>(v.collision_class));
  for (const double x :
       {v.delta_mm.lo, v.delta_mm.hi, v.gpd_mm.lo, v.gpd_mm.hi, v.fake_below_mm, v.real_above_mm,
        v.margin_mm, v.probability, v.travel_mm, v.normal_travel_mm, v.area_mm2})
    hash.add(x);
  for (const Vec3& x :
       {v.point_W, v.normal_W, v.witness_W, v.separation_translation_mm, v.separation_rotation_rad})
    add(hash, x);
  add(hash, v.explanation);
}

/// Of everything that a tick says, except how much work it was.
inline std::uint64_t digest(const StepReport& report) {
  StateHash hash;
  hash.add(report.tick);
  hash.add(report.state_hash);
  for (const PartPose& pose : report.moved) {
    hash.add(static_cast<std::uint64_t>(pose.part.value));
    for (int i = 0; i < 4; ++i) hash.add(pose.X_WP.q.coeffs()[i]);
    add(hash, pose.X_WP.p);
  }
  for (const ClashEvent& event : report.events) {
    for (const std::uint64_t x : {static_cast<std::uint64_t>(event.kind), event.seq, event.tick,
                                  static_cast<std::uint64_t>(event.clash.value),
                                  static_cast<std::uint64_t>(event.part_a.value),
                                  static_cast<std::uint64_t>(event.part_b.value),
                                  static_cast<std::uint64_t>(event.user.value), event.begin_tick,
                                  static_cast<std::uint64_t>(event.worst_class)})
      hash.add(x);
    hash.add(event.t_contact);
    hash.add(event.t_potential);
    hash.add(event.t_real);
    hash.add(event.worst_delta_mm.lo);
    add(hash, event.verdict);
  }
  for (const RefusedIncrement& refused : report.refused) {
    hash.add(refused.seq);
    hash.add(static_cast<std::uint64_t>(refused.reason));
  }
  return hash.value();
}

}  // namespace mortise
