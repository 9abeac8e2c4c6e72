// What the network costs: large scenes for many at once, and a bad link.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/hash.h"
#include "tests/bench/awake.h"
#include "tests/bench/session_load.h"
#include "tests/bench/session_sections.h"
#include "tests/network/guest.h"
#include "tests/network/large_scene.h"
#include "tests/network/lossy_session.h"
#include "tests/support/shapes.h"
#include "tests/support/stl_file.h"

namespace mortise::bench {
namespace {

constexpr double kSceneBar_s = 1.5, kLatenessBar = 3.0;
constexpr double kTick_ms = 1e3 / 60.0;

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

namespace {

struct AddedParts {
  double megabytes = 0.0, known_s = 0.0, clashes = 0.0;
  Json closing;
};

// Two balls of a million triangles are uploaded, added and pushed 6 mm into each other, between
// them what both look like is read once.
Result<AddedParts> add_large_parts(BenchServer& server) {
  constexpr int kRows = 500, kBeats = 180;
  constexpr double kRadius_mm = 50.0, kGap_mm = 2.0, kWay_mm = 8.0, kPatience_s = 60.0;
  const std::vector<std::byte> file =
      test::stl_file(shapes::sphere(kRadius_mm, Vec3::Zero(), kRows));
  AddedParts added;
  added.megabytes = static_cast<double>(file.size()) * 1e-6;
  DdsOptions where;
  where.domain = server.domain();
  test::Guest guest(where, "anna");
  if (!guest.client || !guest.joined()) return Error{Code::kRuntime, "anna did not get in"};
  const double start_s = steady_s();
  Client& client = *guest.client;
  client.upload(guest.user, "ball.stl", 1.0, file);
  const Vec3 place_mm(0, 0, 1000.0);
  for (const bool moving : {false, true})
    client.add_part(
        guest.user, moving ? "ball" : "base", content_hash(file),
        Pose::translation(place_mm + Vec3(moving ? 2.0 * kRadius_mm + kGap_mm : 0.0, 0, 0)),
        moving);
  const auto is_known = [&](const char* part) {
    const PartId id = client.find_part(part);
    return id && client.parts().at(id).info.radius_mm > 0.5 * kRadius_mm;
  };
  if (!guest.until(kPatience_s, [&] { return is_known("base") && is_known("ball"); }))
    return Error{Code::kRuntime,
                 "the parts were not added: " +
                     (guest.replies.empty() ? server.errors() : guest.replies.back().text)};
  added.known_s = steady_s() - start_s;
  if (!guest.grab("ball")) return Error{Code::kRuntime, "the ball was not given"};
  for (int i = 0; i < kBeats; ++i) {
    client.send(guest.user, client.find_part("ball"), {-kWay_mm / kBeats, 0, 0});
    const double next_s = steady_s() + 1.0 / 60.0;
    while (steady_s() < next_s) {
      guest.listen();
      sleep_s(1e-3);
    }
  }
  (void)guest.until(1.0, [] { return false; });
  added.clashes = static_cast<double>(client.open_clashes().size());
  guest.client.reset();
  added.closing = server.close();
  if (!added.closing.is_object())
    return Error{Code::kRuntime, "the server did not end well: " + server.errors()};
  return added;
}

}  // namespace

void section_added(Report& report, const SessionOptions& options) {
  report.table("Two parts of a million triangles each are added, and pushed into each other",
               {"MB", "until both are known s", "clashes told", "tick p50 us", "tick p99 us",
                "longest tick ms", "deadlines missed", "load average"});
  double longest_ms = 0.0;
  bool whole = true;
  const Awake awake;
  for (int run = 0; run < (options.quick ? 1 : 3); ++run) {
    BenchServer server("stress.yaml");
    const auto added = add_large_parts(server);
    if (!added) report.note("a run did not do: " + added.error().text);
    whole = whole && added && added->clashes == 1.0;
    if (!added) continue;
    const Json& tick = added->closing["times_us"]["tick"];
    longest_ms = std::max(longest_ms, 1e-3 * tick["max"].get<double>());
    report.row({added->megabytes, added->known_s, static_cast<long long>(added->clashes),
                tick["p50"].get<double>(), tick["p99"].get<double>(),
                1e-3 * tick["max"].get<double>(),
                added->closing["missed_deadlines"].get<long long>(),
                fmt::format("{:.1f}", load_average())});
  }
  report.bar("a part of 50 MB is added and first judged: longest tick of all runs, ms",
             or_nan(whole, longest_ms), kTick_ms, BoundKind::kAtMost);
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
