// Included once by kernels_portable.cpp and kernels_wide.cpp, inside an unnamed namespace: no
// function that is compiled for one instruction set may be taken for one of the other.
#include "common/ccd/kernels/box_advance_impl.h"
#include "common/ccd/kernels/leaf_discard_impl.h"
#include "common/ccd/kernels/leaf_kernel_impl.h"

constexpr Kernels kKernels{boxes::kKernels, leaves::advance, discards::kKernels};
