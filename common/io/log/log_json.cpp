#include "common/io/log/log_json.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/json_text.h"
#include "common/messages/names.h"
#include "common/session/tick/statistics.h"

namespace mortise::log_json {
namespace {

using nlohmann::ordered_json;

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}
ordered_json vector(const Vec3& v) {
  return {{"x", number(v.x())}, {"y", number(v.y())}, {"z", number(v.z())}};
}
ordered_json interval(Interval i) { return {{"lo", number(i.lo)}, {"hi", number(i.hi)}}; }

ordered_json json_of(const Review& review) {
  return {{"status", name_of(review.status)},
          {"comment", review.comment},
          {"user", review.user.value},
          {"tick", review.tick}};
}

ordered_json json_of(const ClashEvent& event) {
  const Verdict& v = event.verdict;
  return {{"tick", event.tick},
          {"seq", event.seq},
          {"kind", name_of(event.kind)},
          {"clash", event.clash.value},
          {"part_a", event.part_a.value},
          {"part_b", event.part_b.value},
          {"user", event.user.value},
          {"class", name_of(v.collision_class)},
          {"delta_mm", interval(v.delta_mm)},
          {"gpd_mm", interval(v.gpd_mm)},
          {"fake_below_mm", number(v.fake_below_mm)},
          {"real_above_mm", number(v.real_above_mm)},
          {"margin_mm", number(v.margin_mm)},
          {"probability", has_probability(v) ? number(v.probability) : ordered_json(nullptr)},
          {"travel_mm", number(v.travel_mm)},
          {"normal_travel_mm", number(v.normal_travel_mm)},
          {"point_W", vector(v.point_W)},
          {"normal_W", vector(v.normal_W)},
          {"area_mm2", number(v.area_mm2)},
          {"has_witness", v.has_witness},
          {"witness_W", vector(v.witness_W)},
          {"separation_translation_mm", vector(v.separation_translation_mm)},
          {"separation_rotation_rad", vector(v.separation_rotation_rad)},
          {"separation_about_W", vector(v.separation_about_W)},
          {"separation_of_b", v.separation_of_b},
          {"separation_way", name_of(v.separation_way)},
          {"separation_path", name_of(v.separation_path)},
          {"separation_blocker", v.separation_blocker.value},
          {"shape_a", name_of(v.shape_a)},
          {"shape_b", name_of(v.shape_b)},
          {"grade", name_of(v.grade)},
          {"face_a", v.face_a},
          {"face_b", v.face_b},
          {"explanation", v.explanation},
          {"t_contact", number(event.t_contact)},
          {"t_potential", number(event.t_potential)},
          {"t_real", number(event.t_real)},
          {"begin_tick", event.begin_tick},
          {"worst_class", name_of(event.worst_class)},
          {"worst_delta_mm", interval(event.worst_delta_mm)},
          {"cause", name_of(event.cause)},
          {"review", json_of(event.review)},
          {"approval_lost", event.approval_lost}};
}

// Text that is not UTF-8 must not stop a log: replaced, never thrown.
std::string dump(const ordered_json& json) { return json_text(json, -1); }

// Reads typed members of one object; anything missing or of another type makes ok false.
struct Members {
  const ordered_json& object;
  bool ok = true;

