// Bots that put shafts into bores with a trembling hand, by the real server.
#include <fmt/format.h>

#include "tests/bench/session_load.h"
#include "tests/bench/session_sections.h"

namespace mortise::bench {
namespace {

constexpr int kShafts = 4;

/// Shafts of 10 um less radius than their bores, 64 facets, each beside its own.
std::string bench_of(const std::string& policy) {
  std::string yaml = "name: guided\nunits: mm\npolicy: " + policy +
                     "\nmax_jump: 20\nparts:\n  - name: plate\n    generator: {kind: "
                     "plate_with_bore, bore: 20, facets: 64}\n    instances:\n";
  for (int i = 0; i < kShafts; ++i)
    yaml += fmt::format("      - {{name: plate_{}, pose: {{position: [{}, 0, 0]}}}}\n", i, 90 * i);
  yaml +=
      "  - name: shaft\n    generator: {kind: dowel, diameter: 19.98, length: 40, chamfer: 1, "
      "facets: 64}\n    moving: true\n    instances:\n";
  for (int i = 0; i < kShafts; ++i)
    yaml += fmt::format("      - {{name: shaft_{}, pose: {{position: [{}, 12, 45]}}}}\n", i,
                        90 * i + 8);
  return yaml;
}

struct Tried {
  long long tries = 0, inserted = 0, not_aligned = 0, stuck = 0;
  double median_s = 0.0;
};

Tried try_to_insert(const std::string& policy, bool free_hand, int tries) {
  test::TestFolder folder;
  BenchServer server(folder.write("guided.yaml", bench_of(policy)));
  std::vector<std::string> arguments = {
      "--behaviour", "guided", "--users", std::to_string(kShafts),
      "--rate",      "60",     "--tries", std::to_string(tries / kShafts),
      "--seed",      "7"};
  if (free_hand) arguments.push_back("--free-hand");
  auto bots = server.bots(arguments);
  bots->wait(60.0 + 8.0 * tries);
  const Json report = Json::parse(bots->out(), nullptr, false);
  server.close();
  if (!report.is_object() || !report.contains("insertions")) return {};
  const Json& i = report["insertions"];
  return {i["tries"].get<long long>(), i["inserted"].get<long long>(),
          i["not_aligned"].get<long long>(), i["stuck"].get<long long>(),
          i["seconds"]["p50"].get<double>()};
}

}  // namespace

void section_guided(Report& report, const SessionOptions& options) {
  report.table(
      "Shafts of 10 um less radius than their bores; the hand trembles by 0.2 mm and 0.5 degrees "
      "in "
      "every increment",
      {"policy", "hand", "tries", "inserted", "not aligned", "stuck", "median s", "load average"});
  const int all = options.quick ? 20 : 100;
  const auto row = [&](const char* policy, bool free_hand, int tries) {
    const Tried t = try_to_insert(policy, free_hand, tries);
    report.row({std::string(policy), std::string(free_hand ? "free" : "snapped coaxial"), t.tries,
                t.inserted, t.not_aligned, t.stuck, t.median_s,
                fmt::format("{:.1f}", load_average())});
    return t;
  };
  const Tried snapped = row("stop", false, all);
  row("slide", false, options.quick ? 8 : 20);
  row("slide", true, options.quick ? 8 : 20);
  row("stop", true, options.quick ? 8 : 20);
  report.bar(fmt::format("shafts inserted of {} under a coaxial constraint, policy stop", all),
             snapped.tries == all ? static_cast<double>(snapped.inserted) : std::nan(""),
             static_cast<double>(all), BoundKind::kAtLeast);
}

}  // namespace mortise::bench
