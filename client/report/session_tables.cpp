#include "client/report/session_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "client/report/cells.h"
#include "common/base/check.h"
#include "common/io/scenario/scenario_file.h"
#include "common/messages/names.h"
#include "common/session/world/scene_edits.h"

namespace mortise {
namespace {

using Type = Table::Type;
using Columns = std::vector<Table::Column>;

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }
template <class Name>
Json word(Name value) {
  return std::string(name_of(value));
}

Columns columns(Type type, std::initializer_list<const char*> names) {
  Columns made;
  for (const char* name : names) made.push_back({name, type});
  return made;
}

void append(Columns& to, Columns more) { to.insert(to.end(), more.begin(), more.end()); }

using Faces = std::tuple<PartId, std::string, PartId, std::string>;
Faces faces_of(const SessionStatistics::ClashRow& clash) {
  return {clash.a, clash.worst.face_a, clash.b, clash.worst.face_b};
}

// Clashes of the same two faces.
struct Group {
  std::size_t id = 0, occurrences = 0;
};

// Everything of a log that is asked again and again.
class Session {
 public:
  Session(const SessionLog& log, const Scenario& scenario) : log_(log), scenario_(scenario) {
    for (const auto& part : scenario.parts) names_.parts.push_back(part.name);
    std::uint64_t next = 0;
    for (const TickRecord& record : log.ticks) {
      for (const Decision& decision : record.decisions) take_in(decision, record.tick);
      // Ticks without input are not in the log; they count for how long a clash lasts.
      for (; next != 0 && next < record.tick; ++next) {
        StepReport idle;
        idle.tick = next;
        statistics_.add(idle);
      }
      statistics_.add(record.report);
      for (const ClashEvent& event : record.report.events) take_in(event);
      for (const Increment& increment : record.increments) ++of_user_[increment.user].increments;
      for (const RefusedIncrement& refused : record.report.refused)
        ++of_user_[refused.user].refused;
      next = record.tick + 1;
    }
  }

  Table session() const {
    Table table{"session", "what was recorded", {{"key", Type::kText}, {"value", Type::kText}}, {}};
    const auto add = [&](const char* key, const std::string& value) {
      table.rows.push_back({key, value});
    };
    const auto first = log_.ticks.empty() ? TickRecord{} : log_.ticks.front();
    const auto last = log_.ticks.empty() ? TickRecord{} : log_.ticks.back();
    add("session", log_.session);
    add("scenario", log_.scenario_name);
    add("engine_version", log_.engine_version);
    add("build_fingerprint", log_.build_fingerprint);
    add("complete", log_.complete ? "yes" : "no: the log was not closed, its tail is missing");
    add("first_tick", std::to_string(first.tick));
    add("last_tick", std::to_string(last.tick));
    add("duration_s", std::to_string(static_cast<double>(last.time_ns - first.time_ns) * 1e-9));
    add("tick_rate_hz", std::to_string(scenario_.tick_rate_hz));
    add("end_s", std::to_string(static_cast<double>(last.tick) / scenario_.tick_rate_hz));
    add("ticks_with_input", std::to_string(log_.ticks.size()));
    for (const LogGap& gap : log_.gaps)
      add("gap", "after tick " + std::to_string(gap.after_tick) + " until tick " +
                     std::to_string(gap.until_tick) + ": " + gap.reason);
    for (const std::string& note : log_.notes) add("note", note);
    return table;
  }

  Table parts() const {
    Table table{"parts", "every part of the scenario", columns(Type::kText, {"part", "mesh"}), {}};
    table.columns.push_back({"moving", Type::kInteger});
    for (std::size_t i = 0; i < scenario_.parts.size(); ++i)
      table.rows.push_back({scenario_.parts[i].name,
                            mesh_of(PartId{static_cast<std::uint32_t>(i + 1)}),
                            scenario_.parts[i].moving ? 1 : 0});
    return table;
  }

