#include "client/web/json_out.h"

#include <algorithm>
#include <cmath>

#include "common/base/json_text.h"
#include "common/base/nearest_rank.h"
#include "common/messages/names.h"

namespace mortise::web {
namespace {

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json both_ends(Interval interval) {
  return Json::array({number(interval.lo), number(interval.hi)});
}

Json constraint_json(const Constraint& constraint) {
  return {{"kind", name_of(constraint.kind)},
          {"part", constraint.held.part.value},
          {"feature", constraint.held.feature},
          {"other", constraint.other.part.value},
          {"other_feature", constraint.other.feature},
          {"distance", number(constraint.distance_mm)},
          {"snap", constraint.snap}};
}

Json by_class(const std::uint64_t (&counts)[4]) {
  Json json;
  for (int c = 3; c >= 1; --c) {
    json[std::string(name_of(static_cast<CollisionClass>(c)))] = counts[c];
  }
  return json;
}

void put_verdict(Json& json, const Verdict& verdict) {
  json["class"] = name_of(verdict.collision_class);
  json["delta"] = both_ends(verdict.delta_mm);
  json["gpd"] = both_ends(verdict.gpd_mm);
  json["fake_below"] = number(verdict.fake_below_mm);
  json["real_above"] = number(verdict.real_above_mm);
  json["margin"] = number(verdict.margin_mm);
  json["probability"] = has_probability(verdict) ? number(verdict.probability) : Json(nullptr);
  json["travel"] = number(verdict.travel_mm);
  json["normal_travel"] = number(verdict.normal_travel_mm);
  json["point"] = json_of(verdict.point_W);
  json["normal"] = json_of(verdict.normal_W);
  json["area"] = number(verdict.area_mm2);
  json["witness"] = verdict.has_witness ? json_of(verdict.witness_W) : Json(nullptr);
  json["separation"] = {{"t", json_of(verdict.separation_translation_mm)},
                        {"r", json_of(verdict.separation_rotation_rad)},
                        {"about", json_of(verdict.separation_about_W)},
                        {"moves", verdict.separation_of_b ? "b" : "a"},
                        {"way", name_of(verdict.separation_way)},
                        {"path", name_of(verdict.separation_path)},
                        {"blocker", verdict.separation_blocker.value}};
  json["shapes"] = {name_of(verdict.shape_a), name_of(verdict.shape_b)};
  json["faces"] = {verdict.face_a, verdict.face_b};
  json["grade"] = name_of(verdict.grade);
  json["explanation"] = verdict.explanation;
}

}  // namespace

Json json_of(const Vec3& v) { return Json::array({number(v.x()), number(v.y()), number(v.z())}); }

Json json_of(const Pose& pose) {
  return {{"p", json_of(pose.p)}, {"q", {pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w()}}};
}

Json json_of(const PartInfo& part, std::uint32_t classes) {
  Json json{{"id", part.part.value},
            {"name", part.name},
            {"mesh", part.mesh_hash},
            {"moving", part.moving},
            {"holder", part.holder.value}};
  json.update(json_of(part.X_WP));
  json["radius"] = number(part.radius_mm);
  json["reference"] = json_of(part.reference_P);
  json["classes"] = classes;
  return json;
}

Json json_of(const UserInfo& user) {
  return {{"id", user.user.value},
          {"name", user.name},
          {"present", user.present},
          {"role", name_of(user.role)}};
}

Json json_of(const ClashEvent& event) {
  Json json{{"kind", name_of(event.kind)}, {"seq", event.seq},        {"tick", event.tick},
            {"clash", event.clash.value},  {"a", event.part_a.value}, {"b", event.part_b.value},
            {"user", event.user.value}};
  put_verdict(json, event.verdict);
  json["t_contact"] = number(event.t_contact);
  json["t_potential"] = number(event.t_potential);
  json["t_real"] = number(event.t_real);
  json["begin_tick"] = event.begin_tick;
  json["worst_class"] = name_of(event.worst_class);
  json["worst_delta"] = both_ends(event.worst_delta_mm);
  json["cause"] = name_of(event.cause);
  json["review"] = {{"status", name_of(event.review.status)},
                    {"comment", event.review.comment},
                    {"user", event.review.user.value},
                    {"tick", event.review.tick}};
  json["approval_lost"] = event.approval_lost;
  return json;
}

Json json_of(const Decision& decision) {
  Json json{{"kind", name_of(decision.kind)},
            {"user", decision.user.value},
            {"part", decision.part.value}};
  const Details& details = decision.details;
  if (decision.kind == Decision::Kind::kJoin) {
    json["name"] = decision.user_name;
    json["role"] = name_of(decision.role);
  }
  for (const PartId part : details.parts) json["parts"].push_back(part.value);
  if (details.other_part) json["other"] = details.other_part.value;
  if (!details.feature.empty()) json["feature"] = details.feature;
  if (!details.other_feature.empty()) json["other_feature"] = details.other_feature;
  if (details.other_user) json["other_user"] = details.other_user.value;
  if (details.clash) {
    json["clash"] = details.clash.value;
    json["status"] = name_of(details.status);
  }
  if (!details.text.empty()) json["text"] = details.text;
  if (details.constraint.kind != ConstraintKind::kUnknown)
    json["constraint"] = constraint_json(details.constraint);
  if (details.edit) {
    json["mesh"] = details.edit->mesh_hash;
    json["moving"] = details.edit->moving;
    if (!details.edit->name.empty()) json["name"] = details.edit->name;
  }
  if (details.constraint_id) json["constraint_id"] = details.constraint_id.value;
  return json;
}

Json json_of(const Remark& remark) {
  return {{"clash", remark.clash.value},
          {"user", remark.user.value},
          {"assignee", remark.assignee.value},
          {"status", name_of(remark.status)},
          {"tick", remark.tick},
          {"text", remark.text}};
}

Json json_of(const UnexaminedRow& row) {
  return {{"a", row.a.value}, {"b", row.b.value}, {"why", name_of(row.why)}, {"ticks", row.ticks}};
}

Json json_of(const SessionPulse& pulse) {
  Json unexamined = Json::array();
  for (const UnexaminedRow& row : pulse.unexamined) unexamined.push_back(json_of(row));
  return {{"type", "pulse"},
          {"tick", pulse.tick},
          {"open", by_class(pulse.clashes_open)},
          {"total", by_class(pulse.clashes_total)},
          {"tick_us",
           {{"p50", number(pulse.tick_p50_us)},
            {"p99", number(pulse.tick_p99_us)},
            {"max", number(pulse.tick_max_us)}}},
          {"lateness_p99_us", number(pulse.lateness_p99_us)},
          {"missed_deadlines", pulse.missed_deadlines},
          {"refused", pulse.refused},
          {"not_examined", pulse.not_examined},
          {"users", pulse.users},
          {"unexamined", std::move(unexamined)},
          {"unexamined_left_out", pulse.unexamined_left_out},
          {"draining", pulse.draining}};
}

Json percentiles_of(std::vector<double> samples_ms) {
  if (samples_ms.empty()) return nullptr;
  std::sort(samples_ms.begin(), samples_ms.end());
  return {{"p50", number(quantile_of_sorted(samples_ms, 0.5))},
          {"p99", number(quantile_of_sorted(samples_ms, 0.99))},
          {"samples", samples_ms.size()}};
}

Json json_of(const Scene& scene, const ClassBits& classes) {
  Json json{{"type", "scene"},           {"session", scene.session},
            {"tick", scene.tick},        {"tick_rate_hz", number(scene.tick_rate_hz)},
            {"policy", scene.policy},    {"parts", Json::array()},
            {"users", Json::array()},    {"clashes", Json::array()},
            {"standing", Json::array()}, {"remarks", Json::array()}};
  for (const PartInfo& part : scene.parts) {
    const auto bits = classes.find(part.part);
    Json row = json_of(part, bits == classes.end() ? 0u : bits->second);
    row["notes"] = Json::array();
    json["parts"].push_back(std::move(row));
  }
  std::map<PartId, std::size_t> row_of;
  for (std::size_t i = 0; i < scene.parts.size(); ++i) row_of[scene.parts[i].part] = i;
  for (const PartNote& note : scene.notes)
    if (const auto row = row_of.find(note.part); row != row_of.end())
      json["parts"][row->second]["notes"].push_back(note.text);
  for (const UserInfo& user : scene.users) json["users"].push_back(json_of(user));
  for (ClashEvent clash : scene.clashes) {
    clash.kind = ClashEvent::Kind::kBegin;
    json["clashes"].push_back(json_of(clash));
  }
  for (const Decision& decision : scene.standing) json["standing"].push_back(json_of(decision));
  for (const Remark& remark : scene.remarks) json["remarks"].push_back(json_of(remark));
  return json;
}

ClassBits class_bits_of(std::span<const ClashEvent> open) {
  ClassBits bits;
  for (const ClashEvent& clash : open) {
    const std::uint32_t bit = class_bit(clash.verdict.collision_class);
    if (bit == 0) continue;
    bits[clash.part_a] |= bit;
    bits[clash.part_b] |= bit;
  }
  return bits;
}

SharedBytes text_of(const Json& json) {
  return std::make_shared<const std::string>(json_text(json, -1));
}

}  // namespace mortise::web