  const ordered_json* find(const char* key) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    if (!object.is_object() || found == object.end()) {
      ok = false;
      return nullptr;
    }
    return &*found;
  }
  template <class Integer>
  void integer(const char* key, Integer& out) {
    const ordered_json* value = find(key);
    if (value == nullptr) return;
    const auto* number = value->get_ptr<const ordered_json::number_unsigned_t*>();
    if (number == nullptr || *number > std::numeric_limits<Integer>::max())
      ok = false;
    else
      out = static_cast<Integer>(*number);
  }
  void real(const char* key, double& out, double when_null = kInfinity) {
    const ordered_json* value = find(key);
    if (value == nullptr) return;
    if (value->is_null())
      out = when_null;
    else if (value->is_number())
      out = value->get<double>();
    else
      ok = false;
  }
  void flag(const char* key, bool& out) {
    const ordered_json* value = find(key);
    if (value == nullptr) return;
    if (value->is_boolean())
      out = value->get<bool>();
    else
      ok = false;
  }
  void text(const char* key, std::string& out) {
    const ordered_json* value = find(key);
    const auto* text = value != nullptr ? value->get_ptr<const std::string*>() : nullptr;
    if (text != nullptr)
      out = *text;
    else
      ok = false;
  }
  void texts(const char* key, std::vector<std::string>& out) {
    const ordered_json* value = find(key);
    if (value == nullptr) return;
    ok = ok && value->is_array();
    out.clear();
    for (std::size_t i = 0; ok && i < value->size(); ++i) {
      const auto* text = (*value)[i].get_ptr<const std::string*>();
      ok = text != nullptr;
      if (ok) out.push_back(*text);
    }
  }
  void vector(const char* key, Vec3& out) {
    const ordered_json* value = find(key);
    if (value == nullptr) return;
    Members in{*value};
    in.real("x", out.x());
    in.real("y", out.y());
    in.real("z", out.z());
    ok = ok && in.ok;
  }
  void interval(const char* key, Interval& out) {
    const ordered_json* value = find(key);
    if (value == nullptr) return;
    Members in{*value};
    in.real("lo", out.lo, -kInfinity);
    in.real("hi", out.hi, kInfinity);
    ok = ok && in.ok;
  }
  template <class Enum>
  void name(const char* key, Enum& out) {
    std::string word;
    text(key, word);
    for (std::uint8_t i = 0; ok && name_of(static_cast<Enum>(i)) != "?"; ++i)
      if (name_of(static_cast<Enum>(i)) == word) {
        out = static_cast<Enum>(i);
        return;
      }
    ok = false;
  }
};

ordered_json parse(std::string_view text) { return ordered_json::parse(text, nullptr, false); }

// The schema that an encoder's own output asks for, so that the two cannot drift apart.
ordered_json schema_of(const ordered_json& example) {
  if (example.is_object()) {
    ordered_json properties = ordered_json::object();
    for (const auto& [key, value] : example.items()) properties[key] = schema_of(value);
    return {{"type", "object"}, {"properties", properties}};
  }
  if (example.is_array()) return {{"type", "array"}};
  if (example.is_string()) return {{"type", "string"}};
  if (example.is_boolean()) return {{"type", "boolean"}};
  if (example.is_number_integer()) return {{"type", "integer"}};
  return {{"type", "number"}};
}
std::string titled_schema(const char* title, const ordered_json& example) {
  ordered_json schema = schema_of(example);
  schema["title"] = title;
  return dump(schema);
}

// Calls visit(name, count) for every counter.
template <class Visit>
void each_counter(const StepCounters& counters, const Visit& visit) {
  visit("increments_in", counters.increments.in);
  visit("increments_applied", counters.increments.out);
  for (std::size_t i = 1; i < kRefusalCount; ++i) {
    std::string name = "refused: " + std::string(name_of(static_cast<Refusal>(i)));
    visit(name.c_str(), counters.refused[i]);
  }
  visit("moves_in", counters.moves.in);
  visit("moves_out", counters.moves.out);
  visit("moves_below_rounding", counters.moves_below_rounding);
  visit("pairs_in", counters.pairs.in);
  visit("pairs_out", counters.pairs.out);
  visit("pairs_static", counters.pairs_static);
  visit("pairs_still", counters.pairs_still);
  visit("pairs_excluded", counters.pairs_excluded);
  visit("pairs_boxes_apart", counters.pairs_boxes_apart);
  visit("pairs_budget", counters.pairs_budget);
  visit("contacts_in", counters.contacts.in);
  visit("contacts_out", counters.contacts.out);
  visit("contacts_clear", counters.contacts_clear);
  visit("contacts_undecided", counters.contacts_undecided);
  visit("first_contact_queries", counters.first_contact_queries);
  visit("distance_queries", counters.distance_queries);
  visit("depth_queries", counters.depth_queries);
  visit("event_time_queries", counters.event_time_queries);
  visit("event_times_at_latest", counters.event_times_at_latest);
  visit("judged_with_bands", counters.judged_with_bands);
  visit("judged_plain", counters.judged_plain);
  visit("regions_decided_early", counters.regions_decided_early);
  visit("regions_refined", counters.regions_refined);
  visit("verdicts_in", counters.verdicts.in);
  visit("verdicts_out", counters.verdicts.out);
  visit("verdicts_fake", counters.verdicts_by_class[1]);
  visit("verdicts_potential", counters.verdicts_by_class[2]);
  visit("verdicts_real", counters.verdicts_by_class[3]);
  visit("stopped_parts", counters.stopped_parts);
  visit("rounds", counters.rounds);
  visit("slid_parts", counters.slid_parts);
  visit("slide_legs", counters.slide_legs);
  visit("slide_holds", counters.slide_holds);
  visit("slides_cut_short", counters.slides_cut_short);
  visit("box_tests", counters.box_tests);
  visit("triangle_tests", counters.triangle_tests);
  visit("depth_evaluations", counters.depth_evaluations);
  visit("parts_without_inside", counters.parts_without_inside);
  visit("pairs_waiting", counters.pairs_waiting);
  visit("pairs_held_again", counters.pairs_held_again);
  visit("pushes_cut", counters.pushes_cut);
  visit("not_examined", counters.not_examined);
}

