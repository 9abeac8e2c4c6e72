// Compiled for AVX2 where the compiler knows it (see CMakeLists.txt); entered only where the
// machine has it.
#include "common/geometry/kernels/nearest.h"

namespace mortise::geometry {

#ifdef __AVX2__
namespace {
#include "common/geometry/kernels/nearest_impl.h"
}  // namespace

const NearestKernels* wide_nearest() {
  static constexpr NearestKernels kernels = kKernels;
  static const bool supported = __builtin_cpu_supports("avx2") != 0;
  return supported ? &kernels : nullptr;
}
#else
const NearestKernels* wide_nearest() { return nullptr; }
#endif

}  // namespace mortise::geometry
