#pragma once
#include <algorithm>

namespace mortise {

/// How long the other server has been silent, counting only time in which the threads of this
/// process ran that take what comes. After a freeze, or without a processor, messages may still be
/// in the sockets, and the other server may have been frozen too, for as long and a little later.
class Silence {
 public:
  static constexpr double kTurnCounts_s = 0.01;  ///< one turn for no longer
  static constexpr double kStall_s = 0.05;       ///< a turn that takes longer is a stall
  /// The lease of datagrams is as long. After a stall: longer by the stall, up to kWary_s.
  static constexpr double kSilent_s = 0.1, kWary_s = 1.0;
  static constexpr double kCalm_s = 1.0;  ///< after which a stall is forgotten
  /// Of one that is there and says nothing that counts. A turn later it may be believed.
  static constexpr double kPresent_s = kSilent_s - 0.005;

  void heard() { silent_s_ = 0.0; }
  /// It lives, whatever it says.
  void present() { silent_s_ = std::min(silent_s_, kPresent_s); }
  /// One turn of an ordinary thread, and how long it took.
  void turn(double took_s) {
    silent_s_ += std::min(took_s, kTurnCounts_s);
    calm_s_ += took_s;
    if (calm_s_ >= kCalm_s) stalled_s_ = 0.0;
    if (took_s <= kStall_s) return;
    stalled_s_ += took_s;
    calm_s_ = 0.0;
  }
  bool is_believed() const { return silent_s_ >= std::min(kSilent_s + stalled_s_, kWary_s); }

 private:
  double silent_s_ = 0.0;
  double calm_s_ = 0.0, stalled_s_ = 0.0;  ///< since, and in, the stalls of late
};

}  // namespace mortise