ordered_json json_of(const Gap& gap) {
  return {{"first_tick", gap.first_tick},
          {"last_tick", gap.last_tick},
          {"ticks", gap.ticks},
          {"reason", gap.reason}};
}

}  // namespace

std::string encode(const ClashEvent& event) { return dump(json_of(event)); }

bool decode(std::string_view text, ClashEvent& event) {
  const ordered_json object = parse(text);
  Members in{object};
  Verdict& v = event.verdict;
  in.integer("tick", event.tick);
  in.integer("seq", event.seq);
  in.name("kind", event.kind);
  in.integer("clash", event.clash.value);
  in.integer("part_a", event.part_a.value);
  in.integer("part_b", event.part_b.value);
  in.integer("user", event.user.value);
  in.name("class", v.collision_class);
  in.interval("delta_mm", v.delta_mm);
  in.interval("gpd_mm", v.gpd_mm);
  in.real("fake_below_mm", v.fake_below_mm);
  in.real("real_above_mm", v.real_above_mm);
  in.real("margin_mm", v.margin_mm);
  in.real("probability", v.probability, kProbabilityUnknown);
  in.real("travel_mm", v.travel_mm);
  in.real("normal_travel_mm", v.normal_travel_mm);
  in.vector("point_W", v.point_W);
  in.vector("normal_W", v.normal_W);
  in.real("area_mm2", v.area_mm2);
  in.flag("has_witness", v.has_witness);
  in.vector("witness_W", v.witness_W);
  in.vector("separation_translation_mm", v.separation_translation_mm);
  in.vector("separation_rotation_rad", v.separation_rotation_rad);
  in.name("separation_way", v.separation_way);
  if (object.contains(
          "separation_about_W")) {  // older records: of A, about the centre of its sphere
    in.vector("separation_about_W", v.separation_about_W);
    in.flag("separation_of_b", v.separation_of_b);
    in.name("separation_path", v.separation_path);
    in.integer("separation_blocker", v.separation_blocker.value);
  }
  in.name("shape_a", v.shape_a);
  in.name("shape_b", v.shape_b);
  in.name("grade", v.grade);
  in.text("face_a", v.face_a);
  in.text("face_b", v.face_b);
  in.text("explanation", v.explanation);
  in.real("t_contact", event.t_contact);
  in.real("t_potential", event.t_potential, kNever);
  in.real("t_real", event.t_real, kNever);
  in.integer("begin_tick", event.begin_tick);
  in.name("worst_class", event.worst_class);
  in.interval("worst_delta_mm", event.worst_delta_mm);
  if (!in.ok || !object.contains("review")) return in.ok;  // format 1 has no reviews
  in.name("cause", event.cause);
  in.flag("approval_lost", event.approval_lost);
  Members review{object["review"]};
  review.name("status", event.review.status);
  review.text("comment", event.review.comment);
  review.integer("user", event.review.user.value);
  review.integer("tick", event.review.tick);
  return in.ok && review.ok;
}

std::string first_difference(const ClashEvent& logged, const ClashEvent& computed) {
  const ordered_json a = json_of(logged), b = json_of(computed);
  for (const auto& [key, value] : a.items())
    if (b[key] != value) return key + ": logged " + dump(value) + ", computed " + dump(b[key]);
  return {};
}

