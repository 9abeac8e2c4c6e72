// Compiled for AVX2 where the compiler knows it (see CMakeLists.txt); entered only where the
// machine has it.
#include "common/ccd/kernels/box_advance.h"

namespace mortise::ccd {

#ifdef __AVX2__
namespace {
#include "common/ccd/kernels/box_advance_impl.h"
}  // namespace

const BoxKernels* wide_box_kernels() {
  static constexpr BoxKernels kernels = kKernels;
  static const bool supported = __builtin_cpu_supports("avx2") != 0;
  return supported ? &kernels : nullptr;
}
#else
const BoxKernels* wide_box_kernels() { return nullptr; }
#endif

}  // namespace mortise::ccd
