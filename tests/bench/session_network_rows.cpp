// What the network costs: large scenes for many at once, and a bad link.
#include <fmt/format.h>

#include "tests/bench/session_load.h"
#include "tests/bench/session_sections.h"
#include "tests/network/large_scene.h"
#include "tests/network/lossy_session.h"

namespace mortise::bench {
namespace {

constexpr double kSceneBar_s = 1.5, kLatenessBar = 3.0;

double or_nan(bool there, double figure) { return there ? figure : std::nan(""); }

}  // namespace

void section_scene(Report& report, const SessionOptions& options) {
  constexpr int kMeshes = 10, kJoiners = 8;
  report.table(
      "Ten meshes of 5 MB for eight participants that come at once, ticks of 60 Hz beside",
      {"MB", "got all", "slowest s", "lateness p99 ms", "undisturbed p99 ms", "load average"});
  double slowest_s = 0.0, ratio = 0.0;
  bool whole = true;
  for (int run = 0; run < (options.quick ? 1 : 3); ++run) {
    DdsOptions where;
    where.domain = 60 + run;
    const auto served = test::serve_scene(where, kMeshes, kJoiners);
    if (!served) {
      report.note(served.error().text);
      whole = false;
      continue;
    }
    whole = whole && served->whole == kJoiners;
    slowest_s = std::max(slowest_s, served->slowest_s);
    ratio = std::max(ratio, served->lateness_p99_ms / served->undisturbed_p99_ms);
    report.row({static_cast<double>(served->bytes) * 1e-6, static_cast<long long>(served->whole),
                served->slowest_s, served->lateness_p99_ms, served->undisturbed_p99_ms,
                fmt::format("{:.1f}", load_average())});
  }
  report.bar("50 MB for eight at once, slowest of all runs, s", or_nan(whole, slowest_s),
             kSceneBar_s, BoundKind::kAtMost);
  report.bar("tick lateness p99 meanwhile / undisturbed, worst run", or_nan(whole, ratio),
             kLatenessBar, BoundKind::kAtMost);
}

void section_lossy(Report& report, const SessionOptions& options) {
  report.table(
      "Two designers across a bad link between two network namespaces, 60 Hz: increment to applied",
      {"loss %", "delay ms", "doubled %", "jitter ms", "sent", "lost", "p50 ms", "p99 ms",
       "target ms", "deadlines missed %", "load average"});
  const struct {
    test::LinkSettings link;
    bool is_bar;
  } rows[] = {
      {{.loss = 0.01, .delay_s = 0.02}, true},
      {{.loss = 0.05, .delay_s = 0.02, .seed = 2}, true},
      {{.loss = 0.10, .delay_s = 0.02, .seed = 3}, false},
      {{.loss = 0.01, .delay_s = 0.1, .seed = 6}, false},
      {{.loss = 0.05, .delay_s = 0.1, .seed = 4}, true},
      {{.loss = 0.10, .delay_s = 0.1, .seed = 7}, false},
      {{.loss = 0.02, .duplicate = 0.2, .delay_s = 0.02, .jitter_s = 0.03, .seed = 5}, false},
  };
  for (const auto& [link, is_bar] : rows) {
    const auto played = test::play_across(link, options.quick ? 4.0 : 15.0);
    const bool right = played && played->agreed && played->inbox.lost + played->given_up == 0;
    if (!played) {
      report.note("no lossy link: " + played.error().text);
    } else {
      report.row({100.0 * link.loss, 1e3 * link.delay_s, 100.0 * link.duplicate,
                  1e3 * link.jitter_s, static_cast<long long>(played->sent),
                  static_cast<long long>(played->inbox.lost + played->given_up),
                  played->percentile_ms(0.5), played->percentile_ms(0.99), 1e3 * played->target_s,
                  100.0 * played->missed, fmt::format("{:.1f}", load_average())});
    }
    if (!is_bar) continue;
    report.bar(fmt::format("{:g} % loss, {:g} ms: applied p99 / (two ways and a tick)",
                           100.0 * link.loss, 1e3 * link.delay_s),
               or_nan(right, right ? 1e-3 * played->percentile_ms(0.99) / played->target_s : 0.0),
               1.0, BoundKind::kAtMost);
  }
}

}  // namespace mortise::bench
