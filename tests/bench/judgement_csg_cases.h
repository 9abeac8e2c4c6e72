#pragma once
#include "tests/bench/judgement_csg_parts.h"

namespace mortise::bench {

/// A pair of the CSG oracle: parts, pose and truth. An overlap is proven by its point; where none
/// is said, none was found.
struct CsgCase {
  CsgPart a, b;
  Pose X_BA, X_WB;
  OracleTruth truth;
  bool by_face = false;  ///< zones differ from face to face
  std::string text;

  /// As it comes to the engine, with declared faces or recognized ones (not by_face).
  OracleCase asked(std::uint64_t seed, bool recognized) const;
};

/// The pair of a seed: the same on every run.
CsgCase draw_csg(std::uint64_t seed);

}  // namespace mortise::bench
