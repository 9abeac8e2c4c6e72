#pragma once
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tests/bench/judgement_truth.h"
#include "tests/bench/scenes.h"

namespace mortise::bench {

enum class Family { kCylinder = 0, kCone, kBall, kKey, kBlocks };
constexpr Family kFamilies[] = {Family::kCylinder, Family::kCone, Family::kBall, Family::kKey,
                                Family::kBlocks};
const char* name_of(Family family);

/// Two parts at their poses, what is stated of them, and what is true of them whatever the mesh.
/// A is the inner part: shaft, ball, key, upper block.
struct JudgedCase {
  Family family = Family::kCylinder;
  std::uint64_t seed = 0;
  std::string text;  ///< parameters, for a person
  JudgedPart a, b;
  /// Outward offsets of the modelled faces: of features[0 .. stated), or of the whole part when
  /// stated is 0.
  Interval offset_a_mm, offset_b_mm;
  std::size_t stated_a = 0, stated_b = 0;
  Pose X_WA, X_WB;
  std::variant<std::monostate, RoundFit, BallFit, KeyFit> shape;  ///< none: blocks
  /// Overlap of two true parts whose faces are moved so.
  std::function<double(const Offsets&)> overlap_mm;
  bool overlap_is_depth = false;        ///< overlap_mm is delta itself, not only its sign
  std::optional<double> mesh_depth_mm;  ///< exact delta of the two meshes, > 0

  /// Fewest facets of a curved part; 0: none is curved.
  int facets() const;
  /// whole: the statement speaks of ends and rims as well, as it does for a part without features.
  Truth truth(bool whole) const;
};

/// The case of a family and a seed: the same on every run.
JudgedCase draw_case(Family family, std::uint64_t seed);

}  // namespace mortise::bench
