#include "client/replay/explain.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/signed_distance.h"
#include "common/io/log/log_json.h"
#include "common/io/log/replay.h"
#include "common/math/rotation.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

// A word for what stands in JSON as one.
template <class Name>
Json word(Name value) {
  return std::string(name_of(value));
}

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

bool worse(const ClashEvent& x, const ClashEvent& y) {
  const auto rank = [](const ClashEvent& event) {
    return std::pair(static_cast<int>(event.verdict.collision_class), event.verdict.delta_mm.lo);
  };
  return rank(x) > rank(y);
}

// Of all that was told of the clash the worst, or what was told in that tick.
const ClashEvent* event_to_explain(const SessionLog& log, ClashId clash, std::uint64_t tick) {
  const ClashEvent* found = nullptr;
  for (const TickRecord& record : log.ticks)
    for (const ClashEvent& event : record.report.events) {
      if (event.clash != clash || event.kind == ClashEvent::Kind::kReview) continue;
      if (tick != 0 && event.tick != tick) continue;
      if (found == nullptr || worse(event, *found)) found = &event;
    }
  return found;
}

Json history_of(const SessionLog& log, ClashId clash, double tick_rate_hz) {
  Json history = Json::array();
  for (const TickRecord& record : log.ticks)
    for (const ClashEvent& event : record.report.events)
      if (event.clash == clash)
        history.push_back({{"tick", event.tick},
                           {"time_s", static_cast<double>(event.tick) / tick_rate_hz},
                           {"what", word(event.kind)},
                           {"class", word(event.verdict.collision_class)},
                           {"overlap_mm", json_of(event.verdict.delta_mm)},
                           {"status", word(event.review.status)}});
  return history;
}

Json increments_of(const TickRecord& record, const ClashEvent& event, const SessionNames& names) {
  Json list = Json::array();
  for (const Increment& increment : record.increments) {
    if (increment.part != event.part_a && increment.part != event.part_b) continue;
    Json row = {{"part", names.part(increment.part)},
                {"user", names.user(increment.user)},
                {"seq", increment.seq},
                {"translation_mm", json_of(increment.translation_mm)},
                {"rotation_rad", json_of(increment.rotation_rad)},
                {"refused", nullptr}};
    for (const RefusedIncrement& refused : record.report.refused)
      if (refused.user == increment.user && refused.seq == increment.seq)
        row["refused"] = word(refused.reason);
    list.push_back(std::move(row));
  }
  return list;
}

Json motion_of(const Part& part, const Pose& before) {
  const Vec3 reference_P = part.solid->sphere().center_mm;
  const Vec3 shift = part.X_WP * reference_P - before * reference_P;
  const Vec3 turn = rotation_log((part.X_WP.q * before.q.conjugate()).normalized());
  return {{"part", part.name},
          {"moved", !identical(part.X_WP, before)},
          {"translation_mm", json_of(shift)},
          {"rotation_rad", json_of(turn)},
          {"position_before_mm", json_of(before.p)},
          {"position_after_mm", json_of(part.X_WP.p)}};
}

struct DecidingFace {
  const SurfaceBand::Face* face = nullptr;
  bool of_pair = false;  // the pair has a fit of its own
};

DecidingFace face_of(const World& world, const ClashEvent& event, bool is_a) {
  const Part& part = *world.find(is_a ? event.part_a : event.part_b);
  const PairRule* rule = world.rule(event.part_a, event.part_b);
  const auto own = rule == nullptr ? nullptr : is_a ? rule->band_a : rule->band_b;
  const SurfaceBand& band = own ? *own : part.band;
  const std::string& name = is_a ? event.verdict.face_a : event.verdict.face_b;
  for (std::size_t i = 1; i < band.faces.size(); ++i)
    if (!name.empty() && band.faces[i].name == name) return {&band.faces[i], own != nullptr};
  const Vec3 x_P = part.X_WP.inverse() * event.verdict.point_W;
  return {&band.face_of(nearest_point(*part.solid, x_P).triangle), own != nullptr};
}

Json json_of_face(const World& world, const ClashEvent& event, bool is_a) {
  const Part& part = *world.find(is_a ? event.part_a : event.part_b);
  const auto [face, of_pair] = face_of(world, event, is_a);
  return {{"part", part.name},
          {"face", face->name},
          {"shape", word(is_a ? event.verdict.shape_a : event.verdict.shape_b)},
          {"has_surface", face->surface.has_value()},
          {"radius_mm", face->surface ? number(face->surface->radius_mm) : Json(nullptr)},
          {"inward", face->surface && face->surface->inward},
          {"mesh_error", word(face->grade)},
          {"deviation_mm", json_of(face->deviation_mm)},
          {"residual_mm", face->residual_mm},
          {"tolerance_mm", json_of(face->tolerance_mm)},
          {"tolerance_source", face->tolerance_source},
          {"of_a_fit", of_pair},
          {"point_part", json_of(Vec3(part.X_WP.inverse() * event.verdict.point_W))}};
}

