// What judging costs, as ratios of one run: beside the pair's own first contact, and a decided
// class beside the full bracket.
#include <cmath>
#include <numbers>

#include "common/evaluation/band.h"
#include "common/math/rotation.h"
#include "tests/bench/judgement_methods.h"
#include "tests/bench/judgement_sections.h"
#include "tests/bench/scenes.h"
#include "tests/bench/statistics.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

constexpr double kJudgeBar = 3.0, kJudgeWorstBar = 10.0, kEarlyBar = 0.2;

/// A pair of parts and a tick in which they come to touch.
struct Touching {
  Part a, b;
  Motion motion_a, motion_b;
  double t_contact = 1.0;
};

Part part_of(std::uint32_t id, const SolidPtr& solid, double zone_mm) {
  Part part;
  part.id = PartId{id};
  part.solid = solid;
  part.band = nominal_band();
  if (zone_mm > 0.0) {
    BandInput input;
    input.solid = solid.get();
    input.rest = {{-zone_mm, zone_mm}, "profile"};
    part.band = build_band(input);
  }
  return part;
}

ContactQuery query_of(const Touching& pair) {
  ContactQuery query;
  query.a = pair.a.solid.get();
  query.b = pair.b.solid.get();
  query.motion_a = pair.motion_a;
  query.motion_b = pair.motion_b;
  return query;
}

// From 1 mm before the first contact along `push` to `deep_mm` beyond it, in one tick.
bool make_touch(Touching& pair, const Pose& X_WA, const Vec3& push, double deep_mm,
                CcdScratch& scratch) {
  pair.motion_b = still_motion(Pose());
  pair.motion_a =
      linear_motion(X_WA, Pose::translation(200.0 * push) * X_WA, pair.a.solid->sphere().center_mm);
  const FirstContact first = first_contact(query_of(pair), scratch);
  if (first.state != ContactState::kContact) return false;
  const Pose X_W0 = Pose::translation((200.0 * first.t_contact - 1.0) * push) * X_WA;
  pair.motion_a = linear_motion(X_W0, Pose::translation((1.0 + deep_mm) * push) * X_W0,
                                pair.a.solid->sphere().center_mm);
  const FirstContact again = first_contact(query_of(pair), scratch);
  pair.t_contact = again.t_contact;
  return again.state == ContactState::kContact;
}

struct Body {
  const char* name;
  SolidPtr solid;
};

std::vector<Body> bodies() {
  return {{"ball", shapes::solid(shapes::sphere(20.0, Vec3::Zero(), 50))},
          {"block", shapes::solid(shapes::box({20, 15, 10}, Vec3::Zero(), 29))},
          {"shaft", shapes::solid(shapes::peg({12, -25, 25, 256, 18, 0}))},
          {"ring", shapes::solid(shapes::ring({12, -10, 10, 256, 9, 0}, 25))},
          {"gear", gear_solid(24, 48, 0.0)}};
}

struct Ratios {
  std::vector<double> judge_s, contact_s, ratio, without_gpd;
};

