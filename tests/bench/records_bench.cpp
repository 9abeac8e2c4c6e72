// Session logs: what recording costs and takes, what computing again and exporting takes, and what
// is left of a log after a crash or damage. See README.md.
#include "tests/bench/records_sections.h"

#include <unistd.h>

namespace mortise::bench {

const test::PlayedSession* demo_session() {
  static const auto session =
      test::play_session(std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios/gearbox.yaml",
                         std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios/gearbox.play.yaml");
  if (!session) std::fprintf(stderr, "%s\n", session.error().text.c_str());
  return session ? &*session : nullptr;
}

ScratchFile::ScratchFile(const std::string& name)
    : path_(std::filesystem::temp_directory_path() /
            ("mortise_bench_" + std::to_string(getpid()) + "_" + name)) {
  std::filesystem::remove(path_);
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

namespace {

int run(int argc, char** argv) {
  const std::vector<BenchSection<RecordsOptions>> sections = {
      {"size", "bytes per increment and per moved part", section_size},
      {"cost", "what recording costs a tick, on a slow disk", section_cost},
      {"checkpoint", "what a checkpoint of a large scene costs its ticks", section_checkpoint},
      {"verify", "computing the demo again, against its own time", section_verify},
      {"hour", "one hour of eight users to a page and a database", section_hour},
      {"killed", "logs whose writer was killed", section_killed},
      {"damaged", "logs that were cut short, and logs with a turned bit", section_damaged},
  };
  return run_bench(argc, argv, "Session logs: size, cost, verification, export, crashes", sections);
}

}  // namespace
}  // namespace mortise::bench

int main(int argc, char** argv) { return mortise::bench::run(argc, argv); }
