// Compiled for AVX2 where the compiler knows it (see CMakeLists.txt); entered only where the
// machine has it.
#include "common/ccd/kernels/leaf_discard.h"

namespace mortise::ccd {

#ifdef __AVX2__
namespace {
#include "common/ccd/kernels/leaf_discard_impl.h"
}  // namespace

const DiscardKernels* wide_discard_kernels() {
  static constexpr DiscardKernels kernels = kKernels;
  static const bool supported = __builtin_cpu_supports("avx2") != 0;
  return supported ? &kernels : nullptr;
}
#else
const DiscardKernels* wide_discard_kernels() { return nullptr; }
#endif

}  // namespace mortise::ccd
