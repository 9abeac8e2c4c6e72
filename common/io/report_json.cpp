#include "common/io/report_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/evaluation/clash_line.h"
#include "common/messages/length_text.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string name_at(const std::vector<std::string>& names, std::uint32_t id) {
  if (id == 0) return "none";
  return id <= names.size() ? names[id - 1] : fmt::format("#{}", id);
}

/// The counts of a row, by class name, without "none".
Json by_class(const std::uint64_t (&counts)[4]) {
  Json json;
  for (int c = 3; c >= 1; --c) {
    json[std::string(name_of(static_cast<CollisionClass>(c)))] = counts[c];
  }
  return json;
}

Json json_of_row(const SessionStatistics::Row& row) {
  Json json;
  json["clashes"] = by_class(row.clashes);
  json["ticks"] = by_class(row.ticks);
  json["first_tick"] = row.first_tick;
  json["last_tick"] = row.last_tick;
  json["worst_tick"] = row.worst_tick;
  json["worst"] = json_of(row.worst);
  return json;
}

Json json_of_stage(const StageCount& stage) { return {{"in", stage.in}, {"out", stage.out}}; }

template <class Rows, class NameOf>
std::string rows_table(const char* title, const Rows& rows, NameOf name_of_key) {
  if (rows.empty()) return {};
  std::string text =
      fmt::format("\n{:<34}{:>6}{:>11}{:>6}  {}\n", title, "real", "potential", "fake", "worst");
  for (const auto& [key, row] : rows) {
    text += fmt::format("  {:<32}{:>6}{:>11}{:>6}  {} {}\n", name_of_key(key), row.clashes[3],
                        row.clashes[2], row.clashes[1], name_of(row.worst.collision_class),
                        length_text(row.worst.delta_mm.lo));
  }
  return text;
}

std::string stage_line(const char* name, const StageCount& stage,
                       std::initializer_list<std::pair<const char*, std::uint64_t>> skipped) {
  std::string reasons;
  for (const auto& [why, count] : skipped) {
    if (count == 0) continue;
    reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", count, why);
  }
  return fmt::format("  {:<14}{:>12}{:>12}  {}\n", name, stage.in, stage.out, reasons);
}

}  // namespace

std::string SessionNames::part(PartId id) const { return name_at(parts, id.value); }
std::string SessionNames::user(UserId id) const { return name_at(users, id.value); }
std::string SessionNames::pair(PartId a, PartId b) const { return part(a) + " × " + part(b); }

SessionNames names_of(const World& world) {
  SessionNames names;
  for (const Part& part : world.parts) names.parts.push_back(part.name);
  for (const User& user : world.users) names.users.push_back(user.name);
  return names;
}

SessionNames names_of(const Snapshot& snapshot) {
  SessionNames names;
  const auto put = [](std::vector<std::string>& list, std::uint32_t id, const std::string& name) {
    if (id == 0) return;
    if (list.size() < id) list.resize(id);
    list[id - 1] = name;
  };
  for (const PartInfo& part : snapshot.parts) put(names.parts, part.part.value, part.name);
  for (const UserInfo& user : snapshot.users) put(names.users, user.user.value, user.name);
  return names;
}

Json json_of(const Vec3& v) { return Json::array({number(v.x()), number(v.y()), number(v.z())}); }

Json json_of(Interval interval) { return Json::array({number(interval.lo), number(interval.hi)}); }

Json json_of(const Pose& pose) {
  return {{"position_mm", json_of(pose.p)},
          {"quaternion_wxyz", {pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()}}};
}

