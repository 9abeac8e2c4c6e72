// Are the surfaces that a mesh was made from found in it again, and what does that cost?
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "common/generators/generators.h"
#include "common/io/mesh/mesh_import.h"
#include "common/math/rotation.h"
#include "tests/bench/judgement_cases.h"
#include "tests/bench/judgement_recognition.h"
#include "tests/bench/judgement_sections.h"
#include "tests/bench/statistics.h"
#include "tests/support/test_folder.h"
#include "tests/unit/ccd/workload.h"

namespace mortise::bench {
namespace {

constexpr double kFoundBar = 99.0;
// Recognition beside the import of the same file, wall time.
constexpr double kImportsBar = 2.0;
constexpr std::uint64_t kSeed = 3'000'000;

/// A mesh and the curved features that it has, in one frame.
struct Made {
  std::string name;
  SolidPtr solid;
  std::vector<Feature> features;
  int facets = 0;
};

void move(Made& made, const Pose& X) {
  TriangleMesh mesh = made.solid->mesh();
  for (Vec3& p : mesh.points_mm) p = X * p;
  made.solid = shapes::solid(std::move(mesh));
  for (Feature& feature : made.features) {
    feature.surface.point = X * feature.surface.point;
    feature.surface.axis = X.q * feature.surface.axis;
  }
}

using Values = std::map<std::string, double>;

/// A part of the scenario generators at a random size: chamfers, shoulders, keyseats that cut a
/// cylinder, several holes in a plate.
Made generated_part(Dice& dice, int i) {
  const double d = dice.spread(3.0, 400.0);
  const double facets = std::round(dice.spread(12.0, 512.0));
  const double phase = dice.between(-3.0, 3.0);
  const Values kinds[] = {
      {{"diameter_mm", d}, {"length_mm", 2.0 * d}, {"chamfer_mm", d * dice.between(0.03, 0.1)}},
      {{"d1_mm", d},
       {"l1_mm", 1.5 * d},
       {"d2_mm", d * dice.between(1.1, 1.25)},
       {"l2_mm", 0.5 * d},
       {"key_section", 1},
       {"key_width_mm", 0.25 * d},
       {"key_depth_mm", 0.12 * d},
       {"key_length_mm", 0.8 * d},
       {"key_offset_mm", 0.3 * d},
       {"chamfer_mm", 0.05 * d}},
      {{"length_mm", 4.0 * d},
       {"width_mm", 2.0 * d},
       {"thickness_mm", d},
       {"pitch_mm", 2.0 * d},
       {"hole1_mm", d * dice.between(0.5, 1.0)},
       {"hole2_mm", d * dice.between(0.5, 1.0)}}};
  const char* names[] = {"dowel", "shaft", "dowel_plate"};
  Values values = kinds[i % 3];
  values["facets"] = facets;
  values["phase_rad"] = phase;
  auto part = generate(names[i % 3], values);
  Made made;
  if (!part) return made;
  made.name = names[i % 3];
  made.facets = static_cast<int>(facets);
  made.features = part->features;
  made.solid = shapes::solid(std::move(part->mesh));
  return made;
}

std::vector<Made> draw_parts(std::uint64_t i) {
  constexpr Family kRound[] = {Family::kCylinder, Family::kCone, Family::kBall};
  const JudgedCase c = draw_case(kRound[i % 3], kSeed + i);
  std::vector<Made> parts = {{"shaft, cone or ball", c.a.solid, c.a.features, c.a.facets},
                             {"ring or socket", c.b.solid, c.b.features, c.b.facets}};
  Dice dice(kSeed + i);
  Made made = generated_part(dice, static_cast<int>(i));
  if (made.solid) parts.push_back(std::move(made));
  for (Made& part : parts) move(part, {dice.orientation(), 300.0 * dice.direction()});
  return parts;
}

struct Found {
  long long all = 0, found = 0, coarse = 0, coarse_found = 0;
  std::string first_missed;
  double percent() const { return 100.0 * static_cast<double>(found) / static_cast<double>(all); }
};

const char* kind_of(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::kCylinder:
      return "cylinders";
    case SurfaceKind::kCone:
      return "cones";
    case SurfaceKind::kSphere:
      return "spheres";
    default:
      return "others";
  }
}

// All digits, so that recognition sees what was made.
std::string obj_text(const TriangleMesh& mesh) {
  std::string text;
  char line[128];
  for (const Vec3& x : mesh.points_mm) {
    std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", x.x(), x.y(), x.z());
    text += line;
  }
  for (const auto& t : mesh.triangles) {
    std::snprintf(line, sizeof line, "f %u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1);
    text += line;
  }
  return text;
}

/// Files of large parts: made here, and published ones where they are.
std::map<std::string, std::string> large_files(const test::TestFolder& folder, Report& report,
                                               bool quick) {
  const double more = quick ? 1.0 : 8.0;
  const std::map<std::string, std::pair<std::string, Values>> made{
      {"gear of 200 teeth",
       {"gear", {{"teeth", 200}, {"flank_points", 8 * more}, {"facets", 128 * more}}}},
      {"housing", {"housing", {{"facets", 512 * more}}}},
      {"bolt", {"bolt", {{"turns", 20}, {"facets", 64 * more}}}}};
  std::map<std::string, std::string> files;
  for (const auto& [name, kind] : made)
    if (const auto part = generate(kind.first, kind.second))
      files[name] = folder.write(kind.first + ".obj", obj_text(part->mesh));
  for (const char* published :
       {"large/nist_ctc_02_defl_0.02mm.ply", "multires/nist_ftc_10_defl_0.02mm.stl"}) {
    const std::string file = testing::data_folder() + "/" + published;
    if (std::filesystem::exists(file))
      files[published] = file;
    else
      report.note("Not measured: " + file + " is not there; set MORTISE_DATA.");
  }
  return files;
}

void cost_rows(Report& report, bool quick) {
  const auto least_wall_s = [](auto&& call) {
    double least = 1e300;
    for (int i = 0; i < 3; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      call();
      least = std::min(
          least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    return least;
  };
  const test::TestFolder folder;
  double most = 0.0;
  report.table("Recognition beside the import of the file, wall time, least of three",
               {"part", "triangles", "import, s", "recognition, s", "ratio", "features"});
  for (const auto& [name, file] : large_files(folder, report, quick)) {
    const auto imported = import_mesh(file, 1.0);
    if (!imported) continue;
    const Solid solid(imported->mesh);
    solid.topology();
    Recognition found;
    const double import_s = least_wall_s([&] { (void)import_mesh(file, 1.0); });
    const double recognition_s = least_wall_s([&] {
      found = recognize_features(solid, {.quantum_mm = imported->report.quantum_mm, .threads = 0});
    });
    most = std::max(most, recognition_s / import_s);
    report.row({name, static_cast<long long>(solid.mesh().triangles.size()), import_s,
                recognition_s, recognition_s / import_s,
                static_cast<long long>(found.features.size())});
  }
  report.bar("recognition of a large part, in imports of its file", most, kImportsBar,
             BoundKind::kAtMost);
}

}  // namespace

void section_recognition(Report& report, const JudgementOptions& options) {
  std::map<std::string, Found> kinds;
  std::vector<double> us_per_triangle;
  const std::uint64_t count = options.quick ? 60 : 1500;
  for (std::uint64_t i = 0; i < count; ++i)
    for (const Made& part : draw_parts(i)) {
      part.solid->topology();
      const Stopwatch watch;
      const Recognition recognition = recognize_features(*part.solid);
      us_per_triangle.push_back(1e6 * watch.elapsed_s() /
                                static_cast<double>(part.solid->mesh().triangles.size()));
      for (const Feature& truth : part.features) {
        if (truth.surface.kind == SurfaceKind::kPlane || truth.triangles.empty()) continue;
        Found& kind = kinds[kind_of(truth.surface.kind)];
        const bool found = find_feature(recognition, part.solid->mesh(), truth).has_value();
        ++kind.all;
        kind.found += found;
        kind.coarse += part.facets < 24;
        kind.coarse_found += found && part.facets < 24;
        if (!found && kind.first_missed.empty())
          kind.first_missed = truth.name + " of " + part.name + ", " + std::to_string(part.facets) +
                              " facets, draw " + std::to_string(i);
      }
    }
  report.table(
      "Surfaces found again in the mesh, within 0.1 um + 1e-6 R",
      {"kind", "made", "found", "%", "made with 12 to 23 facets", "found ", "first missed"});
  for (const auto& [kind, f] : kinds) {
    report.row({kind, f.all, f.found, f.percent(), f.coarse, f.coarse_found, f.first_missed});
    report.bar(kind + " found again, %", f.percent(), kFoundBar, BoundKind::kAtLeast);
  }
  report.note("recognition: median " + std::to_string(median(us_per_triangle)) +
              " us a triangle, p99 " + std::to_string(quantile(us_per_triangle, 0.99)));
  cost_rows(report, options.quick);
}

}  // namespace mortise::bench
