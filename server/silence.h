#pragma once
#include <algorithm>

namespace mortise {

/// How long the other server has been silent, counting only time in which this process ran. After a
/// freeze, or without a processor, messages may still be in the sockets, and the other server may
/// have been frozen too, for as long and a little later.
class Silence {
 public:
  static constexpr double kTurnCounts_s = 0.01;  ///< one turn for no longer
  static constexpr double kStall_s = 0.05;       ///< a longer time without processor is a stall
  /// The lease of datagrams is as long. After a stall: longer by the stall, up to kWary_s.
  static constexpr double kSilent_s = 0.1, kWary_s = 1.0;
  static constexpr double kCalm_s = 1.0;  ///< after which a stall is forgotten

  void heard() { silent_s_ = 0.0; }
  /// One turn of the loop: how long it took, and how long of that this process computed.
  void turn(double took_s, double computed_s) {
    const double stood_still_s = took_s - computed_s;
    silent_s_ += std::min(took_s, kTurnCounts_s);
    calm_s_ += took_s;
    if (calm_s_ >= kCalm_s) stalled_s_ = 0.0;
    if (stood_still_s <= kStall_s) return;
    stalled_s_ += stood_still_s;
    calm_s_ = 0.0;
  }
  bool is_believed() const { return silent_s_ >= std::min(kSilent_s + stalled_s_, kWary_s); }

 private:
  double silent_s_ = 0.0;
  double calm_s_ = 0.0, stalled_s_ = 0.0;  ///< since, and in, the stalls of late
};

}  // namespace mortise