Json json_of(const Verdict& verdict) {
  Json json;
  json["class"] = name_of(verdict.collision_class);
  json["delta_mm"] = json_of(verdict.delta_mm);
  json["gpd_mm"] = json_of(verdict.gpd_mm);
  json["fake_below_mm"] = number(verdict.fake_below_mm);
  json["real_above_mm"] = number(verdict.real_above_mm);
  json["margin_mm"] = number(verdict.margin_mm);
  json["probability"] = has_probability(verdict) ? number(verdict.probability) : Json(nullptr);
  json["travel_mm"] = number(verdict.travel_mm);
  json["normal_travel_mm"] = number(verdict.normal_travel_mm);
  json["point_mm"] = json_of(verdict.point_W);
  json["normal"] = json_of(verdict.normal_W);
  json["area_mm2"] = number(verdict.area_mm2);
  json["witness_mm"] = verdict.has_witness ? json_of(verdict.witness_W) : Json(nullptr);
  json["separation"] = {{"translation_mm", json_of(verdict.separation_translation_mm)},
                        {"rotation_rad", json_of(verdict.separation_rotation_rad)},
                        {"about_mm", json_of(verdict.separation_about_W)},
                        {"moves", verdict.separation_of_b ? "b" : "a"},
                        {"way", name_of(verdict.separation_way)},
                        {"path", name_of(verdict.separation_path)}};
  json["shape_a"] = name_of(verdict.shape_a);
  json["shape_b"] = name_of(verdict.shape_b);
  json["face_a"] = verdict.face_a;
  json["face_b"] = verdict.face_b;
  json["grade"] = name_of(verdict.grade);
  json["explanation"] = verdict.explanation;
  return json;
}

Json json_of(const StepCounters& c) {
  Json json;
  json["increments"] = json_of_stage(c.increments);
  for (std::size_t i = 1; i < c.refused.size(); ++i) {
    if (c.refused[i] == 0) continue;
    json["increments"]["refused"][std::string(name_of(static_cast<Refusal>(i)))] = c.refused[i];
  }
  json["moves"] = json_of_stage(c.moves);
  json["moves"]["below_rounding"] = c.moves_below_rounding;
  json["pairs"] = json_of_stage(c.pairs);
  json["pairs"]["skipped"] = {{"static", c.pairs_static},
                              {"still", c.pairs_still},
                              {"excluded", c.pairs_excluded},
                              {"boxes_apart", c.pairs_boxes_apart},
                              {"known_apart", c.pairs_budget}};
  json["contacts"] = json_of_stage(c.contacts);
  json["contacts"]["clear"] = c.contacts_clear;
  json["contacts"]["undecided"] = c.contacts_undecided;
  json["verdicts"] = json_of_stage(c.verdicts);
  json["verdicts"]["by_class"] = by_class(c.verdicts_by_class);
  json["queries"] = {{"first_contact", c.first_contact_queries},
                     {"distance", c.distance_queries},
                     {"depth", c.depth_queries},
                     {"event_times", c.event_time_queries},
                     {"event_times_at_latest", c.event_times_at_latest}};
  json["judged"] = {{"with_bands", c.judged_with_bands},
                    {"plain", c.judged_plain},
                    {"regions_decided_early", c.regions_decided_early},
                    {"regions_refined", c.regions_refined}};
  json["work"] = {{"box_tests", c.box_tests},
                  {"triangle_tests", c.triangle_tests},
                  {"depth_evaluations", c.depth_evaluations}};
  json["stopped_parts"] = c.stopped_parts;
  json["rounds"] = c.rounds;
  json["slides"] = {{"parts", c.slid_parts},
                    {"legs", c.slide_legs},
                    {"holds", c.slide_holds},
                    {"cut_short", c.slides_cut_short}};
  json["parts_without_inside"] = c.parts_without_inside;
  json["waiting_for_work"] = c.pairs_waiting;
  json["held_again"] = c.pairs_held_again;
  json["pushes_cut"] = c.pushes_cut;
  json["not_examined"] = c.not_examined;
  return json;
}

Json json_of(const ClashEvent& event, const SessionNames& names) {
  Json json;
  json["kind"] = name_of(event.kind);
  json["seq"] = event.seq;
  json["tick"] = event.tick;
  json["clash"] = event.clash.value;
  json["part_a"] = names.part(event.part_a);
  json["part_b"] = names.part(event.part_b);
  json["user"] = names.user(event.user);
  json["t_contact"] = number(event.t_contact);
  json["t_potential"] = number(event.t_potential);
  json["t_real"] = number(event.t_real);
  json["begin_tick"] = event.begin_tick;
  json["worst_class"] = name_of(event.worst_class);
  json["worst_delta_mm"] = json_of(event.worst_delta_mm);
  json["verdict"] = json_of(event.verdict);
  return json;
}

