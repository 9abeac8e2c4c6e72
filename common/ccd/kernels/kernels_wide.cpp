// Compiled for AVX2 where the compiler knows it (see CMakeLists.txt); entered only where the
// machine has it.
#include "common/ccd/kernels/kernels.h"

namespace mortise::ccd {

#ifdef __AVX2__
namespace {
#include "common/ccd/kernels/kernels_impl.h"
}  // namespace

const Kernels* wide_kernels() {
  static constexpr Kernels kernels = kKernels;
  static const bool supported = __builtin_cpu_supports("avx2") != 0;
  return supported ? &kernels : nullptr;
}
#else
const Kernels* wide_kernels() { return nullptr; }
#endif

}  // namespace mortise::ccd
