#pragma once

// How far time may advance before two boxes can come within a target distance, for eight pairs of
// boxes at once. Single precision: it may only discard. No Eigen type here: this header is compiled
// for different instruction sets, and no inline function of a library may come out of them.
namespace mortise::ccd {

/// How a body moves along a direction n: a point at u from the origin of its tree has the speed
/// turn . u + turn_0 by turning, and the acceleration bend . u + bend_0. A corner of a box exceeds
/// its centre by reach and bend_reach times its half extents (A: in axes of A; B: absolute values).
struct TurnAlong {
  float turn[3], turn_0;
  float bend[3], bend_0;
  float reach[3], bend_reach[3];
};

/// One separating direction n that is the same for all lanes, axes of B at time t. The instruction
/// sets must agree bit for bit: every expression is evaluated as written, never contracted.
struct DirectionTerms {
  float n[3];
  float v;  ///< n . (velocity of A's axis - velocity of B's axis)
  TurnAlong a, b;
};

/// Of one body: see TurnTerms in leaf_kernel.h.
struct BoxTurn {
  float w[3], arm[3], speed;
  float bow, lift;
  bool turns;
};

/// Two bodies at one time, in axes of B, relative to the origin of B's tree, mm and mm per tick.
struct BoxFrame {
  float r[3][3], abs_r[3][3];   ///< axes of A's boxes, by row
  float p[3];                   ///< origin of A's tree
  DirectionTerms direction[6];  ///< axes of B, axes of A
  float v[3];                   ///< relative velocity of the axes of rotation
  BoxTurn a, b;
  float rest;             ///< ticks to the end, rounded up: longer answers are all the same
  float horizon;          ///< ticks: no answer is longer
  float gap_allowance;    ///< target distance and rounding, taken off every gap
  float speed_allowance;  ///< rounding of a speed
  float bend_allowance;   ///< rounding of an acceleration
};

/// One box against which eight others are held.
struct OneBox {
  float center[3], half[3];
};

/// The boxes of a node's children, [coordinate][child].
struct EightBoxes {
  const float (*center)[8];
  const float (*half)[8];
};

/// advance[k]: box k against the one box. Never more than the time that is really free.
using AdvanceA = void (*)(const BoxFrame& frame, const EightBoxes& a, const OneBox& b,
                          float* advance);
using AdvanceB = void (*)(const BoxFrame& frame, const OneBox& a, const EightBoxes& b,
                          float* advance);
/// lower[k]: lower bound of the distance, mm; only r, abs_r, p and gap_allowance are read.
using LowerA = AdvanceA;
using LowerB = AdvanceB;

struct BoxKernels {
  AdvanceA advance_a;
  AdvanceB advance_b;
  LowerA lower_a;
  LowerB lower_b;
};

/// Baseline instructions, on every machine.
const BoxKernels& portable_box_kernels();
/// The same operations in the same order on wider registers; null where they were not compiled.
const BoxKernels* wide_box_kernels();
/// What this machine runs best. The answers are the same.
const BoxKernels& box_kernels();

}  // namespace mortise::ccd
