#include "common/ccd/kernels/leaf_kernel.h"

namespace mortise::ccd {
namespace {
#include "common/ccd/kernels/leaf_kernel_impl.h"
}  // namespace

LeafKernel portable_leaf_kernel() { return advance; }

LeafKernel leaf_kernel() {
  static const LeafKernel wide = wide_leaf_kernel();
  return wide != nullptr ? wide : portable_leaf_kernel();
}

}  // namespace mortise::ccd
