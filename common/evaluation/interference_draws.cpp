#include "common/evaluation/interference_draws.h"

#include <cmath>
#include <random>

#include "common/base/check.h"

namespace mortise {
namespace {

// A zone without width always gives its one value: normal_distribution refuses sigma 0.
class ZoneDraw {
 public:
  explicit ZoneDraw(Interval zone_mm)
      : middle_mm_(zone_mm.middle()), sigma_mm_(zone_mm.width() / 6.0) {}
  double operator()(std::mt19937_64& random) { return middle_mm_ + sigma_mm_ * unit_(random); }

 private:
  double middle_mm_, sigma_mm_;
  std::normal_distribution<double> unit_{0.0, 1.0};
};

}  // namespace

double InterferenceEstimate::sampling_error(double p) const {
  return std::sqrt(p * (1.0 - p) / static_cast<double>(draws));
}

InterferenceEstimate draw_interference(const InterferenceZones& zones, std::uint64_t seed,
                                       std::uint64_t draws) {
  MORTISE_CHECK(draws > 0, "an estimate needs draws");
  const double modelled_mm = modelled_overlap_mm(zones).middle();
  const ParallelAxes axes = zones.axes.value_or(ParallelAxes{});
  ZoneDraw size_a(zones.size_a_mm), size_b(zones.size_b_mm);
  ZoneDraw place_a({-0.5 * zones.position_a_mm, 0.5 * zones.position_a_mm});
  ZoneDraw place_b({-0.5 * zones.position_b_mm, 0.5 * zones.position_b_mm});
  std::mt19937_64 random(seed);
  InterferenceEstimate estimate{draws, 0};
  for (std::uint64_t i = 0; i < draws; ++i) {
    const double x = axes.apart_mm + place_a(random) - place_b(random);
    const double y = place_a(random) - place_b(random);
    const double farther_mm = std::sqrt(x * x + y * y) - axes.apart_mm;
    const double sizes_mm = size_a(random) + size_b(random);
    if (modelled_mm + sizes_mm + (axes.nested ? farther_mm : -farther_mm) > 0.0)
      ++estimate.interfering;
  }
  return estimate;
}

}  // namespace mortise
