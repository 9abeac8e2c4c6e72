// Keeps the report of a benchmark, and makes FIGURES.md and the README's table of what is kept.
// usage: bench_figures keep SOURCES BENCHMARK COMMAND REPORT.json | bench_figures write SOURCES
#include <cstdio>
#include <fstream>
#include <sstream>

#include "tests/bench/figures.h"

int main(int argc, char** argv) {
  using namespace mortise::bench;
  const std::vector<std::string> words(argv + 1, argv + argc);
  const bool keep = words.size() == 5 && words[0] == "keep";
  if (!keep && !(words.size() == 2 && words[0] == "write")) {
    std::fprintf(stderr,
                 "bench_figures keep SOURCES BENCHMARK COMMAND REPORT.json | write SOURCES\n");
    return 2;
  }
  const std::filesystem::path sources = words[1], folder = sources / "tests/bench/figures";
  if (keep) {
    std::ifstream in(words[4]);
    const KeptRun run = kept_run(words[2], words[3], nlohmann::ordered_json::parse(in));
    std::filesystem::create_directories(folder);
    std::ofstream(folder / (words[2] + ".json")) << text_of(run);
    return 0;
  }
  const std::vector<KeptRun> runs = runs_in(folder);
  std::ofstream(sources / "tests/bench/FIGURES.md") << figures_page(runs);
  std::stringstream readme;
  readme << std::ifstream(sources / "README.md").rdbuf();
  std::ofstream(sources / "README.md") << with_figures(readme.str(), runs);
  return 0;
}
