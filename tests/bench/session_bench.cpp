// The session under load: latency, ticks, memory, late joiners, stopped readers. See README.md.
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
      {"presence", "who is killed without a goodbye", section_presence},
      {"restart", "a server that is killed and started again", section_restart},
      {"scene", "50 MB of meshes for eight at once", section_scene},
      {"added", "parts of 50 MB that are added and pushed", section_added},
      {"lossy", "a link that loses, delays, doubles and reorders", section_lossy},
      {"security", "what it costs to be met with keys", section_security},
      {"guided", "shafts put into bores by hands that tremble", section_guided},
      {"pushed", "pegs in their holes that are all pushed at once", section_pushed},
      {"plays", "the demo, played again and again, also beside busy loops", section_plays},
  };
  return all;
}

namespace {

int run(int argc, char** argv) {
  SessionOptions options;
  CLI::App app("The session under load: server and bots as programs on loopback");
  add_bench_options(app, options, session_sections());
  app.add_flag("--soak", options.soak, "the load for ten minutes each, after eight to get warm")
      ->excludes("--quick");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return run_sections(options, session_sections());
}

}  // namespace
}  // namespace mortise::bench

int main(int argc, char** argv) { return mortise::bench::run(argc, argv); }
