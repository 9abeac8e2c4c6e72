#include "client/tools/check/propose.h"

#include <fmt/format.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>

#include "common/evaluation/tolerance.h"
#include "common/io/scenario/mesh_scenario.h"

namespace mortise {
namespace {

// "arm/servo_2/horn" as "arm/servo_*/horn": siblings that are numbered are of one kind.
std::string pattern_of(const std::string& path) {
  std::string pattern;
  for (std::size_t from = 0; from <= path.size();) {
    const std::size_t to = std::min(path.find('/', from), path.size());
    std::string piece = path.substr(from, to - from);
    const std::size_t cut = piece.rfind('_');
    if (cut != std::string::npos && cut + 1 < piece.size() &&
        piece.find_first_not_of("0123456789", cut + 1) == std::string::npos)
      piece = piece.substr(0, cut) + "*";
    pattern += (from == 0 ? "" : "/") + piece;
    from = to + 1;
  }
  return pattern;
}

struct Question {
  std::string a, b, size, shaft;
  std::size_t count = 0;
};

std::map<std::string, Question> questions_of(const World& world, const CheckReport& report) {
  std::map<std::string, Question> questions;
  for (const CheckedPair& pair : report.pairs)
    for (const CoaxialPair& coaxial : pair.mating.pairs) {
      if (coaxial.relation != MatingKind::kFitNotStated &&
          coaxial.relation != MatingKind::kPressFit)
        continue;
      for (const auto& [a, b] : pair.all) {
        Question asked;
        asked.a = pattern_of(world.find(a)->name);
        asked.b = pattern_of(world.find(b)->name);
        asked.size = size_text(coaxial.hole_mm);
        asked.shaft = size_text(coaxial.shaft_mm);
        const std::string key = asked.a + "|" + asked.b + "|" + asked.size + "|" + asked.shaft;
        Question& question = questions.try_emplace(key, asked).first->second;
        ++question.count;
      }
    }
  return questions;
}

}  // namespace

std::string proposal_of(const OpenedScene& opened, const CheckReport& report,
                        const std::string& step) {
  const std::filesystem::path file(step);
  std::string text =
      "# What " + file.filename().string() +
      " does not say. Fill in, take away the '#', and mortise check reads it the next time.\n" +
      assembly_yaml(file, {}) +
      "  # general: ISO 2768-m   # of the title block\n"
      "  # bought: [\"*servo*\"]   # what is inside of these is not reported\n";
  const auto questions = questions_of(opened.scene.world, report);
  if (questions.empty()) return text + "# No hole and shaft of the same size meet.\n";
  text += "fits: []   # take away the [] with the first answer\n";
  for (const auto& [key, q] : questions)
    text += fmt::format(
        "  # {0} × Ø{4} in Ø{1}, coaxial: fit not stated; H7/g6? H7/k6? H7/p6?\n"
        "  # - {{between: [{2}, {3}], code: \"Ø{1} H7/??\"}}\n",
        q.count, q.size, yaml_word(q.a), yaml_word(q.b), q.shaft);
  return text;
}

Status write_proposal(const OpenedScene& opened, const CheckReport& report,
                      const std::string& step) {
  const std::filesystem::path file = std::filesystem::path(step).replace_extension(".mortise.yaml");
  if (std::filesystem::exists(file))
    return fail(Code::kRuntime,
                file.string() + ": is there already, with your answers; move it away first");
  std::ofstream out(file, std::ios::binary);
  out << proposal_of(opened, report, step);
  out.close();
  return out ? ok() : Status(fail(Code::kRuntime, file.string() + ": cannot be written"));
}

}  // namespace mortise
