// First contact: run time against error beside its peers, and what it stands on. See README.md.
#include "tests/bench/sections.h"

namespace mortise::bench {

const std::vector<Section>& sections() {
  static const std::vector<Section> all = {
      {"rows", "first contact beside its peers: time against error", section_rows},
      {"distance", "distance of two meshes beside FCL's", section_distance},
      {"bounds", "distance beside rectangle swept spheres, crossing beside FCL's", section_bounds},
      {"build", "building of the tree beside FCL's", section_build},
      {"triangles", "cost against the number of triangles", section_triangles},
      {"threads", "cost against the number of threads", section_threads},
      {"tick", "cost of a tick against parts and movers", section_tick},
  };
  return all;
}

namespace {

int run(int argc, char** argv) {
  Options options;
  CLI::App app("First contact: run time against error, beside peers, in one run");
  add_bench_options(app, options, sections());
  app.add_option("--plot", options.plot_file, "draw time against error to this SVG file");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return run_sections(options, sections());
}

}  // namespace
}  // namespace mortise::bench

int main(int argc, char** argv) { return mortise::bench::run(argc, argv); }
