#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>

#include "client/tools/check/check.h"
#include "common/io/step/step_import.h"
#include "tests/support/effort.h"
#include "tests/support/test_data.h"

namespace mortise {
namespace {

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Bytes, references to other lines, numbers, cuts.
std::string mutant_of(std::string text, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return random() % n; };
  const std::size_t kind = below(4);
  for (std::size_t i = 0; i < 1 + below(20) && !text.empty(); ++i) {
    const std::size_t at = below(text.size());
    if (kind == 0) text[at] = static_cast<char>(random());
    if (kind == 3) text.resize(text.size() - below(text.size() / 4 + 1));
    const char mark = kind == 1 ? '#' : '.';
    const std::size_t digit = text.find(mark, at);
    if ((kind == 1 || kind == 2) && digit != std::string::npos && digit + 1 < text.size())
      text.replace(digit + 1, 1, kind == 1 ? std::to_string(below(3000)) : "9E200");
  }
  return text;
}

TEST(StepMutants, NoneReachesTheHost) {
  setenv("MORTISE_STEP_IMPORTER", MORTISE_BIN_DIR "/mortise-import-step", 1);
  const auto folder = test::data_folder() / "assemblies";
  MORTISE_NEEDS_DATA(folder);
  std::vector<std::string> originals;
  for (const char* name : {"framework_selftapping.stp", "red_cube.step", "framework_hinge_r.stp"})
    originals.push_back(bytes_of(folder / name));
  std::mt19937_64 random(20);
  const std::string file =
      testing::TempDir() + "mortise_mutant_" + std::to_string(getpid()) + ".step";
  int refused = 0, judged = 0;
  for (int i = 0; i < test::effort(25); ++i) {
    std::ofstream(file, std::ios::binary) << mutant_of(originals[i % originals.size()], random);
    auto opened = open_assembly(file);
    std::string said;
    if (!opened) said = opened.error().text;
    if (opened && !opened->usable()) said = opened->findings.back().text;
    if (!said.empty()) {
      ++refused;
      EXPECT_EQ(said.find('\n'), std::string::npos) << said;
      continue;
    }
    (void)check_scene(*opened, file, {});
    ++judged;
  }
  std::filesystem::remove(file);
  RecordProperty("refused", refused);
  RecordProperty("judged", judged);
  std::cout << refused << " refused in one line, " << judged << " judged\n";
  EXPECT_EQ(refused + judged, test::effort(25));
}

}  // namespace
}  // namespace mortise
