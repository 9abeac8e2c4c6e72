#pragma once
#include "common/ccd/kernels/box_advance.h"
#include "common/ccd/kernels/leaf_discard.h"
#include "common/ccd/kernels/leaf_kernel.h"

namespace mortise::ccd {

/// All vector code of this room, compiled for one instruction set.
struct Kernels {
  BoxKernels box;
  LeafKernel leaf;
  DiscardKernels discard;
};

/// Baseline instructions, on every machine.
const Kernels& portable_kernels();
/// The same operations in the same order on wider registers; null where they were not compiled or
/// the machine has none.
const Kernels* wide_kernels();
/// What this machine runs best. The answers are the same.
const Kernels& best_kernels();

}  // namespace mortise::ccd
