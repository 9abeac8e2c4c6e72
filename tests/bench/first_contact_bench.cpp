// First contact: run time against error beside its peers, and what it stands on. See README.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>

#include "tests/bench/sections.h"

namespace mortise::bench {

const std::vector<Section>& sections() {
  static const std::vector<Section> all = {
      {"rows", "first contact beside its peers: time against error", section_rows},
      {"distance", "distance of two meshes beside FCL's", section_distance},
      {"build", "building of the tree beside FCL's", section_build},
      {"triangles", "cost against the number of triangles", section_triangles},
      {"threads", "cost against the number of threads", section_threads},
      {"tick", "cost of a tick against parts and movers", section_tick},
  };
  return all;
}

namespace {

constexpr int kFigureNotMet = 5;

int run(int argc, char** argv) {
  Options options;
  CLI::App app("First contact: run time against error, beside peers, in one run");
  std::vector<std::string> names;
  for (const Section& section : sections()) names.push_back(section.name);
  app.add_option("--json", options.json_file, "write all tables and bars to this file");
  app.add_option("--plot", options.plot_file, "draw time against error to this SVG file");
  app.add_option("--only", options.only, "these sections only")->check(CLI::IsMember(names));
  app.add_flag("--quick", options.quick, "fewer queries, below a minute; rougher figures");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  Report report;
  for (const Section& section : sections())
    if (options.only.empty() ||
        std::find(options.only.begin(), options.only.end(), section.name) != options.only.end())
      section.run(report, options);
  report.print_bars();
  if (!options.json_file.empty()) {
    std::ofstream out(options.json_file);
    out << report.json().dump(2) << "\n";
    if (!out.flush()) {
      std::fprintf(stderr, "cannot write %s\n", options.json_file.c_str());
      return 1;
    }
  }
  return report.all_bars_hold() ? 0 : kFigureNotMet;
}

}  // namespace
}  // namespace mortise::bench

int main(int argc, char** argv) { return mortise::bench::run(argc, argv); }
