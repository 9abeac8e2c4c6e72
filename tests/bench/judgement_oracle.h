#pragma once
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/judgement_ask.h"
#include "tests/bench/report.h"
#include "tests/bench/scenes.h"

/// What an independent oracle knows of one pair, and what it counts against the engine.
namespace mortise::bench {

/// What numbers may be off, mm. Largest parts that overlap by less only touch.
constexpr double kOff_mm = 2e-4;

/// Margins are sups of the lesser depth of a point in both parts, times two: of two faces the
/// overlap, negative for a gap.
struct OracleTruth {
  double certain_mm = 0.0, possible_mm = 0.0;  ///< margin of the least, of the largest parts
  /// Both were searched: overlaps are reached at a point, but what lies apart may be a deeper point
  /// that was not found. Then only a witness tells whether real is false.
  bool searched = false;
  /// The overlap of least, largest and modelled parts, where the oracle knows it.
  std::optional<double> certain_depth_mm, possible_depth_mm, mesh_depth_mm;
  /// What the largest parts overlap by, as far as it is known to do so.
  double possible_overlap_mm() const { return possible_depth_mm.value_or(possible_mm); }
  CollisionClass collision_class() const;
  double margin_mm() const;  ///< to the nearer threshold
};

/// A tolerance zone up to that share of a size wide, about anywhere near zero.
Interval drawn_zone(Dice& dice, double size_mm, double widest_share);

/// What must not be said of a pair.
enum class Fault {
  kFalseReal = 0,  ///< the least parts are apart
  kFalseNone,      ///< the largest overlap by more than touch
  kNoWitness,      ///< real without a witness
  kWitnessOutside,
  kDepth,     ///< the overlap of the meshes is outside of its bracket
  kCertain,   ///< certain.lo above the truth
  kPossible,  ///< possible.hi below the truth
};
constexpr std::size_t kFaults = 7;
const char* name_of(Fault fault);

/// May a class be followed by another when more is asked? Potential may be decided. Fake and none
/// are one word: no real parts interfere. Where meshes overlap by less than the accuracy either is
/// said.
bool refines(CollisionClass lazy, CollisionClass full);

/// "real", "potential", "fake", "none"
const char* word_of(CollisionClass collision_class);

/// Faults of one answer. witness_depth_mm: of the witness in both least parts, the lesser; none: no
/// witness. Empty: nothing is wrong.
std::vector<Fault> faults_of(const OracleTruth& truth, const Word& word,
                             std::optional<double> witness_depth_mm);

/// What was said of many pairs in one way of asking.
struct OracleScore {
  long long cases = 0, capped = 0;
  std::array<std::array<long long, 3>, 3> confusion{};  ///< truth, word: real, potential, neither
  std::array<long long, kFaults> faults{};
  long long decided = 0, found = 0;  ///< truths decided by more than 0.5 um
  std::vector<double> time_s;

  /// Is a truth left open that is decided by more than 0.5 um?
  bool add(const OracleTruth& truth, const Word& word, const std::vector<Fault>& wrong);
  double found_percent() const;
  long long contradictions() const;  ///< of classes and witnesses
  long long false_numbers() const;   ///< of brackets
};

/// Prints one answer in full.
void tell_oracle(const std::string& what, const OracleTruth& truth, const Word& word,
                 const std::string& text);

/// One pair as a run asks for it: its truth, and how deep a point lies in both least parts.
struct OracleCase {
  std::string name;  ///< "convex:12"
  std::string text;
  KnownPair pair;
  Pose X_WA, X_WB;
  OracleTruth truth;
  std::function<double(const Vec3& p_W)> least_depth_mm;
};

/// How a pair is asked: in one order, lazily; in the other order and in full as wanted.
struct OracleAsk {
  std::string way;
  bool swapped = false, other_order = false, full = false;
  bool tell_all = false;  ///< prints every answer
};

/// All ways of asking about the pairs of a section, and its table and bars. Prints what is wrong.
class OracleRun {
 public:
  /// Pairs are asked some at a time, in a process of their own: a check of the engine that fails
  /// ends it, and is counted.
  void add(OracleCase c, const OracleAsk& ask);
  /// Asks what is left; before any figure is read.
  void finish();

  long long contradictions() const;
  long long crashes() const { return crashes_; }  ///< checks of the engine that failed
  long long class_changes() const { return class_changes_; }
  const OracleScore& score(const std::string& way) const { return ways_.at(way); }
  void add_table(Report& report, const std::string& title) const;
  /// least_found_percent: of the decided truths, in every way of asking.
  void add_bars(Report& report, const std::string& section, long long least_pairs,
                double least_found_percent) const;

 private:
  struct Waiting {
    OracleCase c;
    OracleAsk ask;
  };
  struct Answers;
  class Ledger;
  static void work(const std::vector<Waiting>& waiting, Ledger& ledger);
  void judge(const Waiting& asked, const Answers& answers);
  void note(const Waiting& asked, const Word& word, bool full, bool swapped);

  std::vector<Waiting> waiting_;
  std::map<std::string, OracleScore> ways_;
  long long pairs_ = 0, crashes_ = 0;
  long long asked_again_ = 0, class_changes_ = 0;  ///< lazy to full but potential to decided
  long long asked_swapped_ = 0, order_changes_ = 0;
};

}  // namespace mortise::bench
