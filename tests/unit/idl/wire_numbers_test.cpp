// The numbers that go over the wire stand in idl/README.md, for who has nothing else.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "common/messages/event.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

// An entry of a list, in lines of the length that documents have.
template <class Enum>
std::string entry(const std::string& fields) {
  constexpr std::size_t kLine = 150;
  std::string text, line = "- " + fields + ":";
  for (int value = 0; value < 256; ++value) {
    const std::string name(name_of(static_cast<Enum>(value)));
    if (name == "?") break;
    const std::string word = (value == 0 ? " " : ", ") + std::to_string(value) + " " + name;
    if (line.size() + word.size() < kLine) {
      line += word;
    } else {
      text += line + ",\n";
      line = " " + word.substr(1);
    }
  }
  return text + line + "\n";
}

std::string numbers_markdown() {
  return entry<CommandKind>("`Command.kind`") + entry<Refusal>("`refusal`, `reason`") +
         entry<Decision::Kind>("`Decision.kind`, `ClashEvent.cause`") +
         entry<ClashEvent::Kind>("`ClashEvent.kind`") +
         entry<CollisionClass>("`collision_class`, `worst_class`, index of `clashes_open`") +
         entry<Role>("`role` of users and decisions") + entry<ReviewStatus>("`Review.status`") +
         entry<ConstraintKind>("`Constraint.kind`") + entry<DeviationGrade>("`Verdict.grade`") +
         entry<FaceShape>("`Verdict.shape_a`, `shape_b`") +
         entry<SeparationWay>("`Verdict.separation_way`") +
         entry<SeparationPath>("`Verdict.separation_path`") +
         entry<Unexamined>("`UnexaminedPair.why`");
}

TEST(WireNumbers, StandInTheReadme) {
  std::ifstream file(MORTISE_SOURCE_DIR "/idl/README.md");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find("\n\n" + numbers_markdown() + "\n"), std::string::npos)
      << "idl/README.md must hold this list:\n"
      << numbers_markdown();
}

}  // namespace
}  // namespace mortise
