#pragma once

namespace mortise {

/// Tells a tick that takes long from one that hangs, by what its thread has computed. One that is
/// late for a second and computes is a long tick, up to kLongTick_s; one that is late and does not
/// compute (it waits for something, is stopped, or has no processor) hangs.
class TickWatch {
 public:
  /// As above. A tick of ten seconds is a session that nobody can work in.
  static constexpr double kLate_s = 1.0, kLongTick_s = 10.0;
  /// Processor time in a time of kLate_s that counts as computing. A thread that only looks again
  /// and again takes less.
  static constexpr double kComputes_s = 0.05;

  /// The thread goes on, and will again within so long. Times are of one clock.
  void progress(double now_s, double next_within_s) {
    due_s_ = now_s + next_within_s;
    is_told_ = true;
  }
  /// `cpu_s`: that the thread has used in all. Asked many times a second. True before the first
  /// progress().
  bool advances(double now_s, double cpu_s) {
    if (cpu_s - cpu_then_s_ >= kComputes_s || now_s - then_s_ > kLate_s) {
      computes_ = cpu_s - cpu_then_s_ >= kComputes_s;
      cpu_then_s_ = cpu_s;
      then_s_ = now_s;
    }
    const double late_s = now_s - due_s_;
    return !is_told_ || late_s <= kLate_s || (computes_ && late_s <= kLongTick_s);
  }

 private:
  bool is_told_ = false, computes_ = false;
  double due_s_ = 0.0;
  double then_s_ = 0.0, cpu_then_s_ = 0.0;  ///< the beginning of what is measured now
};

}  // namespace mortise