Json json_of(const PairVerdicts& pair, const SessionNames& names) {
  Json json;
  json["part_a"] = names.part(pair.a);
  json["part_b"] = names.part(pair.b);
  json["excluded"] = pair.excluded;
  json["no_inside"] = pair.no_inside;
  json["not_examined"] = pair.not_examined;
  json["distance_mm"] = number(pair.distance_mm);
  if (pair.layers.least_mm && pair.layers.largest_mm) {
    json["gpd_least_mm"] = json_of(*pair.layers.least_mm);
    json["gpd_largest_mm"] = json_of(*pair.layers.largest_mm);
  }
  json["verdicts"] = Json::array();
  for (const Verdict& verdict : pair.verdicts) {
    json["verdicts"].push_back(json_of(verdict));
    if (verdict.separation_blocker)
      json["verdicts"].back()["separation"]["blocker"] = names.part(verdict.separation_blocker);
  }
  return json;
}

Json json_of(const ChannelCounters& c) {
  return {{"received", c.received},         {"malformed", c.malformed},
          {"foreign", c.foreign},           {"lost", c.lost},
          {"send_failed", c.send_failed},   {"guard_dropped", c.guard_dropped},
          {"trailers_cut", c.trailers_cut}, {"turned_away", c.turned_away}};
}

Json json_of(const SessionStatistics& statistics, const SessionNames& names) {
  Json json;
  json["ticks"] = statistics.ticks();
  for (int c = 3; c >= 1; --c) {
    const auto klass = static_cast<CollisionClass>(c);
    json["by_class"][std::string(name_of(klass))] = {{"total", statistics.clashes_total(klass)},
                                                     {"open", statistics.clashes_open(klass)}};
  }
  json["by_pair"] = Json::array();
  for (const auto& [key, row] : statistics.by_pair()) {
    Json entry{{"part_a", names.part(key.first)}, {"part_b", names.part(key.second)}};
    entry.update(json_of_row(row));
    json["by_pair"].push_back(std::move(entry));
  }
  json["by_part"] = Json::array();
  for (const auto& [part, row] : statistics.by_part()) {
    Json entry{{"part", names.part(part)}};
    entry.update(json_of_row(row));
    json["by_part"].push_back(std::move(entry));
  }
  json["by_user"] = Json::array();
  for (const auto& [user, row] : statistics.by_user()) {
    Json entry{{"user", names.user(user)}};
    entry.update(json_of_row(row));
    json["by_user"].push_back(std::move(entry));
  }
  json["clashes"] = Json::array();
  for (const auto& [id, clash] : statistics.clashes()) {
    json["clashes"].push_back({{"clash", id.value},
                               {"part_a", names.part(clash.a)},
                               {"part_b", names.part(clash.b)},
                               {"user", names.user(clash.user)},
                               {"begin_tick", clash.begin_tick},
                               {"end_tick", clash.end_tick},
                               {"open", clash.end_tick == 0},
                               {"worst_class", name_of(clash.worst_class)},
                               {"ticks", by_class(clash.ticks)},
                               {"worst", json_of(clash.worst)}});
  }
  json["ended_clashes_left_out"] = statistics.rows_left_out();
  json["stages"] = json_of(statistics.counters());
  return json;
}

