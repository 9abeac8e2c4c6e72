#pragma once
#include <string>

#include "tests/stress/oracle.h"

namespace mortise::stress {

/// What one sweep has seen; a row of the table that the suite prints at its end.
class Sweep {
 public:
  /// Rows appear in the order in which their sweeps begin.
  explicit Sweep(std::string name);
  /// Writes the row; fails the test for every answer that an oracle contradicts.
  ~Sweep();
  Sweep(const Sweep&) = delete;
  Sweep& operator=(const Sweep&) = delete;

  /// Asks the kernel with floating-point traps on, judges the answer. `label` tells a reader how to
  /// make the case again.
  FirstContact ask(const Case& c, const std::string& label, int looks = 48);
  /// The same for an answer that was made elsewhere.
  Judgement add(const Case& c, const FirstContact& answer, const std::string& label, int looks);

  /// For sweeps that measure something else: largest error so far against its bound, mm.
  void measured(double error_mm, double bound_mm, const std::string& label);

  int contacts() const { return contacts_; }
  int free() const { return free_; }
  int at_start() const { return at_start_; }
  int queries() const { return queries_; }

 private:
  void fault(const char* what, double by_mm, const std::string& label);

  std::string name_;
  int queries_ = 0, contacts_ = 0, free_ = 0, at_start_ = 0, undecided_ = 0, tired_ = 0;
  int missed_ = 0, late_ = 0, invented_ = 0, wrong_ = 0, faults_told_ = 0;
  double late_mm_ = 0.0, early_ = 0.0, witness_ = 0.0;  // early: in units of the accuracy
  double error_mm_ = 0.0, bound_mm_ = 0.0;
};

/// Floating-point exceptions (invalid, division by zero, overflow) raised since it was made fail
/// the test; with MORTISE_TRAP=1 they stop the program at the instruction.
class FloatGuard {
 public:
  explicit FloatGuard(std::string label);
  ~FloatGuard();
  FloatGuard(const FloatGuard&) = delete;
  FloatGuard& operator=(const FloatGuard&) = delete;

 private:
  std::string label_;
  int before_ = 0;
};

}  // namespace mortise::stress
