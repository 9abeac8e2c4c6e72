// Judgement: real, potential, fake against analytic truth; run time against error. See README.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>

#include "tests/bench/judgement_sections.h"

namespace mortise::bench {

const std::vector<JudgementSection>& judgement_sections() {
  static const std::vector<JudgementSection> all = {
      {"truth", "random fits against their exact truth, every grade, beside peers", section_truth},
      {"realization", "real surfaces drawn inside their zones", section_realization},
      {"recognition", "surfaces found again in their meshes", section_recognition},
      {"depth", "meshes of known exact depth, however they are cut", section_depth},
      {"speed", "judging beside first contact, decided beside full", section_speed},
      {"insertion", "a shaft through its bore, tick by tick", section_insertion},
  };
  return all;
}

namespace {

constexpr int kFigureNotMet = 5;

int run(int argc, char** argv) {
  JudgementOptions options;
  CLI::App app("Judgement: real, potential, fake against exact truth; run time against error");
  std::vector<std::string> names;
  for (const JudgementSection& section : judgement_sections()) names.push_back(section.name);
  app.add_option("--json", options.json_file, "write all tables and bars to this file");
  app.add_option("--plot", options.plot_file, "draw time against error to this SVG file");
  app.add_option("--only", options.only, "these sections only")->check(CLI::IsMember(names));
  app.add_option("--cases", options.cases, "random cases of the section truth");
  app.add_option("--case", options.one_case, "FAMILY:SEED as the run named it: only this, in full");
  app.add_flag("--quick", options.quick, "fewer cases, about a minute; rougher figures");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (!options.one_case.empty()) {
    if (tell_case(options.one_case)) return 0;
    std::fprintf(stderr,
                 "--case %s: no such case; a family (cylinder, cone, ball, key, blocks), a "
                 "colon, a seed\n",
                 options.one_case.c_str());
    return 2;
  }
  Report report;
  for (const JudgementSection& section : judgement_sections())
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