std::string collision_table(const SessionStatistics& statistics, const SessionNames& names) {
  const auto total = [&](CollisionClass c) { return statistics.clashes_total(c); };
  const auto open = [&](CollisionClass c) { return statistics.clashes_open(c); };
  using enum CollisionClass;
  std::uint64_t pairs[4] = {};
  for (const auto& [key, row] : statistics.by_pair())
    ++pairs[static_cast<std::size_t>(row.worst.collision_class)];
  std::string text =
      fmt::format("{:<34}{:>6}{:>11}{:>6}\n", "Collisions", "real", "potential", "fake");
  const auto counts = [&](const char* what, std::uint64_t real, std::uint64_t potential,
                          std::uint64_t fake) {
    text += fmt::format("  {:<32}{:>6}{:>11}{:>6}\n", what, real, potential, fake);
  };
  counts("pairs of parts, by their worst", pairs[3], pairs[2], pairs[1]);
  counts("places, in all", total(kReal), total(kPotential), total(kFake));
  counts("places, still open", open(kReal), open(kPotential), open(kFake));
  text += rows_table("By pair", statistics.by_pair(),
                     [&](const auto& key) { return names.pair(key.first, key.second); });
  text += rows_table("By user", statistics.by_user(), [&](UserId id) { return names.user(id); });

  std::vector<ClashLine> worst;
  for (const auto& [key, row] : statistics.by_pair())
    if (row.worst.collision_class != kNone)
      worst.push_back({names.part(key.first), names.part(key.second), &row.worst, "", 0,
                       fmt::format("tick {}", row.worst_tick)});
  std::stable_sort(worst.begin(), worst.end(), [](const ClashLine& x, const ClashLine& y) {
    return x.verdict->collision_class > y.verdict->collision_class;
  });
  if (worst.empty()) return text;
  text += "\nWorst of each pair\n";
  const std::vector<std::string> lines = clash_lines(worst);
  for (std::size_t i = 0; i < worst.size(); ++i)
    text += fmt::format("{}\n  {}\n", lines[i], worst[i].verdict->explanation);
  return text;
}

std::string stage_table(const StepCounters& c) {
  std::string text =
      fmt::format("  {:<14}{:>12}{:>12}  {}\n", "stage", "in", "out", "skipped because");
  std::string refused;
  for (std::size_t i = 1; i < c.refused.size(); ++i) {
    if (c.refused[i] == 0) continue;
    refused += fmt::format("{}{} {}", refused.empty() ? "" : ", ", c.refused[i],
                           name_of(static_cast<Refusal>(i)));
  }
  text += fmt::format("  {:<14}{:>12}{:>12}  {}\n", "increments", c.increments.in, c.increments.out,
                      refused);
  text += stage_line("moves", c.moves, {{"below rounding", c.moves_below_rounding}});
  text += stage_line("pairs", c.pairs,
                     {{"both static", c.pairs_static},
                      {"both still", c.pairs_still},
                      {"excluded", c.pairs_excluded},
                      {"boxes apart", c.pairs_boxes_apart},
                      {"known to stay apart", c.pairs_budget}});
  text += stage_line("contacts", c.contacts,
                     {{"clear", c.contacts_clear}, {"undecided", c.contacts_undecided}});
  text += fmt::format("  {:<14}{:>12}{:>12}  {} real, {} potential, {} fake\n", "verdicts",
                      c.verdicts.in, c.verdicts.out, c.verdicts_by_class[3], c.verdicts_by_class[2],
                      c.verdicts_by_class[1]);
  text +=
      fmt::format("  {:<14}{:>12}{:>12}  {} plain: nothing declared, no band looked at\n", "bands",
                  c.judged_with_bands + c.judged_plain, c.judged_with_bands, c.judged_plain);
  text += fmt::format("  {:<14}{:>12}{:>12}  {} decided before their depth was\n", "refined",
                      c.regions_decided_early + c.regions_refined, c.regions_refined,
                      c.regions_decided_early);
  if (c.event_times_at_latest > 0)
    text += fmt::format("  {} time(s) of events are told as at the latest (work cap)\n",
                        c.event_times_at_latest);
  if (c.not_examined > 0) {
    text += fmt::format(
        "  {} pair(s) were NOT examined to the end (work cap); they are not "
        "reported as clear\n",
        c.not_examined);
  }
  return text;
}

}  // namespace mortise
