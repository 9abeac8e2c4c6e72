#include "client/report/gap_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "client/report/moments.h"
#include "common/session/tick/pair_gap.h"

namespace mortise {
namespace {

// Of each overlap. As many as `mortise check` gives a pair that it tells.
constexpr std::uint64_t kWork = 30'000;

// What a log keeps of a pose: quaternions and places as floats.
constexpr double kTurnRounding_rad = 4e-6, kPlaceRounding = 1.2e-7;

// How far a point of the part may be from where it was, mm.
double rounding_mm(const Part& part) {
  if (identical(part.X_WP, part.X_WP_scenario)) return 0.0;
  const auto& sphere = part.solid->sphere();
  return kTurnRounding_rad * (sphere.center_mm.norm() + sphere.radius_mm) +
         kPlaceRounding * part.X_WP.p.norm();
}

}  // namespace

Result<std::string> gap_answer(const SessionLog& log, const GapMoment& wanted) {
  const auto scene = scene_after(log, wanted.tick);
  if (!scene) return scene.error();
  const World& world = scene->world;
  for (const PartId id : {wanted.a, wanted.b})
    if (world.find_present(id) == nullptr)
      return fail(Code::kNotFound, fmt::format("the session has no part {} then", id.value));
  const Part &a = *world.find(std::min(wanted.a, wanted.b)),
             &b = *world.find(std::max(wanted.a, wanted.b));
  CcdScratch scratch;
  const PairGap gap = pair_gap(a, b, world.rule(a.id, b.id), kWork, scratch);
  const double off_mm = rounding_mm(a) + rounding_mm(b);
  return nlohmann::json{{"a", wanted.a.value},
                        {"b", wanted.b.value},
                        {"tick", world.tick},
                        {"mesh_mm", gap.mesh_mm},
                        {"real_mm", {gap.real_mm.lo - off_mm, gap.real_mm.hi + off_mm}},
                        {"verdict", gap.has_verdict}}
      .dump();
}

}  // namespace mortise
