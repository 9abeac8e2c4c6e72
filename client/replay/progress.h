#pragma once
#include <chrono>
#include <string>

namespace mortise {

/// One line on stderr that is written over, a few times a second, and only where stderr is a
/// terminal. Any thread may call show(), one at a time.
class Progress {
 public:
  /// all: what 100 % is; 0: not known, the number alone is shown.
  Progress(std::string what, double all);
  ~Progress() { end(); }
  void show(double done);
  void end();  ///< clears the line

 private:
  std::string what_;
  double all_;
  bool on_, shown_ = false;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace mortise
