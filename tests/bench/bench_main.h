#pragma once
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "tests/bench/report.h"

namespace mortise::bench {

/// What every benchmark is asked for.
struct BenchOptions {
  std::string json_file;          ///< empty: not written
  std::vector<std::string> only;  ///< names of sections; empty: all
  bool quick = false;             ///< shorter; the figures are rougher
};

/// Adds its tables, notes and bars to the report.
template <class Options>
struct BenchSection {
  const char* name;
  const char* asks;  ///< one line for --help
  void (*run)(Report&, const Options&);
};

/// The flags of BenchOptions, and the sections in the help.
template <class Options>
void add_bench_options(CLI::App& app, Options& options,
                       const std::vector<BenchSection<Options>>& sections) {
  std::vector<std::string> names;
  std::string footer = "Sections:";
  for (const auto& section : sections) {
    names.push_back(section.name);
    footer += std::string("\n  ") + section.name + ": " + section.asks;
  }
  app.footer(footer);
  app.add_option("--json", options.json_file, "write all tables and bars to this file");
  app.add_option("--only", options.only, "these sections only")->check(CLI::IsMember(names));
  app.add_flag("--quick", options.quick, "a smaller run of a minute or so; rougher figures");
}

/// Runs the sections that are asked for, prints the bars, writes the document. Returns the exit
/// code: 0, 1 file not written, 5 a bar does not hold.
template <class Options>
int run_sections(const Options& options, const std::vector<BenchSection<Options>>& sections) {
  constexpr int kFigureNotMet = 5;
  Report report;
  for (const auto& section : sections)
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

/// A benchmark that is asked for no more than that: reads its command line and runs it.
template <class Options>
int run_bench(int argc, char** argv, const char* title,
              const std::vector<BenchSection<Options>>& sections) {
  Options options;
  CLI::App app(title);
  add_bench_options(app, options, sections);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return run_sections(options, sections);
}

}  // namespace mortise::bench
