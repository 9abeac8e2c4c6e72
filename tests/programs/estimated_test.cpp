// A curve that no known surface fits, judged by the estimate of its mesh error alone: a cam whose
// true outline is known, beside a block, from scenario file to verdict.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "client/tools/generate/write_mesh.h"
#include "tests/support/programs.h"
#include "tests/support/shapes.h"

namespace mortise {
namespace {

using nlohmann::json;
using test::run;

std::array<double, 2> on_outline(double angle_rad) {
  const double r = 10.0 + std::cos(3.0 * angle_rad + 1.0) + 0.5 * std::sin(2.0 * angle_rad);
  return {r * std::cos(angle_rad), r * std::sin(angle_rad)};
}

double farthest_x(int steps) {
  double most = 0.0;
  for (int i = 0; i < steps; ++i)
    most = std::max(most, on_outline(2.0 * std::numbers::pi * i / steps)[0]);
  return most;
}

constexpr int kCorners = 36;

TriangleMesh cam() {
  std::vector<std::array<double, 2>> outline;
  std::vector<std::array<std::uint32_t, 3>> cut;  // a fan about a corner: the cam bulges everywhere
  for (int i = 0; i < kCorners; ++i)
    outline.push_back(on_outline(2.0 * std::numbers::pi * i / kCorners));
  for (std::uint32_t i = 1; i + 1 < kCorners; ++i) cut.push_back({0, i, i + 1});
  return shapes::prism(outline, cut, 0.0, 20.0);
}

class Estimated : public test::InFolder {
 protected:
  // The only region of a block whose left face stands at x_mm; null when there is none.
  json judged(double x_mm, const std::string& deviation) const {
    {
      std::ofstream out(folder_ / "cam.obj");
      write_obj(cam(), {}, out);
    }
    const std::string scenario =
        file("cam.yaml",
             "name: cam\nunits: mm\nparts:\n"
             "  - {name: block, generator: {kind: block, x: 20, y: 30, z: 10}, pose: {position: [" +
                 std::to_string(x_mm + 10.0) +
                 ", 0, 10]}}\n"
                 "  - {name: cam, mesh: {file: cam.obj, unit: mm}, moving: true, deviation: " +
                 deviation + "}\n");
    EXPECT_EQ(run("mortise-lint", scenario).exit_code, 0);
    const json document = run("mortise-judge", scenario + " --json").document();
    if (document.at("pairs").empty() || document.at("pairs").at(0).at("verdicts").empty())
      return nullptr;
    return document.at("pairs").at(0).at("verdicts").at(0);
  }
};

TEST_F(Estimated, DecidesWithItsProvenance) {
  const double mesh_mm = farthest_x(kCorners), true_mm = farthest_x(100'000);
  ASSERT_GT(true_mm - mesh_mm, 0.05);  // so much of the curve the mesh does not show
  struct Case {
    double x_mm;
    const char* expected;
  };
  for (const Case& c : {Case{mesh_mm - 0.3, "real"}, Case{mesh_mm - 0.02, "real"},
                        Case{0.5 * (mesh_mm + true_mm), "potential"}}) {
    const json verdict = judged(c.x_mm, "estimated");
    ASSERT_FALSE(verdict.is_null()) << c.x_mm;
    EXPECT_EQ(verdict.at("class"), c.expected) << c.x_mm;
    EXPECT_EQ(verdict.at("grade"), "estimated") << verdict;
    const std::string why = verdict.at("explanation");
    EXPECT_NE(why.find("by estimate"), std::string::npos) << why;
    EXPECT_NE(why.find("not guaranteed"), std::string::npos) << why;
    // The estimate covers what the mesh hides of the true outline, and is no blank cheque.
    EXPECT_LE(verdict.at("fake_below_mm").get<double>(), mesh_mm - true_mm) << verdict;
    EXPECT_GE(verdict.at("fake_below_mm").get<double>(), 4.0 * (mesh_mm - true_mm)) << verdict;
  }
  EXPECT_TRUE(judged(mesh_mm + 0.4, "estimated").is_null());
}

// The disease: between mesh and true outline the mesh by itself sees nothing.
TEST_F(Estimated, WithoutAnEstimateTheHiddenPartIsMissed) {
  EXPECT_TRUE(judged(0.5 * (farthest_x(kCorners) + farthest_x(100'000)), "none").is_null());
}

}  // namespace
}  // namespace mortise
