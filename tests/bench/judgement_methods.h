#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/judgement_ask.h"
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

/// A case as it comes to the engine. Nothing when a grade cannot be reached: a surface of the case
/// that was not recognized.
std::optional<KnownPair> with_grade(const JudgedCase& c, Grade grade);

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
