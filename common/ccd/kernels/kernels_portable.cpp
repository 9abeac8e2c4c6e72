#include "common/ccd/kernels/kernels.h"

namespace mortise::ccd {
namespace {
#include "common/ccd/kernels/kernels_impl.h"
}  // namespace

const Kernels& portable_kernels() {
  static constexpr Kernels kernels = kKernels;
  return kernels;
}

const Kernels& best_kernels() {
  const Kernels* wide = wide_kernels();
  return wide != nullptr ? *wide : portable_kernels();
}

}  // namespace mortise::ccd