  Table users() const {
    Table table{"users", "who took part", columns(Type::kText, {"user", "role"}), {}};
    append(table.columns, columns(Type::kInteger, {"joined_tick", "increments", "refused"}));
    for (const auto& [id, user] : of_user_)
      table.rows.push_back(
          {names_.user(id), word(user.role), user.joined_tick, user.increments, user.refused});
    return table;
  }

  Table exclusions() const {
    Table table{"exclusions",
                "pairs that the scenario excludes, and why; exclusions by users are decisions",
                columns(Type::kText, {"part_a", "part_b", "reason"}),
                {}};
    for (const auto& rule : scenario_.exclusions)
      table.rows.push_back({rule.part_a, rule.part_b, rule.reason});
    return table;
  }

  Table clashes() const;
  std::vector<Json> clash_row(ClashId id, const SessionStatistics::ClashRow& clash,
                              const Group& group) const;
  Table events() const;
  Table tick_times() const;
  Table decisions() const;

  Table sums(const char* name, const char* about, const char* thing,
             const std::vector<std::pair<std::string, SessionStatistics::Row>>& rows) const {
    Table table{name, about, {{thing, Type::kText}}, {}};
    append(table.columns,
           columns(Type::kInteger, {"real", "potential", "fake", "real_ticks", "potential_ticks",
                                    "fake_ticks", "first_tick", "last_tick", "worst_tick"}));
    append(table.columns, columns(Type::kText, {"worst_class"}));
    append(table.columns, columns(Type::kNumber, {"worst_overlap_mm", "worst_margin_mm"}));
    for (const auto& [key, row] : rows)
      table.rows.push_back({key, row.clashes[3], row.clashes[2], row.clashes[1], row.ticks[3],
                            row.ticks[2], row.ticks[1], row.first_tick, row.last_tick,
                            row.worst_tick, word(row.worst.collision_class),
                            number(row.worst.delta_mm.lo), number(row.worst.margin_mm)});
    worst_first(table);
    return table;
  }

  template <class Map, class Name>
  static std::vector<std::pair<std::string, SessionStatistics::Row>> named(const Map& map,
                                                                           Name&& name) {
    std::vector<std::pair<std::string, SessionStatistics::Row>> rows;
    for (const auto& [key, row] : map) rows.emplace_back(name(key), row);
    return rows;
  }

  const SessionStatistics& statistics() const { return statistics_; }
  const SessionNames& names() const { return names_; }

 private:
  struct OfUser {
    Role role = Role::kUnknown;
    std::uint64_t joined_tick = 0, increments = 0, refused = 0;
  };
  struct OfClash {
    ClashEvent worst, last;
    bool approval_lost = false;
  };

  void take_in(const Decision& decision, std::uint64_t tick) {
    if (decision.kind == Decision::Kind::kAddPart && decision.part && decision.details.edit &&
        decision.part.value <= names_.parts.size() + kMostSceneParts) {
      names_.parts.resize(std::max<std::size_t>(names_.parts.size(), decision.part.value));
      names_.parts[decision.part.value - 1] = decision.details.edit->name;
    }
    if (decision.kind != Decision::Kind::kJoin || !decision.user) return;
    names_.users.resize(std::max<std::size_t>(names_.users.size(), decision.user.value));
    // An id that somebody took over was first the one's and then the other's: so are its sums.
    std::string& name = names_.users[decision.user.value - 1];
    if (takes_over_id(decision) && !name.empty())
      name += ", then " + decision.user_name;
    else if (!name.ends_with(", then " + decision.user_name))
      name = decision.user_name;
    OfUser& user = of_user_[decision.user];
    user.role = decision.role;
    if (user.joined_tick == 0) user.joined_tick = tick;
  }

