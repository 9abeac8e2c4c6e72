#pragma once
#include <fenv.h>

namespace mortise::test {

/// While one lives, an operation that makes an infinity or what is no number stops the program.
class FloatTraps {
 public:
  FloatTraps() : before_(feenableexcept(kTrapped)) {}
  ~FloatTraps() {
    fedisableexcept(kTrapped);
    feenableexcept(before_);
  }
  FloatTraps(const FloatTraps&) = delete;
  FloatTraps& operator=(const FloatTraps&) = delete;

 private:
  static constexpr int kTrapped = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW;
  int before_;
};

}  // namespace mortise::test
