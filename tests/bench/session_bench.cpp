// The session under load: latency, ticks, memory, late joiners, stopped readers. See README.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "tests/bench/session_sections.h"

namespace mortise::bench {

const std::vector<SessionSection>& session_sections() {
  static const std::vector<SessionSection> all = {
      {"users", "64 users at 60 Hz in one process, on the demo scene", section_users},
      {"processes", "16, 32 and 64 client processes at 120 Hz", section_processes},
      {"tick", "a large scene, tick by tick, in this process", section_tick},
      {"idle", "a session in which nothing happens", section_idle},
      {"reader", "ticks beside a reader that was stopped", section_reader},
      {"join", "who comes late", section_join},
  };
  return all;
}

namespace {

constexpr int kFigureNotMet = 5;

int run(int argc, char** argv) {
  SessionOptions options;
  CLI::App app("The session under load: server and bots as programs on loopback");
  std::vector<std::string> names;
  std::string sections = "Sections:";
  for (const SessionSection& section : session_sections()) {
    names.push_back(section.name);
    sections += std::string("\n  ") + section.name + ": " + section.asks;
  }
  app.footer(sections);
  app.add_option("--json", options.json_file, "write all tables and bars to this file");
  app.add_option("--only", options.only, "these sections only")->check(CLI::IsMember(names));
  auto* quick = app.add_flag("--quick", options.quick, "shorter runs, rougher figures");
  app.add_flag("--soak", options.soak, "the load for ten minutes each")->excludes(quick);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  Report report;
  for (const SessionSection& section : session_sections())
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
