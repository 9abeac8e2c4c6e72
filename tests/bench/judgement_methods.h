#pragma once
#include <optional>
#include <string>
#include <vector>

#include "common/session/tick/judgement.h"
#include "tests/bench/judgement_cases.h"

namespace mortise::bench {

/// What is known of the surfaces behind the mesh.
enum class Grade { kDeclared = 0, kRecognized, kChord, kEstimated };
constexpr Grade kGrades[] = {Grade::kDeclared, Grade::kRecognized, Grade::kChord,
                             Grade::kEstimated};
const char* name_of(Grade grade);
/// Does the grade add anything to a case? The last two are about curved faces.
bool applies(Grade grade, const JudgedCase& c);
/// A statement of a grade without features is one of the whole part.
bool speaks_of_whole(Grade grade, const JudgedCase& c);

/// A case as it comes to the engine: both parts with their bands. Nothing when a grade cannot be
/// reached: a surface of the case that was not recognized.
struct KnownPair {
  Part a, b;
};
std::optional<KnownPair> with_grade(const JudgedCase& c, Grade grade);

/// One word about a case, of ours or of a peer.
struct Word {
  CollisionClass collision_class = CollisionClass::kNone;
  double time_s = 0.0;               ///< CPU
  std::optional<Interval> depth_mm;  ///< of the meshes: bracket, or the one value of a peer
  std::optional<Interval> certain_mm, possible_mm;  ///< of the worst region
  bool capped = false;
};

constexpr std::uint64_t kFullWorkCap = 200'000;  ///< what a full bracket may take
struct AskOurs {
  Refinement refinement = Refinement::kDecided;
  bool swapped = false;             ///< B before A
  std::uint64_t work_cap = 10'000;  ///< a tick's, see kTickOverlapCap in the session
};
Word ask_ours(const JudgedCase& c, const KnownPair& pair, const AskOurs& how);

/// FCL's contacts, deepest penetration, against a threshold of zero.
class FclPair {
 public:
  explicit FclPair(const JudgedCase& c);
  ~FclPair();
  Word ask(const JudgedCase& c) const;

 private:
  struct Models;
  std::unique_ptr<Models> models_;
};

/// Deepest vertex of each mesh in the other, against a threshold of zero.
Word ask_vertices(const JudgedCase& c);

}  // namespace mortise::bench
