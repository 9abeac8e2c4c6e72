#pragma once

// How far time may advance before two boxes can come within a target distance, for eight pairs of
// boxes at once. Single precision: it may only discard. No Eigen type here: this header is compiled
// for different instruction sets, and no inline function of a library may come out of them.
namespace mortise::ccd {

/// One separating direction n that is the same for all lanes, axes of B at time t. The instruction
/// sets must agree bit for bit: every expression is evaluated as written, never contracted.
struct DirectionTerms {
  float n[3];
  float v;          ///< n . (velocity of A's origin - velocity of B's origin)
  float turn_a[3];  ///< n x w_A: n . (w_A x u) = turn_a . u
  float
      reach_a[3];  ///< |turn_a . axis j of A|: how much faster a corner of a box is than its centre
  float bend_a;    ///< |n x w_A| |w_A|: bound of n . acceleration, per mm from the axis
  float turn_b[3];
  float bend_b;
};

/// Two bodies at one time, in axes of B, relative to the origin of B's tree, mm and mm per tick.
struct BoxFrame {
  float r[3][3], abs_r[3][3];   ///< axes of A's boxes, by row
  float p[3];                   ///< origin of A's tree
  DirectionTerms direction[6];  ///< axes of B, axes of A
  float v[3], w_a[3], w_b[3];   ///< relative velocity of the origins, rotation vectors
  float speed_a, speed_b;       ///< |w_A|, |w_B|
  float axis_a[3], axis_b[3];   ///< unit, of the rotations
  float arm_a[3], arm_b[3];     ///< from the rotation axis to the origin of the tree
  float gap_allowance;          ///< target distance and rounding, taken off every gap
  float speed_allowance;        ///< rounding of a speed
  float arm_allowance;          ///< rounding of a distance from an axis
  bool turns_a, turns_b;
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
