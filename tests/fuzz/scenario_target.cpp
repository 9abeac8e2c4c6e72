#include <nlohmann/json.hpp>
#include <string>

#include "client/tools/judge/judge_report.h"
#include "client/tools/lint/lint.h"
#include "common/base/check.h"
#include "common/base/json_text.h"
#include "common/base/plain_text.h"
#include "common/base/ranges.h"
#include "common/io/log/session_log.h"
#include "common/io/log/session_log_read.h"
#include "common/io/scenario/open_scene.h"
#include "tests/fuzz/targets.h"
#include "tests/support/test_folder.h"

namespace mortise::test {
namespace {

// Beyond this an honest scenario takes its time, and a run of many would see few of them.
constexpr std::size_t kMostParts = 40, kMostTriangles = 2500;

void need_line(const std::string& text) {
  MORTISE_CHECK(!text.empty() && is_text(text), "one line of text");
}

// Files are not asked for: every name is a small solid, in the unit that the scenario says.
Result<ImportedMesh> mesh_of(const Scenario& scenario, const Scenario::PartSpec& part) {
  if (!part.mesh.generator.empty()) return default_meshes()(scenario, part);
  const double mm = 10.0 * part.mesh.unit_mm;
  if (!within(mm, 1e7)) return fail(Code::kInvalidInput, "too large for a mesh file");
  ImportedMesh solid;
  solid.mesh = {{Vec3(0, 0, 0), Vec3(mm, 0, 0), Vec3(0, mm, 0), Vec3(0, 0, mm)},
                {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  solid.report.file = part.mesh.file;
  solid.report.closed = true;
  return solid;
}

std::size_t triangles_of(const World& world) {
  std::size_t count = 0;
  for (const Part& part : world.parts) count += part.solid->mesh().triangles.size();
  return count;
}

void check(const Scenario& scenario) {
  MORTISE_CHECK(is_name(scenario.name), "a name that one can see");
  for (const auto& part : scenario.parts) {
    MORTISE_CHECK(is_name(part.name), "a name that one can see");
    MORTISE_CHECK((part.X_WP.p.array().abs() <= kLongest_mm).all(), "a place in the world");
    MORTISE_CHECK(valid(part.X_WP), "a rigid motion");
  }
}

// What a server does before it meets anybody: its log begins, and gives the same scene back.
void begin_log(const OpenedScene& opened, const std::string& yaml) {
  const TestFolder folder;
  const auto file = folder.path() / "log.mcap";
  const LogHeader header = log_header(opened.scene, "fuzz", opened.scenario.file, yaml);
  auto writer = SessionLogWriter::create(file, header);
  MORTISE_CHECK(writer && (*writer)->close(), "a log that can be written");
  const auto log = read_session_log(file);
  MORTISE_CHECK(log && log->scenario_yaml == yaml && log->mesh_of_part == header.mesh_of_part,
                "a log that says what was written");
}

}  // namespace

bool fuzz_scenario(std::span<const std::uint8_t> input) {
  const std::string yaml(reinterpret_cast<const char*>(input.data()), input.size());
  auto reading = read_scenario_text(yaml, "fuzz.yaml");
  if (!reading) {
    need_line(reading.error().text);
    return false;
  }
  for (const Finding& finding : reading->findings) need_line(finding.text);
  if (!reading->usable()) return false;
  OpenedScene opened{std::move(reading->scenario), {}, std::move(reading->findings), {}};
  check(opened.scenario);
  if (opened.scenario.parts.size() > kMostParts) return true;
  auto scene = load_scene(opened.scenario, mesh_of);
  if (!scene) {
    need_line(scene.error().text);
    return false;
  }
  opened.scene = std::move(*scene);
  for (const Finding& finding : opened.scene.findings) {
    need_line(finding.text);
    opened.findings.push_back(finding);
  }
  MORTISE_CHECK(is_text(json_text(lint_json(opened), -1)), "JSON on one line");
  MORTISE_CHECK(utf8_prefix(lint_text(opened, false)) == lint_text(opened, false).size(), "UTF-8");
  if (!opened.usable()) return false;
  if (triangles_of(opened.scene.world) > kMostTriangles) return true;
  begin_log(opened, yaml);
  Scratch scratch(1);
  const JudgeReport report = judge_world(opened.scene.world, scratch, false);
  MORTISE_CHECK(is_text(lint_json(opened).dump()), "no text that needs to be replaced");
  MORTISE_CHECK(is_text(judge_json(opened, report).dump()), "no text that needs to be replaced");
  MORTISE_CHECK(!judge_text(opened, report, {false, true}).empty(), "words");
  return true;
}

}  // namespace mortise::test