  void take_in(const ClashEvent& event) {
    const auto [at, fresh] = of_clash_.try_emplace(event.clash, OfClash{event, event, false});
    OfClash& clash = at->second;
    clash.last = event;
    clash.approval_lost |= event.approval_lost;
    const auto rank = [](const ClashEvent& e) {
      return std::pair(static_cast<int>(e.verdict.collision_class), e.verdict.delta_mm.lo);
    };
    if (!fresh && event.kind != ClashEvent::Kind::kReview && rank(event) > rank(clash.worst))
      clash.worst = event;
  }

  std::string mesh_of(PartId part) const {
    const std::size_t index = part.value - 1;
    return index < log_.mesh_of_part.size() ? log_.mesh_of_part[index] : "";
  }

  const SessionLog& log_;
  const Scenario& scenario_;
  SessionNames names_;
  SessionStatistics statistics_;
  std::map<UserId, OfUser> of_user_;
  std::map<ClashId, OfClash> of_clash_;
};

void add_vector(std::vector<Json>& row, const Vec3& v) {
  for (int i = 0; i < 3; ++i) row.push_back(number(v[i]));
}

// The faces of two parts that met.
// How far from another class, in widths of what is undecided between fake and real; NaN: none is.
double severity_of(const Verdict& v) {
  const double undecided_mm = v.real_above_mm - v.fake_below_mm;
  return undecided_mm > 0.0 ? v.margin_mm / undecided_mm : std::nan("");
}

Columns clash_columns() {
  Columns all;
  append(all, columns(Type::kInteger, {"clash"}));
  append(all, columns(Type::kText, {"class", "status", "status_by", "comment", "part_a", "face_a",
                                    "part_b", "face_b", "user"}));
  append(all, columns(Type::kInteger,
                      {"begin_tick", "end_tick", "worst_tick", "real_ticks", "potential_ticks",
                       "fake_ticks", "approval_lost", "status_tick", "occurrences", "group_id"}));
  append(all, columns(Type::kNumber, {"begin_s",
                                      "duration_s",
                                      "contact_in_tick",
                                      "overlap_lo_mm",
                                      "overlap_hi_mm",
                                      "gpd_lo_mm",
                                      "gpd_hi_mm",
                                      "fake_below_mm",
                                      "real_above_mm",
                                      "margin_mm",
                                      "severity",
                                      "real_until_widened_mm",
                                      "fake_until_widened_mm",
                                      "probability",
                                      "travel_mm",
                                      "normal_travel_mm",
                                      "area_mm2",
                                      "x_mm",
                                      "y_mm",
                                      "z_mm",
                                      "normal_x",
                                      "normal_y",
                                      "normal_z",
                                      "way_out_x_mm",
                                      "way_out_y_mm",
                                      "way_out_z_mm",
                                      "way_out_turn_x_rad",
                                      "way_out_turn_y_rad",
                                      "way_out_turn_z_rad",
                                      "way_out_about_x_mm",
                                      "way_out_about_y_mm",
                                      "way_out_about_z_mm"}));
  append(all, columns(Type::kText, {"way_out_moves", "way_out", "shape_a", "shape_b", "mesh_error",
                                    "mesh_a", "mesh_b", "explanation"}));
  return all;
}

Table Session::clashes() const {
  Table table{"clashes", "every clash, by its worst moment", clash_columns(), {}};
  std::map<Faces, Group> groups;
  for (const auto& [id, clash] : statistics_.clashes()) {
    Group& group = groups[faces_of(clash)];
    if (group.occurrences++ == 0) group.id = groups.size();
  }
  for (const auto& [id, clash] : statistics_.clashes())
    table.rows.push_back(clash_row(id, clash, groups.at(faces_of(clash))));
  return table;
}

std::vector<Json> Session::clash_row(ClashId id, const SessionStatistics::ClashRow& clash,
                                     const Group& group) const {
  const double rate = scenario_.tick_rate_hz;
  const std::uint64_t last_tick = log_.ticks.empty() ? 0 : log_.ticks.back().tick;
  const OfClash& of = of_clash_.at(id);
  const Verdict& v = clash.worst;
  const Review& review = of.last.review;
  const std::uint64_t end = clash.end_tick != 0 ? clash.end_tick : last_tick;
  std::vector<Json> row{id.value,
                        word(clash.worst_class),
                        word(review.status),
                        review.user ? names_.user(review.user) : "",
                        review.comment,
                        names_.part(clash.a),
                        v.face_a,
                        names_.part(clash.b),
                        v.face_b,
                        clash.user ? names_.user(clash.user) : "",
                        clash.begin_tick,
                        clash.end_tick == 0 ? Json(nullptr) : Json(clash.end_tick),
                        of.worst.tick,
                        clash.ticks[3],
                        clash.ticks[2],
                        clash.ticks[1],
                        of.approval_lost ? 1 : 0,
                        review.tick == 0 ? Json(nullptr) : Json(review.tick),
                        group.occurrences,
                        group.id,
                        static_cast<double>(clash.begin_tick) / rate,
                        static_cast<double>(end - clash.begin_tick) / rate,
                        number(of.worst.t_contact)};
  for (const double x :
       {v.delta_mm.lo, v.delta_mm.hi, v.gpd_mm.lo, v.gpd_mm.hi, v.fake_below_mm, v.real_above_mm,
        v.margin_mm, severity_of(v), 0.5 * (v.delta_mm.lo - v.real_above_mm),
        0.5 * (v.fake_below_mm - v.delta_mm.hi), has_probability(v) ? v.probability : std::nan(""),
        v.travel_mm, v.normal_travel_mm, v.area_mm2})
    row.push_back(number(x));
  add_vector(row, v.point_W);
  add_vector(row, v.normal_W);
  add_vector(row, v.separation_translation_mm);
  add_vector(row, v.separation_rotation_rad);
  add_vector(row, v.separation_about_W);
  for (const Json& text : {Json(names_.part(v.separation_of_b ? clash.b : clash.a)),
                           word(v.separation_way), word(v.shape_a), word(v.shape_b), word(v.grade),
                           Json(mesh_of(clash.a)), Json(mesh_of(clash.b)), Json(v.explanation)})
    row.push_back(text);
  return row;
}

Table Session::events() const {
  Table table{"events", "events of clashes, in order", {}, {}};
  append(table.columns, columns(Type::kInteger, {"seq", "tick", "clash"}));
  append(table.columns,
         columns(Type::kText, {"kind", "class", "part_a", "part_b", "user", "cause", "status"}));
  append(table.columns,
         columns(Type::kNumber, {"overlap_lo_mm", "overlap_hi_mm", "margin_mm", "contact_in_tick",
                                 "potential_in_tick", "real_in_tick", "fake_below_mm",
                                 "real_above_mm", "time_s"}));
  for (const TickRecord& record : log_.ticks)
    for (const ClashEvent& e : record.report.events)
      table.rows.push_back(
          {e.seq, e.tick, e.clash.value, word(e.kind), word(e.verdict.collision_class),
           names_.part(e.part_a), names_.part(e.part_b), e.user ? names_.user(e.user) : "",
           e.cause == Decision::Kind::kUnknown ? Json("motion") : word(e.cause),
           word(e.review.status), number(e.verdict.delta_mm.lo), number(e.verdict.delta_mm.hi),
           number(e.verdict.margin_mm), number(e.t_contact), number(e.t_potential),
           number(e.t_real), number(e.verdict.fake_below_mm), number(e.verdict.real_above_mm),
           static_cast<double>(e.tick) / scenario_.tick_rate_hz});
  return table;
}

Table Session::tick_times() const {
  Table table{"tick_times", "what the engine took for the ticks of about a second", {}, {}};
  append(table.columns, columns(Type::kInteger, {"first_tick", "last_tick", "ticks"}));
  append(table.columns, columns(Type::kNumber, {"begin_s", "end_s", "mean_us", "max_us"}));
  for (const log_json::TickTimes& times : log_.times)
    table.rows.push_back({times.first_tick, times.last_tick, times.ticks,
                          static_cast<double>(times.first_tick) / scenario_.tick_rate_hz,
                          static_cast<double>(times.last_tick) / scenario_.tick_rate_hz,
                          number(times.sum_us / static_cast<double>(times.ticks)),
                          number(times.max_us)});
  return table;
}

Table Session::decisions() const {
  Table table{"decisions", "decisions of users and the server", {}, {}};
  append(table.columns, columns(Type::kInteger, {"tick"}));
  append(table.columns, columns(Type::kText, {"decision", "user", "part", "feature", "other_part",
                                              "other_feature", "other_user", "text"}));
  const auto part = [&](PartId id) { return id ? names_.part(id) : std::string(); };
  const auto user = [&](UserId id) { return id ? names_.user(id) : std::string(); };
  for (const TickRecord& record : log_.ticks)
    for (const Decision& d : record.decisions)
      table.rows.push_back({record.tick, word(d.kind), user(d.user), part(d.part),
                            d.details.feature, part(d.details.other_part), d.details.other_feature,
                            user(d.details.other_user), d.details.text});
  return table;
}

// Leaves of the stages, by the path to them.
void flatten(const Json& json, const std::string& path, Table& table) {
  for (const auto& [key, value] : json.items()) {
    const std::string here = path.empty() ? key : path + "." + key;
    if (value.is_structured())
      flatten(value, here, table);
    else
      table.rows.push_back({here, value});
  }
}

Table coverage_table(const SessionLog& log, const std::optional<StepCounters>& counters) {
  Table table{"coverage",
              "what was examined, and what was skipped for which reason",
              {{"what", Type::kText}, {"count", Type::kNumber}},
              {}};
  if (counters)
    flatten(json_of(*counters), "", table);
  else
    for (const auto& [name, count] : log.counted) table.rows.push_back({name, count});
  return table;
}

}  // namespace

