#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/base/result.h"
#include "idl/dds_channel.h"
#include "tests/network/small_server.h"

namespace mortise::test {

/// By nearest rank below; 0 when there is none.
inline double percentile(std::vector<double> values, double p) {
  std::sort(values.begin(), values.end());
  return values.empty()
             ? 0.0
             : values[static_cast<std::size_t>(p * static_cast<double>(values.size() - 1))];
}

/// Turns at a rate with absolute deadlines, and how late each began.
struct Beat {
  std::vector<double> lateness_s;
  std::uint64_t held = 0, due = 0;  ///< begun before the next was due

  void run(double seconds, double rate_hz, const std::function<void()>& turn) {
    const double start_s = now_s(), period_s = 1.0 / rate_hz;
    due = static_cast<std::uint64_t>(seconds * rate_hz);
    for (std::uint64_t i = 0; i < due; ++i) {
      const double at_s = start_s + static_cast<double>(i) * period_s;
      sleep_s(std::max(0.0, at_s - now_s()));
      lateness_s.push_back(now_s() - at_s);
      held += lateness_s.back() < period_s;
      turn();
    }
  }
};

/// A scene of so many meshes of 5 MB for participants that come all at once, each in a thread.
struct SceneServed {
  std::size_t bytes = 0;
  int whole = 0;           ///< participants that got all of it
  double slowest_s = 0.0;  ///< from opening a channel until scene and meshes are there
  double undisturbed_p99_ms = 0.0, lateness_p99_ms = 0.0;  ///< of 60 Hz ticks before and meanwhile
};
Result<SceneServed> serve_scene(const DdsOptions& options, int meshes, int joiners);

}  // namespace mortise::test
