// What covers save, as ratios of one run: the demo's fits at fixed poses and over motions, with
// covers and without them; and parts that lie in one place.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

#include "common/base/check.h"
#include "common/depth/depth.h"
#include "common/io/scenario/scenario_file.h"
#include "common/io/scenario/scene_load.h"
#include "common/io/scenario/scene_meshes.h"
#include "common/math/rotation.h"
#include "tests/bench/judgement_methods.h"
#include "tests/bench/judgement_sections.h"
#include "tests/bench/scenes.h"
#include "tests/bench/statistics.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

constexpr double kLookBar = 20.0, kSearchBar = 40.0;
// Numbers are equal when they differ by no more than this, mm.
constexpr double kEqual_mm = 1e-5;

/// A round face of one part in that of another one, as the scene fits them.
struct Fit {
  std::string name;
  const Solid *a = nullptr, *b = nullptr;
  std::shared_ptr<const SurfaceBand> band_a, band_b;
  Pose X_BA;              ///< coaxial, the middles of both faces in one place
  Vec3 axis_B, middle_A;  ///< of the faces
  Interval of_a, of_b;    ///< extents of the faces along the axis
};

Interval extent_of(const Solid& solid, const SurfaceBand& band, std::size_t face) {
  const Surface& s = *band.faces[face].surface;
  Interval extent{1e9, -1e9};
  for (std::uint32_t t = 0; t < solid.mesh().triangles.size(); ++t)
    if (&band.face_of(t) == &band.faces[face])
      for (int k = 0; k < 3; ++k) {
        const double z = (solid.mesh().corner(t, k) - s.point).dot(s.axis);
        extent = hull(extent, {z, z});
      }
  return extent;
}

// The first two round faces of one size, one around the other.
bool find_faces(Fit& fit) {
  for (std::size_t i = 0; i < fit.band_a->faces.size(); ++i)
    for (std::size_t j = 0; j < fit.band_b->faces.size(); ++j) {
      const auto &a = fit.band_a->faces[i].surface, &b = fit.band_b->faces[j].surface;
      if (!a || !b || a->kind != SurfaceKind::kCylinder || b->kind != SurfaceKind::kCylinder ||
          a->inward == b->inward || std::fabs(a->radius_mm - b->radius_mm) > 0.05)
        continue;
      fit.of_a = extent_of(*fit.a, *fit.band_a, i);
      fit.of_b = extent_of(*fit.b, *fit.band_b, j);
      fit.axis_B = b->axis;
      fit.X_BA.q = Quat::FromTwoVectors(a->axis, b->axis);
      fit.middle_A = a->point + fit.of_a.middle() * a->axis;
      fit.X_BA.p = b->point + fit.of_b.middle() * b->axis - fit.X_BA.q * fit.middle_A;
      return true;
    }
  return false;
}

OverlapQuery put_together(const Fit& fit, const Pose& X_BA) {
  OverlapQuery query;
  query.a = fit.a;
  query.b = fit.b;
  query.band_a = fit.band_a.get();
  query.band_b = fit.band_b.get();
  query.X_WA = X_BA;
  query.work_cap = 20'000;
  query.want_delta = false;
  query.use_covers = false;
  return query;
}

// Along the axis to where nothing else is in the way: the face need not be in the other one whole.
void pull_out(Fit& fit) {
  const double most_mm = 0.5 * (fit.of_a.width() + fit.of_b.width());
  double least_mm = 1e9;
  Pose best = fit.X_BA;
  for (const double share : {0.0, 0.3, -0.3, 0.5, -0.5, 0.7, -0.7}) {
    Pose X_BA = fit.X_BA;
    X_BA.p += share * most_mm * fit.axis_B;
    CcdScratch scratch;
    double deep_mm = 0.0;
    for (const OverlapRegion& region : find_overlap(put_together(fit, X_BA), scratch).regions)
      deep_mm = std::max(deep_mm, region.possible_mm.lo);
    if (deep_mm >= least_mm - kEqual_mm) continue;
    least_mm = deep_mm;
    best = X_BA;
  }
  fit.X_BA = best;
}

std::vector<Fit> demo_fits(World& world) {
  const auto reading = read_scenario(MORTISE_SOURCE_DIR "/scenarios/gearbox.yaml");
  MORTISE_CHECK(reading && reading->usable(), "the demo is a scenario");
  auto scene = load_scene(reading->scenario, default_meshes());
  MORTISE_CHECK(scene && scene->usable(), "the demo is a scene");
  world = scene->world;
  std::vector<Fit> fits;
  std::set<std::tuple<const Solid*, const Solid*, std::string>> known;
  for (const auto& [parts, rule] : world.pair_rules) {
    const Part &a = *world.find(rule.a), &b = *world.find(rule.b);
    if (rule.fit.empty() || !known.insert({a.solid.get(), b.solid.get(), rule.fit}).second)
      continue;
    Fit fit;
    fit.name = a.name + " and " + b.name + ", " + rule.fit;
    fit.a = a.solid.get();
    fit.b = b.solid.get();
    fit.band_a = rule.band_a ? rule.band_a : std::make_shared<const SurfaceBand>(a.band);
    fit.band_b = rule.band_b ? rule.band_b : std::make_shared<const SurfaceBand>(b.band);
    if (!find_faces(fit)) continue;
    pull_out(fit);
    fits.push_back(std::move(fit));
  }
  return fits;
}

