#include "common/geometry/kernels/nearest.h"

namespace mortise::geometry {
namespace {
#include "common/geometry/kernels/nearest_impl.h"
}  // namespace

const NearestKernels& portable_nearest() {
  static constexpr NearestKernels kernels = kKernels;
  return kernels;
}

const NearestKernels& best_nearest() {
  static const NearestKernels& best =
      wide_nearest() != nullptr ? *wide_nearest() : portable_nearest();
  return best;
}

}  // namespace mortise::geometry
