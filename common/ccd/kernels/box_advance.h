#pragma once

// How far time may advance before two boxes can come within a target distance, for eight pairs of
// boxes at once. Single precision: it may only discard. No Eigen type here: this header is compiled
// for different instruction sets, and no inline function of a library may come out of them.
namespace mortise::ccd {

/// Of one body: see TurnTerms in leaf_kernel.h.
struct BoxTurn {
  float w[3], arm[3];   ///< rotation vector; from the axis of rotation to the origin of the boxes
  float w_A[3];         ///< w in axes of A's boxes
  float r_w[3][3];      ///< axis j of A's boxes x w
  float speed, speed2;  ///< |w|, |w|^2
  float bow, lift;
  bool turns;
};

/// Two bodies at one time. The instruction sets must agree bit for bit: every expression is
/// evaluated as written, never contracted. In axes of the boxes of B, relative to their origin, mm
/// and mm per tick.
struct BoxFrame {
  float r[3][3], abs_r[3][3];  ///< axes of A's boxes, by row
  float p[3];                  ///< origin of A's boxes
  float v[3], v_A[3];          ///< relative velocity of the axes of rotation; in axes of A's boxes
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
/// apart[k]: lower bound of the distance along the axis that shows the largest,
/// mm; below zero by how deep the boxes overlap where they do. Reads what the
/// bounds above read.
using ApartA = AdvanceA;
using ApartB = AdvanceB;

struct BoxKernels {
  AdvanceA advance_a;
  AdvanceB advance_b;
  LowerA lower_a;
  LowerB lower_b;
  ApartA apart_a;
  ApartB apart_b;
};

}  // namespace mortise::ccd
