#pragma once
#include <memory>
#include <tuple>
#include <vector>

#include "common/ccd/first_contact.h"
#include "tests/stress/exact.h"

namespace mortise::stress {

/// One question of a sweep.
struct Case {
  SolidPtr a, b;
  Motion motion_a, motion_b;
  double accuracy_mm = kAccuracyDefault_mm;
  double separation_mm = 0.0;
  bool check_contained = false;
  bool ask_fcl = true;  ///< off where FCL's absolute epsilons make its answers wrong
};

ContactQuery query_of(const Case& c);

/// The pair at any time of its motion, every pair of triangles asked, long double.
class Oracle {
 public:
  explicit Oracle(const Case& c);
  ~Oracle();
  Oracle(const Oracle&) = delete;
  Oracle& operator=(const Oracle&) = delete;

  /// Distance of the surfaces less the separation asked for, mm; below 0 where surfaces pass
  /// through each other. Nothing beyond `limit_mm` is looked at, which is then the answer.
  Real gap_mm(double t, Real limit_mm);
  /// A shell of one lies inside the other; for surfaces that do not meet.
  bool contained(double t);

  /// No point of either body is faster than this towards the other, mm per tick.
  Real speed_mm() const { return speed_; }
  /// What the kernel may take off for rounding, 32 u (L + D), and the accuracy it then holds.
  double rounding_mm() const { return rounding_; }
  double accuracy_mm() const { return accuracy_; }

  struct Advanced {
    double t = 0.0;      ///< proven free up to here
    bool done = false;   ///< reached the end asked for
    bool tired = false;  ///< out of steps
  };
  /// Conservative advancement on FCL's distance(), in units of the larger part, until `t_end` or
  /// until FCL's distance is 1e-3 of them; FCL is not asked below, where it fails.
  Advanced advance_by_fcl(double t_end);
  /// The same on the own distance down to floor_mm, from t.
  Advanced advance(double t, double t_end, Real floor_mm, int most_steps);

  /// Looks at even steps of [0, t_end] and ever closer before t_end; the first look that sees
  /// contact is bisected against the look before. Infinite when none does.
  double first_seen(double t_end, int looks);

 private:
  struct Body;
  struct FclPair;
  Placement a_from_b(double t) const;

  const Case& case_;
  std::unique_ptr<Body> a_, b_;
  std::unique_ptr<FclPair> fcl_;
  Real speed_ = 0, size_ = 0;
  double rounding_ = 0.0, accuracy_ = 0.0;
  std::uint32_t hint_a_ = 0, hint_b_ = 0;  // the pair that was nearest last time
  std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> candidates_;
};

/// What the oracles say of one answer.
struct Judgement {
  bool contact = false, free = false, at_start = false, undecided = false;
  bool missed = false;      ///< free, and an oracle sees contact
  bool late = false;        ///< contact, and an oracle sees it earlier
  bool invented = false;    ///< contact, and the parts are farther apart than the accuracy
  bool wrong = false;       ///< start state, witness points or times contradict the contract
  bool tired = false;       ///< advancement ran out of steps: only sub-steps were asked beyond
  double late_mm = 0.0;     ///< travel since the true contact
  double early_mm = 0.0;    ///< distance left at t_contact
  double witness_mm = 0.0;  ///< witness points from their triangles, and their distance
  bool good() const { return !(missed || late || invented || wrong); }
};

/// Both oracles against one answer. `looks`: sub-steps.
Judgement judge(const Case& c, const FirstContact& answer, int looks);

}  // namespace mortise::stress