Result<std::vector<Table>> tables_of(const SessionLog& log,
                                     const std::optional<StepCounters>& coverage) {
  const auto reading = scenario_of(log);
  if (!reading) return reading.error();
  const Session session(log, reading->scenario);
  const SessionNames& names = session.names();
  const SessionStatistics& sums = session.statistics();
  std::vector<Table> tables{session.session(),    session.parts(),     session.users(),
                            session.exclusions(), session.clashes(),   session.events(),
                            session.decisions(),  session.tick_times()};
  tables.push_back(session.sums("by_pair", "clashes by pair of parts, by worst class", "pair",
                                Session::named(sums.by_pair(), [&](const auto& key) {
                                  return names.pair(key.first, key.second);
                                })));
  tables.push_back(
      session.sums("by_part", "clashes by part", "part",
                   Session::named(sums.by_part(), [&](PartId id) { return names.part(id); })));
  tables.push_back(
      session.sums("by_user", "clashes by the user who caused them", "user",
                   Session::named(sums.by_user(), [&](UserId id) { return names.user(id); })));
  tables.push_back(coverage_table(log, coverage));
  for (const Table& table : tables)
    for (const auto& row : table.rows)
      MORTISE_CHECK(row.size() == table.columns.size(), table.name.c_str());
  return tables;
}

const Table& table_named(const std::vector<Table>& tables, std::string_view name) {
  const auto found = std::find_if(tables.begin(), tables.end(),
                                  [&](const Table& table) { return table.name == name; });
  MORTISE_CHECK(found != tables.end(), "there is such a table");
  return *found;
}

Table& table_named(std::vector<Table>& tables, std::string_view name) {
  return const_cast<Table&>(table_named(std::as_const(tables), name));
}

}  // namespace mortise
