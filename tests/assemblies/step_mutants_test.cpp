#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <random>

#include "common/io/scenario/assembly_parts.h"
#include "tests/assemblies/support.h"
#include "tests/support/effort.h"

namespace mortise {
namespace {

constexpr double kMost_s = 60.0;
constexpr long kMost_kB = 2L << 20;

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Bytes, references to other lines, numbers, cuts, and lines that repeat.
std::string mutant_of(std::string text, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return random() % n; };
  const std::size_t kind = below(5);
  for (std::size_t i = 0; i < 1 + below(20) && !text.empty(); ++i) {
    const std::size_t at = below(text.size());
    if (kind == 0) text[at] = static_cast<char>(random());
    if (kind == 3) text.resize(text.size() - below(text.size() / 4 + 1));
    if (kind == 4) text.insert(at, text.substr(below(text.size()), below(2000)));
    const char mark = kind == 1 ? '#' : '.';
    const std::size_t digit = text.find(mark, at);
    if ((kind == 1 || kind == 2) && digit != std::string::npos && digit + 1 < text.size())
      text.replace(digit + 1, 1, kind == 1 ? std::to_string(below(3000)) : "9E200");
  }
  return text;
}

std::string step_of(const std::string& entities) {
  return "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('a','',(''),(''),'','',"
         "'');\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n" +
         entities + "ENDSEC;\nEND-ISO-10303-21;\n";
}

// Files that say little and ask for much.
std::vector<std::string> bombs() {
  std::string brackets = "#1=CARTESIAN_POINT('',(";
  brackets += std::string(200'000, '(') + std::string(200'000, ')') + "));\n";
  std::string points;
  for (int i = 1; i < 200'000; ++i)
    points += "#" + std::to_string(i) + "=CARTESIAN_POINT('',(0.,0.,0.));\n";
  std::string chain;  // each names the next, and the last the first
  for (int i = 1; i <= 50'000; ++i)
    chain += "#" + std::to_string(i) + "=SHAPE_REPRESENTATION('',(#" +
             std::to_string(i % 50'000 + 1) + "),#1);\n";
  return {step_of(brackets),
          step_of(points),
          step_of(chain),
          step_of("#1=CARTESIAN_POINT('" + std::string(30'000'000, 'x') + "',(0.,0.,0.));\n"),
          step_of("#2147483647=CARTESIAN_POINT('',(1E400,0.,0.));\n#99999999999999=X();\n"),
          std::string(1'000'000, '\0'),
          std::string(1'000'000, '#'),
          "ISO-10303-21;"};
}

// Reads and judges one file. True when it was refused; then in one line.
bool is_refused(const std::string& file) {
  const auto begin = std::chrono::steady_clock::now();
  auto opened = open_assembly(file, {{}, {}, {}, AfterReading::kKeepSolids});
  std::string said;
  if (!opened) said = opened.error().text;
  if (opened && !opened->usable()) said = opened->findings.back().text;
  EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  if (said.empty()) (void)check_scene(*opened, {});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_LE(took.count(), kMost_s + 5.0) << said;
  return !said.empty();
}

void end_of(int refused, int judged) {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  EXPECT_LE(used.ru_maxrss, kMost_kB);
  std::cout << refused << " refused in one line, " << judged << " judged, the largest child took "
            << used.ru_maxrss / 1024 << " MB\n";
}

TEST(StepMutants, NoneReachesTheHost) {
  test::use_built_importer();
  const test::TestFolder folder;
  const std::string file = folder.path() / "mutant.step";
  test::step_maker("tensioner '" + file + "'");
  std::vector<std::string> originals = {bytes_of(file)};
  for (const char* name : {"framework_selftapping.stp", "red_cube.step", "framework_hinge_r.stp"})
    if (const auto more = test::data_folder() / "assemblies" / name; std::filesystem::exists(more))
      originals.push_back(bytes_of(more));
  std::mt19937_64 random(20);
  int refused = 0, judged = 0;
  for (int i = 0; i < test::effort(8); ++i) {
    const std::string& of = originals[static_cast<std::size_t>(i) % originals.size()];
    std::ofstream(file, std::ios::binary) << mutant_of(of, random);
    ++(is_refused(file) ? refused : judged);
  }
  EXPECT_EQ(refused + judged, test::effort(8));
  end_of(refused, judged);
}

// A face that cannot be tessellated leaves its part open: told, and judged. One of the thousand
// below ended the host so, where it asked for the face beyond an open edge.
TEST(StepMutants, AnOpenPartIsToldAndJudged) {
  test::use_built_importer();
  const auto whole =
      import_step(std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios/tensioner.step");
  ASSERT_TRUE(whole) << whole.error().text;
  const StepPart& base = whole->document.parts.front();
  std::size_t told = 0;
  for (std::uint32_t face = 0; face < base.faces.size(); face += 4) {
    StepDocument document = whole->document;
    StepPart& part = document.parts.front();
    part.mesh.triangles.clear();
    part.face_of_triangle.clear();
    for (std::size_t t = 0; t < base.mesh.triangles.size(); ++t) {
      if (base.face_of_triangle[t] == face) continue;
      part.mesh.triangles.push_back(base.mesh.triangles[t]);
      part.face_of_triangle.push_back(base.face_of_triangle[t]);
    }
    auto reading = read_scenario_text("name: a\nunits: mm\nassembly: {file: a.step}\n", "s.yaml");
    ASSERT_TRUE(reading);
    add_assembly(*reading, encode(document));
    auto scene = load_scene(reading->scenario, default_meshes());
    ASSERT_TRUE(scene) << scene.error().text;
    OpenedScene opened;
    opened.scenario = reading->scenario;
    opened.scene = std::move(*scene);
    const CheckReport report = check_scene(opened, {});  // ends
    EXPECT_EQ(report.parts, whole->document.instances.size());
    told += std::any_of(opened.scene.findings.begin(), opened.scene.findings.end(),
                        [](auto& f) { return f.text.find("is open at") != std::string::npos; });
  }
  EXPECT_GT(told, 0U);  // a narrow crack is sewn
}

// 1,000 of one small file.
TEST(StepMutants, SoakAThousandOfASmallFile) {
  test::use_built_importer();
  const test::TestFolder folder;
  const std::string file = folder.path() / "mutant.step";
  test::step_maker("tensioner '" + file + "'");
  const std::string original = bytes_of(file);
  std::mt19937_64 random(1000);
  int refused = 0, judged = 0;
  for (int i = 0; i < 1000; ++i) {
    std::ofstream(file, std::ios::binary) << mutant_of(original, random);
    ++(is_refused(file) ? refused : judged);
  }
  EXPECT_EQ(refused + judged, 1000);
  end_of(refused, judged);
}

TEST(StepMutants, BombsAreRefused) {
  test::use_built_importer();
  const test::TestFolder folder;
  const std::string file = folder.path() / "bomb.step";
  int refused = 0, judged = 0;
  for (const std::string& bomb : bombs()) {
    std::ofstream(file, std::ios::binary) << bomb;
    ++(is_refused(file) ? refused : judged);
  }
  EXPECT_EQ(judged, 0);
  end_of(refused, judged);
}

}  // namespace
}  // namespace mortise
