#include "common/ccd/kernels/leaf_discard.h"

namespace mortise::ccd {
namespace {
#include "common/ccd/kernels/leaf_discard_impl.h"
}  // namespace

const DiscardKernels& portable_discard_kernels() {
  static constexpr DiscardKernels kernels = kKernels;
  return kernels;
}

const DiscardKernels& discard_kernels() {
  const DiscardKernels* wide = wide_discard_kernels();
  return wide != nullptr ? *wide : portable_discard_kernels();
}

}  // namespace mortise::ccd