void touching_rows(Report& report, bool quick) {
  const std::vector<Body> all = bodies();
  Dice dice(51);
  CcdScratch scratch;
  report.table("Judging a touching pair of 10k triangles each, beside its own first contact",
               {"pair", "stated", "ticks", "triangles of A", "triangles of B", "contact us",
                "judge us", "judge / contact, median", "p99", "without gpd, median"});
  Ratios total;
  const int ticks = quick ? 3 : 16;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i; j < all.size(); ++j)
      for (const double zone_mm : {0.0, 0.02}) {
        Ratios r;
        for (int tries = 0; r.ratio.size() < static_cast<std::size_t>(ticks) && tries < 4 * ticks;
             ++tries) {
          Touching pair;
          pair.a = part_of(1, all[i].solid, zone_mm);
          pair.b = part_of(2, all[j].solid, zone_mm);
          const Vec3 from = dice.direction();
          const Vec3 aside(dice.between(-8, 8), dice.between(-8, 8), dice.between(-8, 8));
          if (!make_touch(pair, {dice.orientation(), 120.0 * from + aside}, -from,
                          dice.spread(0.001, 0.3), scratch))
            continue;
          JudgementQuery query;
          query.a = &pair.a;
          query.b = &pair.b;
          query.motion_a = pair.motion_a;
          query.motion_b = pair.motion_b;
          query.t_contact = pair.t_contact;
          query.work_cap = AskOurs{}.work_cap;
          const ContactQuery contact = query_of(pair);
          judge_pair(query, scratch);
          const double contact_s = least_time_s([&] { first_contact(contact, scratch); });
          const double judge_s = least_time_s([&] { judge_pair(query, scratch); });
          query.want_gpd = false;
          const double plain_s = least_time_s([&] { judge_pair(query, scratch); });
          r.contact_s.push_back(contact_s);
          r.judge_s.push_back(judge_s);
          r.ratio.push_back(judge_s / contact_s);
          r.without_gpd.push_back(plain_s / contact_s);
        }
        if (r.ratio.empty()) continue;
        report.row({std::string(all[i].name) + " on " + all[j].name,
                    zone_mm > 0.0 ? "profile" : "nothing", static_cast<long long>(r.ratio.size()),
                    static_cast<long long>(all[i].solid->mesh().triangles.size()),
                    static_cast<long long>(all[j].solid->mesh().triangles.size()),
                    1e6 * median(r.contact_s), 1e6 * median(r.judge_s), median(r.ratio),
                    quantile(r.ratio, 0.99), median(r.without_gpd)});
        total.ratio.insert(total.ratio.end(), r.ratio.begin(), r.ratio.end());
      }
  report.bar("judging a touching pair of 10k triangles / its first contact, median",
             median(total.ratio), kJudgeBar, BoundKind::kAtMost);
  report.bar("judging a touching pair of 10k triangles / its first contact, p99",
             quantile(total.ratio, 0.99), kJudgeWorstBar, BoundKind::kAtMost);
}

// Far from both thresholds: ten times the width of what is admissible, and a tenth of a
// millimetre.
bool is_far(const JudgedCase& c, const Truth& truth) {
  return truth.margin_mm() > std::max(0.1, 10.0 * (truth.possible_mm - truth.certain_mm)) &&
         truth.collision_class() != CollisionClass::kPotential && c.facets() > 0;
}

// The shaft of a case moved aside until it is deep in the wall, or made thin.
JudgedCase far_case(std::uint64_t seed) {
  JudgedCase c = draw_case(Family::kCylinder, seed);
  const RoundFit fit = std::get<RoundFit>(c.shape);
  Dice dice(seed);
  RoundFit moved = fit;
  moved.X_BA.p += (0.01 + dice.between(0.0, 0.05)) * fit.hole.r0_mm *
                  shapes::on_circle(1.0, dice.between(0.0, 2.0 * std::numbers::pi), 0.0);
  c.X_WA = c.X_WB * moved.X_BA;
  c.shape = moved;
  c.overlap_mm = [moved](const Offsets& offsets) { return round_overlap_mm(moved, offsets); };
  c.mesh_depth_mm.reset();
  return c;
}

void early_rows(Report& report, bool quick) {
  std::vector<double> decided_s, full_s, ratio;
  long long capped = 0;
  for (std::uint64_t seed = 0; ratio.size() < (quick ? 40U : 100U) && seed < 5000; ++seed) {
    const JudgedCase c = far_case(2'000'000 + seed);
    if (!is_far(c, c.truth(false))) continue;
    const auto pair = with_grade(c, Grade::kDeclared);
    const Word decided = ask_ours(c, *pair, {Refinement::kDecided, false, kFullWorkCap});
    const Word full = ask_ours(c, *pair, {Refinement::kFull, false, kFullWorkCap});
    decided_s.push_back(decided.time_s);
    full_s.push_back(full.time_s);
    ratio.push_back(decided.time_s / full.time_s);
    capped += full.capped;
  }
  report.table("Decided early, far from both thresholds, beside the full bracket",
               {"cases", "decided us median", "full us median", "ratio median", "ratio p99",
                "full at the cap"});
  report.row({static_cast<long long>(ratio.size()), 1e6 * median(decided_s), 1e6 * median(full_s),
              median(ratio), quantile(ratio, 0.99), capped});
  report.bar("decided early / full bracket, median", median(ratio), kEarlyBar, BoundKind::kAtMost);
}

}  // namespace

void section_speed(Report& report, const JudgementOptions& options) {
  touching_rows(report, options.quick);
  early_rows(report, options.quick);
}

}  // namespace mortise::bench
