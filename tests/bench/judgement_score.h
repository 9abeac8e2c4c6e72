#pragma once
#include <array>
#include <string>
#include <vector>

#include "tests/bench/judgement_methods.h"

namespace mortise::bench {

/// Truths closer to a threshold than this are not held against anybody, mm: what touch is known to.
constexpr double kTouch_mm = 2e-6;
/// Margin beyond which a decided truth must be found.
constexpr double kMargin_mm = 5e-4;

/// What one method said about many cases.
struct JudgementScore {
  /// By truth, by word: real, potential, none or fake.
  std::array<std::array<long long, 3>, 3> confusion{};
  long long cases = 0, contradictions = 0, capped = 0;
  /// Decided truths beyond the margin: all, and those found; by coarse (fewer than 24 facets) or
  /// not. Of the latter those that no prism has the facets of (65 steps a turn or more:
  /// common/evaluation/README.md, "Round or flat?").
  struct Share {
    long long all = 0, right = 0;
    double percent() const;
  };
  Share coarse, fine, no_prism;
  long long decided_truths = 0, left_open = 0;  ///< potential was said though the truth is decided
  std::vector<double> time_s;
  double slowest_s = 0.0;
  std::string slowest;  ///< name of that case

  /// Returns what is wrong with the word; empty: nothing that must not be.
  std::string add(const JudgedCase& c, const Truth& truth, const Word& word);
  double left_open_percent() const;
};

/// How far one method's numbers are from the exact ones.
struct ErrorScore {
  std::vector<double> time_s;
  std::vector<double> depth_mm;    ///< of the depth of the meshes, where it is known
  std::vector<double> overlap_mm;  ///< of the overlap of the true surfaces, where it is a depth
  long long capped = 0;

  /// Ours: both ends of the admissible overlap against the truth's.
  void add_ours(const JudgedCase& c, const Truth& truth, const Word& word);
  /// A peer knows one depth, and nothing below zero.
  void add_peer(const JudgedCase& c, const Word& word);
};

/// Farther end of a bracket from the value that it should be, mm.
double bracket_error_mm(const Interval& bracket, double exact_mm);

/// "cylinder:123"
std::string name_of(const JudgedCase& c);

}  // namespace mortise::bench
