// Parts that lie in one place: the same part twice, one wholly inside another, two shafts in one
// bore's place. What their judgement costs, and whether the sentence names what they are.
#include <algorithm>

#include "common/evaluation/band.h"
#include "common/evaluation/iso286.h"
#include "common/evaluation/tolerance.h"
#include "common/math/rotation.h"
#include "tests/bench/judgement_methods.h"
#include "tests/bench/judgement_sections.h"
#include "tests/bench/scenes.h"
#include "tests/bench/statistics.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

constexpr double kPlaceBar_ms = 20.0;

struct Placed {
  std::string name;
  Part a, b;
  Pose X_BA;
  std::string named;  ///< what the sentence has to say; empty: nothing
};

Part part_of(std::uint32_t id, const SolidPtr& solid, double zone_mm) {
  Part part;
  part.id = PartId{id};
  part.name = id == 1 ? "one" : "other";
  part.solid = solid;
  part.band = nominal_band();
  if (!(zone_mm > 0.0)) return part;
  BandInput input;
  input.solid = solid.get();
  input.rest = {{-zone_mm, zone_mm}, "profile"};
  part.band = build_band(input);
  return part;
}

// Ø20 g6, 40 mm long.
Placed two_shafts(const std::string& name, const Pose& X_BA, int facets) {
  JudgedCase c;
  c.a = make_shaft({10.0, 0.0, 10.0, 40.0}, 1, {facets, 0.0});
  c.b = make_shaft({10.0, 0.0, 10.0, 40.0}, 1, {facets, 0.0});
  c.offset_a_mm = c.offset_b_mm = size_offset_mm(iso286_fit("H7/g6", 20.0)->shaft, 10.0);
  c.stated_a = c.stated_b = 1;
  const auto known = with_grade(c, Grade::kDeclared);
  return {name, known->a, known->b, X_BA, ""};
}

std::vector<Placed> placed_parts() {
  const SolidPtr gear = gear_solid(24, 48, 0.0);
  const SolidPtr ring = shapes::solid(shapes::ring({12, -10, 10, 256, 9, 0}, 25));
  const SolidPtr block = shapes::solid(shapes::box({40, 40, 40}, Vec3::Zero(), 10));
  const SolidPtr pin = shapes::solid(shapes::peg({6, -15, 15, 64, 9, 0}));
  const SolidPtr ball = shapes::solid(shapes::sphere(12.0, Vec3::Zero(), 50));
  const std::string twice = "the same part twice", inside = "lies wholly inside";
  const Pose turned{rotation_exp(Vec3(0.4, -0.3, 0.9)), Vec3(3.0, -5.0, 4.0)};
  std::vector<Placed> all;
  for (const double zone_mm : {0.0, 0.02}) {
    const std::string stated = zone_mm > 0.0 ? ", profile" : "";
    const auto add = [&](const std::string& name, const SolidPtr& a, const SolidPtr& b,
                         const Pose& X_BA, const std::string& named) {
      all.push_back({name + stated, part_of(1, a, zone_mm), part_of(2, b, zone_mm), X_BA, named});
    };
    add("a gear twice", gear, gear, Pose(), twice);
    add("a ring twice", ring, ring, Pose(), twice);
    add("a ring twice, 5 um apart", ring, ring, Pose::translation(Vec3(0.003, 0.0, 0.004)), twice);
    add("a block twice", block, block, Pose(), twice);
    add("a ball twice", ball, ball, Pose(), twice);
    add("a pin in a block", pin, block, turned, inside);
    add("a ball in a block", ball, block, turned, inside);
  }
  all.push_back(two_shafts("two shafts Ø20 g6 in one place", Pose(), 64));
  all.push_back(two_shafts("two shafts Ø20 g6, turned and shifted along",
                           {rotation_exp(Vec3(0, 0, 0.3)), Vec3(0, 0, 12.0)}, 96));
  all.push_back(
      two_shafts("two shafts Ø20 g6, 4 um beside", Pose::translation(Vec3(0.004, 0, 0)), 128));
  return all;
}

}  // namespace

void section_places(Report& report, const JudgementOptions&) {
  report.table("Judging parts that lie in one place, as a tick does",
               {"parts", "ms", "ms, without gpd", "word", "named", "sentence"});
  double worst_ms = 0.0;
  long long wrong = 0;
  CcdScratch scratch;
  for (const Placed& placed : placed_parts()) {
    JudgementQuery query;
    query.a = &placed.a;
    query.b = &placed.b;
    query.motion_a = still_motion(placed.X_BA);
    query.motion_b = still_motion(Pose());
    query.work_cap = AskOurs{}.work_cap;
    const Judgement judgement = judge_pair(query, scratch);
    const double ms = 1e3 * least_time_s([&] { judge_pair(query, scratch); }, 3);
    query.want_gpd = false;
    const double without_ms = 1e3 * least_time_s([&] { judge_pair(query, scratch); }, 3);
    worst_ms = std::max(worst_ms, ms);
    const bool said = !judgement.verdicts.empty();
    const bool real = said && judgement.verdicts.front().collision_class == CollisionClass::kReal;
    const std::string text = said ? judgement.verdicts.front().explanation : "";
    const bool named = text.find(placed.named) != std::string::npos;
    wrong += !real || !named;
    report.row({placed.name, ms, without_ms, real ? "real" : "not real",
                placed.named.empty() ? "-"
                : named              ? "yes"
                                     : "no",
                text});
  }
  report.bar("parts in one place: longest judgement, ms", worst_ms, kPlaceBar_ms,
             BoundKind::kAtMost);
  report.bar("parts in one place: not real, or not named", static_cast<double>(wrong), 0.0,
             BoundKind::kAtMost);
}

}  // namespace mortise::bench
