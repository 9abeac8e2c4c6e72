// Compiled for AVX2 where the compiler knows it (see CMakeLists.txt); entered only where the
// machine has it.
#include "common/ccd/kernels/leaf_kernel.h"

namespace mortise::ccd {

#ifdef __AVX2__
namespace {
#include "common/ccd/kernels/leaf_kernel_impl.h"
}  // namespace

LeafKernel wide_leaf_kernel() {
  static const bool supported = __builtin_cpu_supports("avx2") != 0;
  return supported ? advance : nullptr;
}
#else
LeafKernel wide_leaf_kernel() { return nullptr; }
#endif

}  // namespace mortise::ccd
