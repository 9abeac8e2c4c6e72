// Compiled for AVX2 where the compiler knows it (see CMakeLists.txt); entered only where the
// machine has it.
#include "common/geometry/kernels/fit_sums.h"

namespace mortise::geometry {

#ifdef __AVX2__
namespace {
#include "common/geometry/kernels/fit_sums_impl.h"
}  // namespace

const FitKernels* wide_fit_sums() {
  static constexpr FitKernels kernels = kKernels;
  static const bool supported = __builtin_cpu_supports("avx2") != 0;
  return supported ? &kernels : nullptr;
}
#else
const FitKernels* wide_fit_sums() { return nullptr; }
#endif

}  // namespace mortise::geometry
