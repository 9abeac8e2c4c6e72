// The program mortise-inspect from outside: what it prints of parts whose surfaces are known, and
// that what it proposes is a scenario which lint passes and judge decides rightly.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "client/tools/generate/write_mesh.h"
#include "tests/support/numbers.h"
#include "tests/support/programs.h"
#include "tests/support/test_data.h"
#include "tests/support/turned_part.h"

namespace mortise {
namespace {

using nlohmann::json;
using test::Outcome;
using test::run;

double sagitta_mm(double radius_mm, int facets) {
  return radius_mm * (1.0 - std::cos(kPi / facets));
}

// Corner of the first facet of the peg over the middle of one of the bore's: the meshes overlap.
constexpr double kHalfStep32_rad = kPi / 32;

class Inspect : public test::InFolder {
 protected:
  std::string mesh_file(const std::string& name, const TriangleMesh& mesh) const {
    const auto path = folder_ / name;
    std::ofstream out(path);
    write_obj(mesh, {}, out);
    return path.string();
  }
  std::string generated(const std::string& name, const std::string& what) const {
    const std::string path = (folder_ / name).string();
    EXPECT_EQ(run("mortise-generate", what + " -o " + path).exit_code, 0) << what;
    return path;
  }
  // What inspect proposes, as a scenario file; `position` is that of the last part.
  std::string proposed(const std::string& meshes, const std::string& position = "") const {
    const Outcome seen = run("mortise-inspect", meshes);
    EXPECT_EQ(seen.exit_code, 0) << meshes << seen.err;
    std::string yaml = seen.out;
    const std::string origin = "[0, 0, 0]";
    if (!position.empty()) yaml.replace(yaml.rfind(origin), origin.size(), position);
    return yaml;
  }
  // With the proposed fits stated: a person removes '#' and writes a class.
  static std::string with_fits(std::string yaml, const std::string& code) {
    std::size_t at = yaml.find("#fits:");
    EXPECT_NE(at, std::string::npos) << yaml;
    for (; at != std::string::npos; at = yaml.find("\n#", at)) yaml.erase(yaml.find('#', at), 1);
    return replaced(std::move(yaml), "code: ??", "code: " + code);
  }
  // Class of the worst region of the only pair; "" when there is none.
  std::string judged(const std::string& yaml) const {
    const std::string scenario = file("proposed.yaml", yaml);
    const Outcome lint = run("mortise-lint", scenario + " --json");
    EXPECT_EQ(lint.exit_code, 0) << yaml << lint.out;
    const json judged = run("mortise-judge", scenario + " --json").document();
    if (judged.is_discarded() || judged.at("pairs").empty()) return "";
    std::string worst;
    for (const json& verdict : judged.at("pairs").at(0).at("verdicts")) {
      const std::string found = verdict.at("class");
      const auto rank = [](const std::string& c) {
        return c == "real" ? 3 : c == "potential" ? 2 : c == "fake" ? 1 : 0;
      };
      if (rank(found) > rank(worst)) worst = found;
    }
    return worst;
  }
  /// The recognized bore and shaft declared by hand.
  static std::string with_features(std::string yaml) {
    for (const char* name : {"bore_1", "shaft_1"}) {
      yaml = replaced(yaml, std::string("#      ") + name, std::string("       ") + name);
      yaml = replaced(yaml, "#    features:", "    features:");
    }
    return yaml;
  }
  static std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what << " is not in\n" << text;
    return at == std::string::npos ? text : text.replace(at, what.size(), by);
  }
};

struct Stated {
  const char* kind;
  bool inward;
  double radius_mm, tube_mm, half_angle_rad;
  unsigned facets;
  double arc_rad, chord_error_mm;
};

// Finds the stated feature in a part's list and says how many there are of its kind.
int matches(const json& part, const Stated& s) {
  int found = 0;
  for (const json& f : part.at("features"))
    found += f.at("kind") == s.kind && f.at("inward") == s.inward &&
             std::fabs(f.at("radius_mm").get<double>() - s.radius_mm) < 1e-5 &&
             std::fabs(f.at("tube_radius_mm").get<double>() - s.tube_mm) < 1e-5 &&
             std::fabs(f.at("half_angle_rad").get<double>() - s.half_angle_rad) < 1e-5 &&
             (s.facets == 0 || f.at("facets") == s.facets) &&
             std::fabs(f.at("arc_rad").get<double>() - s.arc_rad) < 1e-4 &&
             (s.chord_error_mm < 0.0 ||
              std::fabs(f.at("chord_error_mm").get<double>() - s.chord_error_mm) <
                  0.03 * s.chord_error_mm + 1e-5);
  return found;
}

// Outside: cylinder, cone, fillet and ball; inside a bore with a countersink; a half turn of it.
shapes::Chain turned_outside() {
  shapes::Chain chain;
  chain.start(20.0, 0.0).line(20.0, 10.0).line(16.0, 30.0).line(12.0, 30.1);
  return chain.line(12.0, 40.0);
}

shapes::Chain bored() {
  shapes::Chain chain;
  chain.inward = true;
  return chain.start(5.0, 0.0).line(5.0, 37.0).line(8.0, 40.0);
}

TEST_F(Inspect, PrintsTheSurfacesThatThePartWasMadeOf) {
  const std::string path =
      mesh_file("turned.obj", shapes::turned_part(turned_outside(), bored(), 40));
  const json part = run("mortise-inspect", path + " --json").document().at("parts").at(0);
  EXPECT_EQ(part.at("name"), "turned");
  EXPECT_EQ(part.at("triangles"), 40 * 2 * (4 + 2 + 2));
  EXPECT_EQ(part.at("shells"), 1);
  EXPECT_TRUE(part.at("closed").get<bool>());
  EXPECT_EQ(part.at("open_edges"), 0);
  EXPECT_NEAR(part.at("size_mm").at(0).get<double>(), 40.0, 1e-5);
  EXPECT_NEAR(part.at("size_mm").at(2).get<double>(), 40.0, 1e-5);
  const double turn = 2.0 * kPi;
  for (const Stated& s :
       {Stated{"cylinder", false, 20.0, 0, 0, 40, turn, sagitta_mm(20.0, 40)},
        Stated{"cylinder", false, 12.0, 0, 0, 40, turn, sagitta_mm(12.0, 40)},
        Stated{"cylinder", true, 5.0, 0, 0, 40, turn, sagitta_mm(5.0, 40)},
        Stated{"cone", false, 0, 0, std::atan(0.2), 40, turn,
               sagitta_mm(20.0, 40) * std::cos(std::atan(0.2))},
        Stated{"cone", true, 0, 0, kPi / 4, 40, turn, sagitta_mm(8.0, 40) * std::sqrt(0.5)}})
    EXPECT_EQ(matches(part, s), 1) << s.kind << " " << s.radius_mm << "\n" << part.dump(1);
}

TEST_F(Inspect, PrintsBallFilletAndOpenArc) {
  const std::string ball = mesh_file("ball.obj", shapes::sphere(12.5, Vec3(3, 4, 5), 12));
  shapes::Chain outer, inner;
  outer.start(20.0, 0.0).line(20.0, 10.0).arc(15.0, 10.0, 0.5 * kPi, 8);
  inner.inward = true;
  inner.start(6.0, 0.0).line(6.0, 15.0);
  const std::string fillet = mesh_file("fillet.obj", shapes::turned_part(outer, inner, 48));
  const std::string half = mesh_file("half.obj", shapes::turned_part(outer, inner, 24, kPi));
  const json document =
      run("mortise-inspect", ball + " " + fillet + " " + half + " --json").document();
  const json& parts = document.at("parts");
  ASSERT_EQ(parts.size(), 3U);
  const json& sphere = parts.at(0).at("features").at(0);
  EXPECT_EQ(sphere.at("kind"), "sphere");
  EXPECT_NEAR(sphere.at("radius_mm").get<double>(), 12.5, 1e-5);
  EXPECT_NEAR(sphere.at("point_mm").at(2).get<double>(), 5.0, 1e-5);
  EXPECT_EQ(sphere.at("triangles"), parts.at(0).at("triangles"));
  const double turn = 2.0 * kPi;
  EXPECT_EQ(matches(parts.at(1), {"torus", false, 15, 5, 0, 48, turn, -1}), 1);
  EXPECT_EQ(matches(parts.at(1), {"cylinder", false, 20, 0, 0, 48, turn, -1}), 1);
  EXPECT_EQ(matches(parts.at(2), {"cylinder", false, 20, 0, 0, 24, kPi, sagitta_mm(20, 48)}), 1);
  EXPECT_EQ(matches(parts.at(2), {"cylinder", true, 6, 0, 0, 24, kPi, sagitta_mm(6, 48)}), 1);
  // Half a turn holds no shaft: it is proposed for no fit.
  for (const json& fit : document.at("fits"))
    EXPECT_EQ(fit.dump().find("half."), std::string::npos) << fit;
}

TEST_F(Inspect, CountsOpenAndNonManifoldEdgesAndTurnsTriangles) {
  TriangleMesh holed = shapes::box({5, 5, 5}, Vec3::Zero(), 2), turned = holed;
  holed.triangles.erase(holed.triangles.begin() + 6, holed.triangles.begin() + 8);  // one square
  std::swap(turned.triangles[9][0], turned.triangles[9][1]);
  // Two boxes on one edge: four triangles there.
  TriangleMesh hinged = shapes::box({5, 5, 5});
  const TriangleMesh second = shapes::box({5, 5, 5}, Vec3(10, 10, 0));
  hinged = shapes::together(std::move(hinged), second);
  const json parts =
      run("mortise-inspect", mesh_file("holed.obj", holed) + " " + mesh_file("turned.obj", turned) +
                                 " " + mesh_file("hinged.obj", hinged) + " --json")
          .document()
          .at("parts");
  EXPECT_EQ(parts.at(0).at("open_edges"), 4);
  EXPECT_FALSE(parts.at(0).at("closed").get<bool>());
  EXPECT_EQ(parts.at(1).at("misoriented_edges"), 0);
  EXPECT_TRUE(parts.at(1).at("closed").get<bool>());
  EXPECT_EQ(parts.at(2).at("non_manifold_edges"), 1);
  EXPECT_TRUE(parts.at(2).at("closed").get<bool>());
  const std::string text = run("mortise-inspect", (folder_ / "holed.obj").string()).err;
  EXPECT_NE(text.find("not closed: 4 open, 0 non-manifold, 0 misoriented edges"), std::string::npos)
      << text;
}

TEST_F(Inspect, TextHasTheSameFiguresAsJson) {
  const std::string dowel =
      generated("dowel.obj", "dowel diameter_mm=20 length_mm=40 chamfer_mm=1 facets=48");
  const std::string text = run("mortise-inspect", dowel).err;
  for (const char* piece :
       {"dowel: 380 triangles, 1 shells, size 20.000 x 20.000 x 40.000 mm, closed",
        "shaft_1     Ø20.0000", "45.000° half", "360.0    38.000",
        "2 planes; 0 of 380 triangles belong to no feature"})
    EXPECT_NE(text.find(piece), std::string::npos) << piece << "\n" << text;
  // The chord error of 48 facets of 20 mm: 21.4 um.
  EXPECT_NE(text.find("21.4\n"), std::string::npos) << text;
}

TEST_F(Inspect, UnitsAndBadInput) {
  const std::string cube = mesh_file("cube.obj", shapes::box({5, 5, 5}));
  const auto size = [&](const std::string& unit) {
    const json part = run("mortise-inspect", cube + " --json --unit " + unit).document();
    return part.at("parts").at(0).at("size_mm").at(0).get<double>();
  };
  EXPECT_NEAR(size("mm"), 10.0, 1e-6);
  EXPECT_NEAR(size("in"), 254.0, 1e-4);
  EXPECT_NEAR(size("m"), 10000.0, 1e-2);
  EXPECT_EQ(run("mortise-inspect", cube + " --unit ell").exit_code, 2);
  EXPECT_EQ(run("mortise-inspect", "").exit_code, 2);
  EXPECT_EQ(run("mortise-inspect", "/nowhere.obj").exit_code, 3);
  EXPECT_EQ(run("mortise-inspect", file("bad.yaml", "name: a\n")).exit_code, 3);
  EXPECT_EQ(run("mortise-inspect", cube + " " + file("a.yaml", "name: a\n")).exit_code, 3);
}

TEST_F(Inspect, WhatItProposesIsAScenarioThatJudgesRightly) {
  const std::string plate = generated("plate.obj", "plate_with_bore bore_mm=20 facets=32");
  const std::string peg =
      generated("peg.obj", "dowel diameter_mm=20 length_mm=40 chamfer_mm=1 facets=32 phase_rad=" +
                               std::to_string(kHalfStep32_rad));
  const std::string yaml = proposed(plate + " " + peg, "[0, 0, -10]");
  // As it stands: facets may be round or flat, and no tolerance is invented.
  EXPECT_EQ(judged(yaml), "potential");
  EXPECT_EQ(run("mortise-lint", file("as_it_stands.yaml", yaml)).out.find("H7"), std::string::npos);
  EXPECT_NE(yaml.find("#  - {between: [plate.bore_1, peg.shaft_1], code: ??}"), std::string::npos)
      << yaml;
  EXPECT_EQ(judged(with_fits(yaml, "H7/g6")), "fake");
  EXPECT_EQ(judged(with_fits(yaml, "H7/k6")), "potential");
  EXPECT_EQ(judged(with_fits(yaml, "H7/s6")), "real");
  // Declared by hand, the surfaces touch, whatever the meshes do.
  EXPECT_EQ(judged(with_features(yaml)), "fake");
}

TEST_F(Inspect, TheScenarioIsAllThatIsOnStdout) {
  const std::string a = mesh_file("a.v1.obj", shapes::box({5, 5, 5}));
  std::filesystem::create_directories(folder_ / "other");
  mesh_file("other/a.v1.obj", shapes::box({5, 5, 5}, Vec3(9, 0, 0)));
  const Outcome seen = run("mortise-inspect", "a.v1.obj other/a.v1.obj --unit cm", folder_);
  EXPECT_EQ(seen.exit_code, 0);
  EXPECT_NE(seen.err.find("a_v1: 12 triangles"), std::string::npos) << seen.err;
  EXPECT_NE(seen.out.find("unit: cm"), std::string::npos) << seen.out;
  // It judges as it stands, and as the meshes do without it.
  const std::string scenario = file("scene.yaml", seen.out);
  const Outcome by_file = run("mortise-judge", "scene.yaml --json --fail-on real", folder_);
  EXPECT_EQ(by_file.exit_code, 6) << by_file.err;
  EXPECT_EQ(by_file.err, "");
  EXPECT_EQ(run("mortise-lint", scenario).exit_code, 0);
  const Outcome by_meshes =
      run("mortise-judge", "a.v1.obj other/a.v1.obj --unit cm --json --fail-on real", folder_);
  EXPECT_EQ(by_meshes.exit_code, 6);
  EXPECT_EQ(by_file.document().at("pairs"), by_meshes.document().at("pairs"));
  EXPECT_EQ(by_meshes.document().at("pairs").at(0).at("part_b"), "a_v1_2") << by_meshes.out;
  // Apart: nothing is found, and that is no error.
  mesh_file("other/a.v1.obj", shapes::box({5, 5, 5}, Vec3(11, 0, 0)));
  EXPECT_EQ(run("mortise-judge", "scene.yaml --fail-on potential", folder_).exit_code, 0);
}

TEST_F(Inspect, AScenarioComesOutWithItsShapesAndPoses) {
  const std::string scenario = std::string(MORTISE_SOURCE_DIR) + "/scenarios/fits.yaml";
  const Outcome seen = run("mortise-inspect", scenario);
  EXPECT_EQ(seen.exit_code, 0);
  const std::string again = file("again.yaml", seen.out);
  EXPECT_EQ(run("mortise-lint", again).exit_code, 0) << seen.out;
  const auto before = run("mortise-lint", scenario + " --json").document();
  const auto after = run("mortise-lint", again + " --json").document();
  for (std::size_t i = 0; i < before.at("parts").size(); ++i)
    EXPECT_EQ(after.at("parts").at(i).at("mesh_hash"), before.at("parts").at(i).at("mesh_hash"));
  // Every peg still overlaps its own plate by the same, now without a fit.
  const auto judged_before = run("mortise-judge", scenario + " --json --full").document();
  const auto judged_after = run("mortise-judge", again + " --json --full").document();
  ASSERT_EQ(judged_after.at("pairs").size(), judged_before.at("pairs").size());
  for (std::size_t i = 0; i < judged_after.at("pairs").size(); ++i)
    EXPECT_NEAR(
        judged_after.at("pairs").at(i).at("verdicts").at(0).at("delta_mm").at(1).get<double>(),
        judged_before.at("pairs").at(i).at("verdicts").at(0).at("delta_mm").at(1).get<double>(),
        1e-6);
}

TEST_F(Inspect, SizesThatDifferAreProposedAsModelled) {
  const std::string plate = generated("plate.obj", "plate_with_bore bore_mm=20 facets=32");
  for (const auto& [diameter, clearance, expected] :
       {std::tuple{"19.98", "+0.0200", "fake"}, {"20.02", "-0.0200", "real"}}) {
    const std::string peg = generated(
        "peg.obj",
        std::string("dowel diameter_mm=") + diameter +
            " length_mm=40 chamfer_mm=1 facets=32 phase_rad=" + std::to_string(kHalfStep32_rad));
    const std::string yaml = proposed(plate + " " + peg, "[0, 0, -10]");
    EXPECT_NE(yaml.find(std::string("clearance ") + clearance), std::string::npos) << yaml;
    EXPECT_NE(yaml.find("code: Ø?? ??"), std::string::npos) << yaml;
    EXPECT_EQ(judged(yaml), "potential") << diameter;
    EXPECT_EQ(judged(with_features(yaml)), expected) << diameter;
  }
}

TEST_F(Inspect, PlacedPartsAreOnlyPairedAlongOneAxis) {
  const std::string scenario = std::string(MORTISE_SOURCE_DIR) + "/scenarios/fits.yaml";
  const json document = run("mortise-inspect", scenario + " --json").document();
  ASSERT_EQ(document.at("parts").size(), 12U);
  std::string all;
  for (const json& fit : document.at("fits")) {
    const std::string bore = fit.at("bore"), shaft = fit.at("shaft");
    // plate_g6.bore_1 with peg_g6.shaft_1
    EXPECT_EQ(bore.substr(bore.find('_') + 1, 2), shaft.substr(shaft.find('_') + 1, 2));
    EXPECT_TRUE(bore.ends_with(".bore_1") && shaft.ends_with(".shaft_1")) << bore << shaft;
    EXPECT_NEAR(fit.at("clearance_mm").get<double>(), 0.0, 1e-6);
    all += bore + " ";
  }
  EXPECT_EQ(document.at("fits").size(), 6U) << all;
}

TEST_F(Inspect, PublishedPegAndHole) {
  const auto folder = test::data_folder() / "fits/insertion";
  MORTISE_NEEDS_DATA(folder);
  const std::string meshes = (folder / "factory_round_hole_8mm_subdiv_3x.obj").string() + " " +
                             (folder / "factory_round_peg_8mm_tight.obj").string() + " --unit m";
  const json document = run("mortise-inspect", meshes + " --json").document();
  ASSERT_EQ(document.at("fits").size(), 1U) << document.at("fits");
  // The publisher states 8.1 mm and 7.995 mm.
  EXPECT_NEAR(document.at("fits").at(0).at("clearance_mm").get<double>(), 0.105, 3e-3);
  // The 36 open edges of the file are closed on import.
  EXPECT_EQ(document.at("parts").at(0).at("open_edges"), 0);
  const auto at = [&](const char* x_mm) {
    return judged(proposed(meshes, std::string("[") + x_mm + ", 0, -10]"));
  };
  EXPECT_EQ(at("0"), "");  // 52 um of room on every side
  EXPECT_EQ(at("0.04"), "");
  EXPECT_EQ(at("0.08"), "real");  // 28 um into the wall
}

}  // namespace
}  // namespace mortise