// Put together, but for some hundredths of a millimetre and thousandths of a radian; anywhere.
OverlapQuery pose_of(const Fit& fit, Dice& dice) {
  OverlapQuery query = put_together(fit, Pose());
  const double off_mm = dice.between(0.0, 1.0) < 0.3 ? 0.0 : dice.spread(1e-4, 0.03);
  const double tilt = dice.between(0.0, 1.0) < 0.5 ? 0.0 : dice.spread(1e-6, 1e-3);
  const Vec3 aside = off_mm * dice.direction() + dice.between(-0.5, 0.5) * fit.axis_B;
  const Quat turn =
      rotation_exp(tilt * dice.direction()) * rotation_exp(dice.between(-3.0, 3.0) * fit.axis_B);
  const Vec3 middle_B = fit.X_BA * fit.middle_A;
  Pose X_BA{(turn * fit.X_BA.q).normalized(), Vec3::Zero()};
  X_BA.p = middle_B + aside - X_BA.q * fit.middle_A;
  query.X_WB = {dice.orientation(), 100.0 * dice.direction()};
  query.X_WA = query.X_WB * X_BA;
  return query;
}

struct Worst {
  Interval certain_mm{-1e9, 0.0}, possible_mm{-1e9, 0.0};
  bool real = false, capped = false;
  CollisionClass word() const {
    return real                   ? CollisionClass::kReal
           : possible_mm.hi > 0.0 ? CollisionClass::kPotential
                                  : CollisionClass::kNone;
  }
};

Worst worst_of(const OverlapResult& result) {
  Worst worst;
  for (const OverlapRegion& region : result.regions) {
    worst.certain_mm = {std::max(worst.certain_mm.lo, region.certain_mm.lo),
                        std::max(worst.certain_mm.hi, region.certain_mm.hi)};
    worst.possible_mm = {std::max(worst.possible_mm.lo, region.possible_mm.lo),
                         std::max(worst.possible_mm.hi, region.possible_mm.hi)};
    worst.real |= region.certain_mm.lo > 0.0 && region.has_witness;
    worst.capped |= region.capped;
  }
  return worst;
}

/// One way of asking, with covers and without.
struct Tally {
  double with_s = 0.0, without_s = 0.0;
  std::vector<double> with_each_s, ratio;
  long long looks = 0, real = 0, potential = 0, none = 0;
  long long opposite = 0, outside = 0, tighter = 0, wider = 0, less = 0;

  void add(const Worst& with, const Worst& without, double with_time_s, double without_time_s) {
    ++looks;
    with_s += with_time_s;
    without_s += without_time_s;
    with_each_s.push_back(with_time_s);
    ratio.push_back(without_time_s / with_time_s);
    const CollisionClass word = with.word(), other = without.word();
    (word == CollisionClass::kReal        ? real
     : word == CollisionClass::kPotential ? potential
                                          : none)++;
    opposite += (word == CollisionClass::kReal && other == CollisionClass::kNone) ||
                (word == CollisionClass::kNone && other == CollisionClass::kReal);
    less += word == CollisionClass::kPotential && other != CollisionClass::kPotential;
    const auto compare = [&](const Interval& x, const Interval& y) {
      const double y_hi = std::max(0.0, y.hi), x_hi = std::max(0.0, x.hi);
      outside += x.lo > y_hi + kEqual_mm;
      // The search knows a face up to where its mesh ends, not where a moved neighbour cuts it.
      tighter += x_hi < y.lo - kEqual_mm;
      wider += x_hi > y_hi + kEqual_mm || std::max(0.0, x.lo) < std::max(0.0, y.lo) - kEqual_mm;
    };
    compare(with.certain_mm, without.certain_mm);
    compare(with.possible_mm, without.possible_mm);
  }
  void row(Report& report, const std::string& name) const {
    report.row({name, looks, real, potential, none, 1e6 * median(with_each_s),
                1e6 * quantile(with_each_s, 0.99), 1e6 * with_s / double(looks),
                1e6 * without_s / double(looks), without_s / with_s, median(ratio), opposite,
                outside, tighter, less, wider});
  }
};

const std::vector<std::string> kColumns = {"fit",       "asked",        "real",
                                           "potential", "none",         "us median",
                                           "us p99",    "us mean",      "us mean, no covers",
                                           "ratio",     "ratio median", "opposite",
                                           "outside",   "tighter",      "less decided",
                                           "wider"};

