// Judgement: real, potential, fake against analytic truth; run time against error. See README.md.
#include "tests/bench/judgement_sections.h"

namespace mortise::bench {

const std::vector<JudgementSection>& judgement_sections() {
  static const std::vector<JudgementSection> all = {
      {"truth", "random fits against their exact truth, every grade, beside peers", section_truth},
      {"realization", "real surfaces drawn inside their zones", section_realization},
      {"recognition", "surfaces found again in their meshes", section_recognition},
      {"depth", "meshes of known exact depth, however they are cut", section_depth},
      {"speed", "judging beside first contact, decided beside full", section_speed},
      {"convex", "convex polyhedra with bands against linear programs", section_convex},
      {"csg", "unions and differences of simple solids against their membership", section_csg},
      {"gpd", "random pairs against their exact depth, and against a longer search", section_gpd},
      {"covers", "the demo's fits with covers and without", section_covers},
      {"places", "the same part twice, one inside another", section_places},
      {"insertion", "a shaft through its bore, tick by tick", section_insertion},
  };
  return all;
}

namespace {

int run(int argc, char** argv) {
  JudgementOptions options;
  CLI::App app("Judgement: real, potential, fake against exact truth; run time against error");
  add_bench_options(app, options, judgement_sections());
  app.add_option("--plot", options.plot_file, "draw time against error to this SVG file");
  app.add_option("--cases", options.cases, "random cases of the sections truth, convex and csg");
  app.add_option("--from", options.from, "first seed of the sections convex and csg");
  app.add_option("--case", options.one_case, "FAMILY:SEED as the run named it: only this, in full");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (!options.one_case.empty()) {
    if (tell_case(options.one_case)) return 0;
    std::fprintf(stderr,
                 "--case %s: no such case; a family (cylinder, cone, ball, key, blocks, "
                 "convex, csg), a colon, a seed\n",
                 options.one_case.c_str());
    return 2;
  }
  return run_sections(options, judgement_sections());
}

}  // namespace
}  // namespace mortise::bench

int main(int argc, char** argv) { return mortise::bench::run(argc, argv); }
