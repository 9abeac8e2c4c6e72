#pragma once
#include <vector>

#include "tests/bench/methods.h"

namespace mortise::bench {

/// By how much one answer misses the truth, mm of travel of the fastest point: below zero early,
/// above late. Infinite when the contact was missed; -infinite for a false hit.
double error_mm(const MotionSet& set, std::size_t item, const Answer& answer, double accuracy_mm);

/// Below this a time is not called late, mm: what the truth itself is good for.
double truth_error_mm(TruthSource source);

/// Times of contact by our own answer at 1e-10 mm, of a set that has no other truth.
void find_truth(MotionSet& set);

struct Score {
  long long asked = 0, decided = 0, missed = 0, false_hits = 0, late = 0;
  long long undecided = 0, over_time = 0, crashed = 0;
  std::vector<double> time_s;             ///< of decided and undecided answers
  std::vector<double> late_mm, early_mm;  ///< of contacts that were found, each >= 0

  void add(const Score& other);
  double worst_error_mm() const;
};

Score score(const MotionSet& set, const Method& method, const std::vector<Answer>& answers);

/// How many times as long the peer takes: geometric mean over the motions that both decided; not a
/// number when there is none.
struct Ratio {
  double times = 0.0, times_in_sum = 0.0;
  long long motions = 0;
  double accuracy_mm = 0.0;  ///< of ours: the coarsest, from 1e-6 mm on, with no larger error
  bool ours_as_good = false;
};
struct Asked {
  Method method;
  std::vector<Answer> answers;
};
Ratio ratio(const MotionSet& set, const Asked& peer, const std::vector<Asked>& all);

/// Truths of a set that the two independent methods speak of.
struct CrossCheck {
  long long asked = 0, confirmed = 0, contradicted = 0;
};
CrossCheck cross_check(const MotionSet& set, const std::vector<Asked>& all);

}  // namespace mortise::bench