template <class Ask>
void look_rows(Report& report, const std::vector<Fit>& fits, const std::string& title, int count,
               const std::string& bar, Ask&& ask) {
  report.table(title, kColumns);
  Tally total;
  for (const Fit& fit : fits) {
    Dice dice(71);
    Tally tally;
    for (int i = 0; i < count; ++i) {
      OverlapQuery query = pose_of(fit, dice);
      query.prove_not_certain = true;
      double time_s[2];
      Worst worst[2];
      for (const int covers : {0, 1}) {
        query.use_covers = covers == 1;
        worst[covers] = worst_of(ask(query));
        time_s[covers] = least_time_s([&] { ask(query); }, 3);
      }
      for (Tally* t : {&tally, &total}) t->add(worst[1], worst[0], time_s[1], time_s[0]);
    }
    tally.row(report, fit.name);
  }
  total.row(report, "all");
  report.bar(bar + ": times faster with covers", total.without_s / total.with_s, kLookBar,
             BoundKind::kAtLeast);
  report.bar(bar + ": words or numbers that contradict those without covers",
             static_cast<double>(total.opposite + total.outside), 0.0, BoundKind::kAtMost);
}

OverlapResult full(OverlapQuery query) {
  CcdScratch scratch;
  query.refinement = Refinement::kFull;
  return find_overlap(query, scratch);
}
OverlapResult lazily(const OverlapQuery& query) {
  CcdScratch scratch;
  return find_overlap(query, scratch);
}

// Ticks as hands make them: along the axis, aside, and both with a turn.
SweptQuery sweep_of(const Fit& fit, Dice& dice) {
  SweptQuery swept;
  swept.at_target = pose_of(fit, dice);
  swept.at_target.work_cap = 10'000;
  swept.motion_b = still_motion(swept.at_target.X_WB);
  const Pose& X_W0 = swept.at_target.X_WA;
  const Vec3 axis_W = swept.at_target.X_WB.q * fit.axis_B;
  const double along = dice.between(0.0, 1.0) < 0.7 ? dice.between(-2.0, 2.0) : 0.0;
  const double aside = dice.between(0.0, 1.0) < 0.5 ? 0.0 : dice.spread(1e-3, 0.1);
  const double turn = dice.between(0.0, 1.0) < 0.7 ? 0.0 : dice.spread(1e-4, 0.05);
  Pose X_W1 = X_W0;
  const Quat by = rotation_exp(turn * dice.direction());
  const Vec3 middle_W = X_W0 * fit.middle_A;
  X_W1.q = (by * X_W0.q).normalized();
  X_W1.p = middle_W + along * axis_W + aside * dice.direction() - X_W1.q * fit.middle_A;
  swept.motion_a = linear_motion(X_W0, X_W1, fit.middle_A);
  return swept;
}

void search_rows(Report& report, const std::vector<Fit>& fits, int count) {
  report.table("Times in a tick, of the demo's fits, with covers and without",
               {"fit", "asked", "free", "evaluations", "evaluations, no covers", "ms",
                "ms, no covers", "ratio", "at the cap", "at the cap, no covers"});
  double time_s[2] = {0.0, 0.0};
  long long capped = 0;
  for (const Fit& fit : fits) {
    Dice dice(72);
    double of_fit_s[2] = {0.0, 0.0};
    long long evaluations[2] = {0, 0}, at_cap[2] = {0, 0}, free = 0;
    for (int i = 0; i < count; ++i) {
      SweptQuery swept = sweep_of(fit, dice);
      for (const int covers : {0, 1}) {
        swept.at_target.use_covers = covers == 1;
        CcdScratch scratch;
        const Stopwatch watch;
        const PossibleTime possible = find_possible_time(swept, scratch);
        const InterferenceTime real = find_interference_time(swept, scratch);
        of_fit_s[covers] += watch.elapsed_s();
        evaluations[covers] += static_cast<long long>(possible.evaluations + real.evaluations);
        at_cap[covers] += possible.capped + real.capped;
        free += covers == 1 && !real.becomes_real;
      }
    }
    report.row({fit.name, static_cast<long long>(count), free, evaluations[1], evaluations[0],
                1e3 * of_fit_s[1], 1e3 * of_fit_s[0], of_fit_s[0] / of_fit_s[1], at_cap[1],
                at_cap[0]});
    for (const int covers : {0, 1}) time_s[covers] += of_fit_s[covers];
    capped += at_cap[1];
  }
  report.bar("times of the demo's fits: times less with covers", time_s[0] / time_s[1], kSearchBar,
             BoundKind::kAtLeast);
  report.bar("times of the demo's fits: searches at the cap", static_cast<double>(capped), 0.0,
             BoundKind::kAtMost);
}

}  // namespace

void section_covers(Report& report, const JudgementOptions& options) {
  World world;
  const std::vector<Fit> fits = demo_fits(world);
  const int count = options.cases > 0 ? static_cast<int>(options.cases) : options.quick ? 10 : 100;
  look_rows(report, fits, "Certain and possible at fixed poses, decided, of the demo's fits", count,
            "certain and possible at fixed poses, decided", lazily);
  look_rows(report, fits, "Certain and possible at fixed poses, in full, of the demo's fits",
            std::max(1, count / 10), "certain and possible at fixed poses, in full", full);
  search_rows(report, fits, count);
}

}  // namespace mortise::bench
