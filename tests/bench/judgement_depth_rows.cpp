// The depth of two meshes with known exact answer, however they are cut into triangles.
#include <map>

#include "tests/bench/judgement_methods.h"
#include "tests/bench/judgement_score.h"
#include "tests/bench/judgement_sections.h"
#include "tests/bench/statistics.h"
#include "tests/support/known_depths.h"
#include "tests/support/refine.h"

namespace mortise::bench {
namespace {

constexpr double kExact_mm = 1e-4;

JudgedCase case_of(const shapes::KnownDepth& known, std::mt19937_64& random, int cuts) {
  JudgedCase c;
  c.a.solid = shapes::solid(shapes::refined(known.a, cuts, random));
  c.b.solid = shapes::solid(shapes::refined(known.b, cuts, random));
  c.X_WA = c.X_WB = shapes::random_pose(random, 300.0);
  c.mesh_depth_mm = known.depth_mm;
  return c;
}

struct Errors {
  std::vector<double> ours_mm, fcl_mm, vertices_mm, ours_s, fcl_s, vertices_s;
  std::size_t triangles = 0;
};

}  // namespace

void section_depth(Report& report, const JudgementOptions& options) {
  std::mt19937_64 random(41);
  std::map<std::string, Errors> all;
  std::vector<double> ours_mm;
  const int rounds = options.quick ? 1 : 6;
  for (const int n : {1, 2, 4, 8})
    for (int round = 0; round < rounds; ++round)
      for (const shapes::KnownDepth& known : shapes::known_depths(n)) {
        const JudgedCase c = case_of(known, random, round == 0 ? 0 : 40);
        const auto pair = with_grade(c, Grade::kDeclared);
        const Word ours = ask_ours(c, *pair, {Refinement::kFull, round % 2 == 1, kFullWorkCap});
        const Word fcl = FclPair(c).ask(c), vertices = ask_vertices(c);
        Errors& e = all[known.name];
        e.triangles = std::max(
            e.triangles, c.a.solid->mesh().triangles.size() + c.b.solid->mesh().triangles.size());
        const auto error = [&](const Word& word) {
          return word.depth_mm ? bracket_error_mm(*word.depth_mm, known.depth_mm) : known.depth_mm;
        };
        e.ours_mm.push_back(error(ours));
        e.fcl_mm.push_back(error(fcl));
        e.vertices_mm.push_back(error(vertices));
        e.ours_s.push_back(ours.time_s);
        e.fcl_s.push_back(fcl.time_s);
        e.vertices_s.push_back(vertices.time_s);
        ours_mm.push_back(error(ours));
      }
  report.table("Depth of meshes with a known exact depth, however they are cut (largest error, mm)",
               {"meshes", "cut in ways", "triangles up to", "ours, full bracket",
                "FCL, deepest contact", "deepest vertex", "ours ms", "FCL ms", "vertices ms"});
  for (const auto& [name, e] : all)
    report.row({name, static_cast<long long>(e.ours_mm.size()), static_cast<long long>(e.triangles),
                largest(e.ours_mm), largest(e.fcl_mm), largest(e.vertices_mm),
                1e3 * median(e.ours_s), 1e3 * median(e.fcl_s), 1e3 * median(e.vertices_s)});
  // The bracket's width is asked to be that; its ends may round.
  report.bar("depth of meshes, largest error over all cuts, mm", largest(ours_mm),
             kExact_mm * (1.0 + 1e-6), BoundKind::kAtMost);
}

}  // namespace mortise::bench
