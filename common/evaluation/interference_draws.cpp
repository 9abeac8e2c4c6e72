#include "common/evaluation/interference_draws.h"

#include <algorithm>
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
  const double lo_mm = zones.certain_mm.lo;
  const double hi_mm = std::max(zones.possible_mm.lo, lo_mm);
  // Overlap of the meshes with the least mesh error; what is left to hi is doubt about the mesh.
  const double meshes_mm = lo_mm - zones.tolerance_a_mm.lo - zones.tolerance_b_mm.lo;
  const double doubt_mm =
      std::max(0.0, hi_mm - meshes_mm - zones.tolerance_a_mm.hi - zones.tolerance_b_mm.hi);
  ZoneDraw offset_a(zones.tolerance_a_mm), offset_b(zones.tolerance_b_mm);
  ZoneDraw doubt({0.0, doubt_mm});
  std::mt19937_64 random(seed);
  InterferenceEstimate estimate{draws, 0};
  for (std::uint64_t i = 0; i < draws; ++i)
    if (meshes_mm + offset_a(random) + offset_b(random) + doubt(random) > 0.0)
      ++estimate.interfering;
  return estimate;
}

}  // namespace mortise
