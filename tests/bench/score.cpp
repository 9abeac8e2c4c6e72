#include "tests/bench/score.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/constants.h"
#include "common/ccd/distance.h"
#include "common/ccd/first_contact.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A hit on a motion that is free counts as false when the parts are farther apart than was asked
// for. Peers that take no accuracy in mm are allowed this much, mm.
constexpr double kPeerAllowance_mm = 1e-3;
// Advancement on a distance of 1e-6 mm agrees with the truth when it is early by no more than this
// travel, mm: where surfaces meet at a small angle the way is long.
constexpr double kAgrees_mm = 1e-3;

double distance_at(const MotionSet& set, std::size_t item, double t) {
  CcdScratch scratch;
  return distance(*set.moving, set.items[item].motion.pose_at(t), *set.fixed, {}, scratch)
      .distance_mm;
}

// What truth is taken from where there is no other, mm.
constexpr double kFinest_mm = 1e-10;

const Asked* find(const std::vector<Asked>& all, const std::string& name) {
  for (const Asked& asked : all)
    if (asked.method.name == name) return &asked;
  return nullptr;
}

}  // namespace

double truth_error_mm(TruthSource source) {
  // Measured truths end within 1e-7 mm of distance: at grazing angles 1e-5 mm of travel.
  return source == TruthSource::kMeasured ? 1e-5 : 1e-9;
}

void find_truth(MotionSet& set) {
  if (set.truth != TruthSource::kFinest) return;
  const std::vector<Answer> answers = ask_all(ours(set, kFinest_mm), set);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    set.items[i].contact = answers[i].outcome == Outcome::kContact;
    if (set.items[i].contact) set.items[i].t_contact = answers[i].t;
  }
}

double error_mm(const MotionSet& set, std::size_t i, const Answer& answer, double accuracy_mm) {
  const MotionSet::Item& item = set.items[i];
  const bool hit = answer.outcome == Outcome::kContact;
  if (item.contact) return hit ? (answer.t - item.t_contact) * item.speed_mm : kInfinity;
  if (!hit) return 0.0;
  const double allowed_mm = accuracy_mm > 0.0 ? accuracy_mm : kPeerAllowance_mm;
  return distance_at(set, i, answer.t) > allowed_mm ? -kInfinity : 0.0;
}

void Score::add(const Score& other) {
  asked += other.asked, decided += other.decided, missed += other.missed;
  false_hits += other.false_hits, late += other.late, undecided += other.undecided;
  over_time += other.over_time, crashed += other.crashed;
  const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(time_s, other.time_s);
  append(late_mm, other.late_mm);
  append(early_mm, other.early_mm);
}

double Score::worst_error_mm() const {
  if (missed + false_hits > 0) return kInfinity;
  return late_mm.empty() ? 0.0 : std::max(largest(late_mm), largest(early_mm));
}

Score score(const MotionSet& set, const Method& method, const std::vector<Answer>& answers) {
  Score s;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Answer& answer = answers[i];
    if (answer.outcome == Outcome::kNotAsked) continue;
    ++s.asked;
    s.crashed += answer.outcome == Outcome::kCrashed;
    s.over_time += answer.outcome == Outcome::kOverTime;
    s.undecided += answer.outcome == Outcome::kUndecided;
    if (answer.outcome == Outcome::kCrashed || answer.outcome == Outcome::kOverTime) continue;
    s.time_s.push_back(answer.time_s);
    if (!answer.decided()) continue;
    ++s.decided;
    const double error = error_mm(set, i, answer, method.accuracy_mm);
    if (error == kInfinity) {
      ++s.missed;
    } else if (error == -kInfinity) {
      ++s.false_hits;
    } else if (set.items[i].contact) {
      s.late += error > std::max(truth_error_mm(set.truth), method.accuracy_mm);
      s.late_mm.push_back(std::max(0.0, error));
      s.early_mm.push_back(std::max(0.0, -error));
    }
  }
  return s;
}

Ratio ratio(const MotionSet& set, const Asked& peer, const std::vector<Asked>& all) {
  Ratio best;
  best.times = best.times_in_sum = std::numeric_limits<double>::quiet_NaN();
  for (const Asked& own : all) {
    // From the default on towards finer ones.
    if (!own.method.ours || own.method.portable || own.method.accuracy_mm > kAccuracyDefault_mm ||
        best.ours_as_good)
      continue;
    std::vector<double> ratios;
    double peer_s = 0.0, own_s = 0.0, peer_worst = 0.0, own_worst = 0.0;
    for (std::size_t i = 0; i < set.items.size(); ++i) {
      const Answer &theirs = peer.answers[i], &answer = own.answers[i];
      if (!theirs.decided() || !answer.decided()) continue;
      ratios.push_back(theirs.time_s / answer.time_s);
      peer_s += theirs.time_s, own_s += answer.time_s;
      peer_worst =
          std::max(peer_worst, std::abs(error_mm(set, i, theirs, peer.method.accuracy_mm)));
      own_worst = std::max(own_worst, std::abs(error_mm(set, i, answer, own.method.accuracy_mm)));
    }
    if (ratios.empty()) return best;
    best.times = geometric_mean(ratios);
    best.times_in_sum = peer_s / own_s;
    best.motions = static_cast<long long>(ratios.size());
    best.accuracy_mm = own.method.accuracy_mm;
    best.ours_as_good = own_worst <= std::max(peer_worst, truth_error_mm(set.truth));
  }
  return best;
}

CrossCheck cross_check(const MotionSet& set, const std::vector<Asked>& all) {
  CrossCheck check;
  const Asked* advancement = find(all, kOnDistance);
  for (std::size_t i = 0; i < set.items.size(); ++i) {
    const MotionSet::Item& item = set.items[i];
    bool contradicted = false;
    // 1. Advancement is never late and its freedom is proven; its contact is true to 1e-6 mm.
    if (advancement != nullptr && advancement->answers[i].decided()) {
      const Answer& answer = advancement->answers[i];
      const double error = error_mm(set, i, answer, advancement->method.accuracy_mm);
      ++check.asked;
      contradicted = error > truth_error_mm(set.truth) || error == -kInfinity;
      check.confirmed += !contradicted && error >= -kAgrees_mm;
    }
    // 2. Where a sub-step overlaps there was a contact before.
    for (const char* name : {kSubSteps10, kSubSteps100, kSubSteps1000}) {
      const Asked* steps = find(all, name);
      if (steps == nullptr || steps->answers[i].outcome != Outcome::kContact) continue;
      const double error = error_mm(set, i, steps->answers[i], 0.0);
      contradicted = contradicted || !item.contact || error < -truth_error_mm(set.truth);
    }
    check.contradicted += contradicted;
  }
  return check;
}

}  // namespace mortise::bench
