#include "common/ccd/kernels/box_advance.h"

namespace mortise::ccd {
namespace {
#include "common/ccd/kernels/box_advance_impl.h"
}  // namespace

const BoxKernels& portable_box_kernels() {
  static constexpr BoxKernels kernels = kKernels;
  return kernels;
}

const BoxKernels& box_kernels() {
  const BoxKernels* wide = wide_box_kernels();
  return wide != nullptr ? *wide : portable_box_kernels();
}

}  // namespace mortise::ccd