Json thresholds_of_event(const World& world, const ClashEvent& event) {
  const Verdict& v = event.verdict;
  const Interval a = face_of(world, event, true).face->tolerance_mm;
  const Interval b = face_of(world, event, false).face->tolerance_mm;
  // delta > real_above as soon as the overlap exceeds what the least real parts lack; what the
  // tolerances do not explain of a threshold is the error of the mesh.
  return {{"fake_below_mm", v.fake_below_mm},
          {"fake_by_tolerance_mm", -(a.hi + b.hi)},
          {"fake_by_mesh_error_mm", v.fake_below_mm + a.hi + b.hi},
          {"real_above_mm", v.real_above_mm},
          {"real_by_tolerance_mm", -(a.lo + b.lo)},
          {"real_by_mesh_error_mm", v.real_above_mm + a.lo + b.lo}};
}

Json chain_of(const World& world, const TickRecord& record, const ClashEvent& event,
              const Pose (&before)[2]) {
  const SessionNames names = names_of(world);
  const Verdict& v = event.verdict;
  const PairRule* rule = world.rule(event.part_a, event.part_b);
  Json chain = {
      {"clash", event.clash.value},
      {"pair", names.pair(event.part_a, event.part_b)},
      {"tick", event.tick},
      {"time_s", static_cast<double>(event.tick) / world.tick_rate_hz},
      {"user", event.user ? names.user(event.user) : ""},
      {"cause", event.cause == Decision::Kind::kUnknown ? Json("motion") : word(event.cause)},
      {"policy", word(world.policy)},
      {"fit", rule != nullptr ? rule->fit : ""}};
  chain["increments"] = increments_of(record, event, names);
  chain["motion"] = {motion_of(*world.find(event.part_a), before[0]),
                     motion_of(*world.find(event.part_b), before[1])};
  chain["first_contact"] = {{"meshes_at", number(event.t_contact)},
                            {"possible_from", number(event.t_potential)},
                            {"real_from", number(event.t_real)},
                            {"travel_mm", v.travel_mm},
                            {"normal_travel_mm", v.normal_travel_mm}};
  chain["region"] = {{"point_mm", json_of(v.point_W)},
                     {"normal", json_of(v.normal_W)},
                     {"area_mm2", v.area_mm2},
                     {"overlap_mm", json_of(v.delta_mm)}};
  chain["faces"] = {json_of_face(world, event, true), json_of_face(world, event, false)};
  chain["thresholds"] = thresholds_of_event(world, event);
  chain["verdict"] = json_of(v);
  return chain;
}

}  // namespace

Result<Json> explain_clash(SessionLog log, ClashId clash, std::uint64_t tick,
                           const std::function<void(std::uint64_t)>& on_tick) {
  const ClashEvent* found = event_to_explain(log, clash, tick);
  if (found == nullptr)
    return fail(Code::kInvalidInput, "the log tells of no clash " + std::to_string(clash.value) +
                                         (tick == 0 ? "" : " in tick " + std::to_string(tick)) +
                                         "; mortise-replay export --csv lists them");
  const ClashEvent event_told = *found;
  const ClashEvent* told = &event_told;
  auto scene = scene_of(log);
  if (!scene) return scene.error();
  World& world = scene->world;
  Json history = history_of(log, clash, world.tick_rate_hz);
  std::erase_if(log.ticks, [&](const TickRecord& record) { return record.tick > told->tick; });
  if (world.find(told->part_a) == nullptr || world.find(told->part_b) == nullptr)
    return fail(Code::kInvalidInput, "the clash is of parts that the scenario does not have");
  Pose before[2];
  const auto remember = [&] {
    before[0] = world.find(told->part_a)->X_WP;
    before[1] = world.find(told->part_b)->X_WP;
  };
  remember();
  std::optional<Json> chain;
  const auto done = recompute(world, log, 1, [&](const ReplayedTick& now) {
    if (now.computed.tick == told->tick && now.logged != nullptr) {
      for (const ClashEvent& event : now.computed.events)
        if (event.clash == clash && event.kind == told->kind) {
          chain = chain_of(world, *now.logged, event, before);
          (*chain)["as_logged"] = log_json::first_difference(*told, event);
        }
    }
    remember();
    if (on_tick) on_tick(now.computed.tick);
  });
  if (!done) return done.error();
  if (!chain)
    return fail(Code::kInvalidInput,
                done->stopped_early.empty()
                    ? "computed again, the session does not have this clash: verify the log"
                    : "the log cannot be computed up to tick " + std::to_string(told->tick) + ": " +
                          done->stopped_early);
  (*chain)["history"] = std::move(history);
  return *chain;
}

}  // namespace mortise