void CounterSums::add(const StepReport& report, std::int64_t step_ns) {
  step_ns_ += step_ns;
  longest_ns_ = std::max(longest_ns_, step_ns);
  if (ticks_++ == 0) first_tick_ = report.tick;
  last_tick_ = report.tick;
  events_ += report.events.size();
  accumulate(sums_, report.counters);
}

std::string CounterSums::encode() const {
  ordered_json object = {{"first_tick", first_tick_},
                         {"last_tick", last_tick_},
                         {"ticks", ticks_},
                         {"events", events_}};
  each_counter(sums_, [&](const char* name, std::uint64_t count) { object[name] = count; });
  const auto in_us = [](std::int64_t ns) { return 1e-3 * static_cast<double>(ns); };
  object["step_us"] = {{"sum", in_us(step_ns_)}, {"max", in_us(longest_ns_)}};
  return dump(object);
}

bool decode(std::string_view text, TickTimes& times) {
  const ordered_json object = parse(text);
  Members in{object};
  in.integer("first_tick", times.first_tick);
  in.integer("last_tick", times.last_tick);
  in.integer("ticks", times.ticks);
  if (!in.ok || !object.contains("step_us")) return false;
  const ordered_json& step = object["step_us"];
  Members of_step{step};
  of_step.real("sum", times.sum_us);
  of_step.real("max", times.max_us);
  return of_step.ok && times.ticks > 0 && times.max_us > 0.0 && times.sum_us >= times.max_us &&
         std::isfinite(times.sum_us);
}

std::string encode(const Gap& gap) { return dump(json_of(gap)); }

bool decode(std::string_view text, Gap& gap) {
  const ordered_json object = parse(text);
  Members in{object};
  in.integer("first_tick", gap.first_tick);
  in.integer("last_tick", gap.last_tick);
  in.integer("ticks", gap.ticks);
  in.text("reason", gap.reason);
  return in.ok;
}

std::string encode(const ImportReport& report) {
  return dump({{"file", report.file},
               {"format", report.format},
               {"raw_vertices", report.raw_vertices},
               {"points", report.points},
               {"raw_triangles", report.raw_triangles},
               {"triangles", report.triangles},
               {"degenerate_dropped", report.degenerate_dropped},
               {"duplicate_triangles", report.duplicate_triangles},
               {"points_and_lines_dropped", report.points_and_lines_dropped},
               {"boundary_edges", report.boundary_edges},
               {"non_manifold_edges", report.non_manifold_edges},
               {"misoriented_edges", report.misoriented_edges},
               {"components", report.components},
               {"volume_mm3", number(report.volume_mm3)},
               {"closed", report.closed},
               {"flipped", report.flipped},
               {"quantum_mm", number(report.quantum_mm)},
               {"notes", report.notes}});
}

bool decode(std::string_view text, ImportReport& report) {
  const ordered_json object = parse(text);
  Members in{object};
  in.text("file", report.file);
  in.text("format", report.format);
  in.integer("raw_vertices", report.raw_vertices);
  in.integer("points", report.points);
  in.integer("raw_triangles", report.raw_triangles);
  in.integer("triangles", report.triangles);
  in.integer("degenerate_dropped", report.degenerate_dropped);
  in.integer("duplicate_triangles", report.duplicate_triangles);
  in.integer("points_and_lines_dropped", report.points_and_lines_dropped);
  in.integer("boundary_edges", report.boundary_edges);
  in.integer("non_manifold_edges", report.non_manifold_edges);
  in.integer("misoriented_edges", report.misoriented_edges);
  in.integer("components", report.components);
  in.real("volume_mm3", report.volume_mm3);
  in.flag("closed", report.closed);
  in.flag("flipped", report.flipped);
  in.real("quantum_mm", report.quantum_mm);
  in.texts("notes", report.notes);
  return in.ok;
}

std::string clash_schema() { return titled_schema("mortise.Clash", json_of(ClashEvent{})); }
std::string statistics_schema() {
  return titled_schema("mortise.Statistics", parse(CounterSums{}.encode()));
}
std::string gap_schema() { return titled_schema("mortise.Gap", json_of(Gap{})); }

}  // namespace mortise::log_json
