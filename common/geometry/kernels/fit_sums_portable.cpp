#include "common/geometry/kernels/fit_sums.h"

namespace mortise::geometry {
namespace {
#include "common/geometry/kernels/fit_sums_impl.h"
}  // namespace

const FitKernels& portable_fit_sums() {
  static constexpr FitKernels kernels = kKernels;
  return kernels;
}

const FitKernels& best_fit_sums() {
  static const FitKernels& best =
      wide_fit_sums() != nullptr ? *wide_fit_sums() : portable_fit_sums();
  return best;
}

}  // namespace mortise::geometry
