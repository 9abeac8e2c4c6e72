#include "client/report/export_html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "client/report/cells.h"
#include "client/report/html_page.h"
#include "client/report/html_sections.h"
#include "client/report/pair_groups.h"
#include "client/report/plots.h"
#include "common/evaluation/threshold_text.h"
#include "common/messages/length_text.h"

namespace mortise {
namespace {

constexpr const char* kClasses[] = {"real", "potential", "fake"};
constexpr const char* kStatuses[] = {"new", "active", "reviewed", "approved", "resolved"};

// Rows of the timeline and of long tables; the rest is counted, and is in the other exports.
constexpr std::size_t kMostBars = 200, kMostRows = 2000;

bool knows_fake(const Cells& clash) {
  return states_fake(clash.raw("explanation"), clash.number("fake_below_mm"));
}
bool knows_real(const Cells& clash) {
  return states_real(clash.raw("explanation"), clash.number("real_above_mm"));
}

// Overlap against the thresholds that are known: a bar over a scale that ends beyond the largest.
std::string bar(const Cells& clash) {
  const double overlap = clash.number("overlap_lo_mm");
  std::string marks, label = "overlap " + clash.length("overlap_lo_mm");
  double most = std::max(overlap, 1e-6);
  std::vector<double> thresholds;
  if (knows_fake(clash)) {
    thresholds.push_back(clash.number("fake_below_mm"));
    label += ", " + fake_text(thresholds.back());
  }
  if (knows_real(clash)) {
    thresholds.push_back(clash.number("real_above_mm"));
    label += ", " + real_text(thresholds.back());
  }
  for (const double mm : thresholds) most = std::max(most, mm);
  most *= 1.15;
  if (!std::isfinite(most)) return "";
  const auto x = [&](double mm) { return 120.0 * std::clamp(mm / most, 0.0, 1.0); };
  for (const double mm : thresholds) marks += fmt::format("M{:.1f} 1v16", x(mm));
  return fmt::format(
      "<svg viewBox=\"0 0 124 18\" role=\"img\" aria-label=\"{}\"><rect x=\"0\" y=\"5\" "
      "width=\"{:.1f}\" height=\"8\" fill=\"currentColor\" opacity=\".55\"/><path d=\"{}\" "
      "stroke=\"currentColor\" stroke-dasharray=\"2 2\"/></svg>",
      label, x(overlap), marks);
}

// The number of a clash leads to its picture, where there is one.
std::string number_of(const Cells& clash, const Pictures& pictures) {
  const std::string number = clash.text("clash");
  if (!pictures.of_clash.contains(clash["clash"].get<std::uint64_t>())) return number;
  return fmt::format("<a href=\"#clash-{0}\">{0}</a>", number);
}

std::string known(const Cells& clash, const char* name) {
  const std::string text = clash.text(name);
  return text.empty() ? "–" : text;
}

// Of two columns, "..._lo_mm" and "..._hi_mm".
std::string range(const Cells& clash, const std::string& name) {
  if (clash[name + "_lo_mm"].is_null()) return "";
  return range_text({clash.number(name + "_lo_mm"), clash.number(name + "_hi_mm")});
}

// What few ask for, and the other places of the pair: folded, but open on paper.
std::string details(const Table& clashes, const PairGroup& group) {
  const Cells clash(clashes, clashes.rows[group.lead]);
  std::string html = "<details><summary>numbers</summary><dl>";
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) html += fmt::format("<dt>{}</dt><dd>{}</dd>", name, value);
  };
  add("from, for",
      fmt::format("{:.2f} s, {:.2f} s", clash.number("begin_s"), clash.number("duration_s")));
  add("by", clash.text("user"));
  add("held by", known(clash, "holder_a") + ", " + known(clash, "holder_b"));
  add("fit",
      clash.text("fit") +
          (range(clash, "clearance").empty() ? "" : ", clearance " + range(clash, "clearance")));
  add("mesh error", range(clash, "eps_a").empty() && range(clash, "eps_b").empty()
                        ? ""
                        : range(clash, "eps_a") + " and " + range(clash, "eps_b"));
  if (knows_real(clash))
    add("real until zones are wider by", clash.length("real_until_widened_mm"));
  if (knows_fake(clash))
    add("fake until zones are wider by", clash.length("fake_until_widened_mm"));
  if (clash.number("gpd_hi_mm") > 0.0) add("generalized penetration depth", range(clash, "gpd"));
  for (const std::size_t row : group.others) {
    const Cells other(clashes, clashes.rows[row]);
    add(fmt::format("also #{}", other.text("clash")).c_str(),
        fmt::format("<span class=\"{0}\">{0}</span>, {1:.2f} s: {2}", other.text("class"),
                    other.number("begin_s"), other.text("explanation")));
  }
  return html + "</dl></details>";
}

std::string clash_row(const Table& clashes, const PairGroup& group, const Pictures& pictures) {
  const Cells clash(clashes, clashes.rows[group.lead]);
  const std::string klass = clash.text("class"), also = also_text(group);
  std::string row = fmt::format("<tr data-class=\"{}\" data-status=\"{}\"><td class=\"n\">{}</td>",
                                klass, clash.text("status"), number_of(clash, pictures));
  row += "<td>" + letter_of(klass) + "</td>";
  row += fmt::format("<td>{}{}<br>{}{}{}</td>", clash.text("part_a"),
                     clash.text("face_a").empty() ? "" : " · " + clash.text("face_a"),
                     clash.text("part_b"),
                     clash.text("face_b").empty() ? "" : " · " + clash.text("face_b"),
                     also.empty() ? "" : "<br><b>" + also + "</b>");
  row += fmt::format("<td class=\"n {}\">{}<br>{}</td>", klass, clash.length("overlap_lo_mm"),
                     bar(clash));
  row += fmt::format("<td class=\"n\">{}<br>{}</td><td class=\"n\">{}</td>",
                     knows_fake(clash) ? clash.length("fake_below_mm") : "–",
                     knows_real(clash) ? clash.length("real_above_mm") : "–",
                     clash.length("margin_mm"));
  row += fmt::format("<td>{}{}<br>{}</td>", clash.text("status"),
                     clash.text("status_by").empty() ? "" : " by " + clash.text("status_by"),
                     clash.text("comment"));
  return row +
         fmt::format("<td>{}{}</td></tr>\n", clash.text("explanation"), details(clashes, group));
}

std::string filters() {
  std::string html = "<div class=\"filters\" hidden>";
  for (const char* klass : kClasses)
    html +=
        fmt::format("<label><input type=\"checkbox\" value=\"{0}\" checked> {0}</label>", klass);
  html += "<span class=\"dim\">|</span>";
  for (const char* status : kStatuses)
    html +=
        fmt::format("<label><input type=\"checkbox\" value=\"{0}\" checked> {0}</label>", status);
  return html +
         "<label>words <input id=\"search\" type=\"search\"></label> <span id=\"shown\" "
         "class=\"dim\" role=\"status\"></span></div>\n";
}

std::string clash_section(const SessionReport& report) {
  const Table& table = table_named(report.tables, "clashes");
  const std::vector<PairGroup> groups = pair_groups(table);
  std::string html =
      "<h2>Clashes</h2>\n<p class=\"dim\">One row a pair of parts, the worst first: its worst "
      "place "
      "at its worst moment; what else there was of it is counted, and folded below its numbers. "
      "Overlap of the meshes against two thresholds: fake up to the first, real above the second, "
      "potential between; a dash where the class was decided before the threshold was.</p>\n" +
      filters() +
      "<div class=\"wide\"><table id=\"clashes\"><colgroup><col><col><col><col><col><col><col>"
      "<col></colgroup><thead><tr><th "
      "class=\"n\">#</th><th>class</th><th>parts, faces</th><th class=\"n\">overlap</th><th "
      "class=\"n\">fake up to, real above</th><th class=\"n\">margin</th><th>review</th>"
      "<th>why</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < std::min(groups.size(), kMostRows); ++i)
    html += clash_row(table, groups[i], report.pictures);
  html += "</tbody></table></div>\n";
  if (groups.size() > kMostRows)
    html += fmt::format("<p>{} more pairs are in the CSV, JSON and SQLite exports.</p>\n",
                        groups.size() - kMostRows);
  return html;
}

std::string timeline(const Table& table, double seconds) {
  if (table.rows.empty() || !(seconds > 0.0)) return "";
  const std::vector<PairGroup> groups = pair_groups(table);
  const std::size_t bars = std::min(groups.size(), kMostBars);
  const double height = 16.0 * static_cast<double>(bars) + 24.0;
  std::string html = fmt::format(
      "<h2>Timeline</h2>\n<div class=\"wide\"><svg width=\"1100\" height=\"{0}\" viewBox=\"0 0 "
      "1100 {0}\" role=\"img\" "
      "aria-label=\"When each clash lasted; the same is in the table of clashes\">\n",
      height);
  const auto x = [&](double s) { return 300.0 + 780.0 * std::clamp(s / seconds, 0.0, 1.0); };
  for (int i = 0; i <= 4; ++i)
    html += fmt::format(
        "<path d=\"M{0:.1f} 14V{1}\" stroke=\"currentColor\" opacity=\".15\"/><text x=\"{0:.1f}\" "
        "y=\"10\" text-anchor=\"{3}\">{2:.1f} s</text>\n",
        x(seconds * i / 4), height, seconds * i / 4, i == 4 ? "end" : "middle");
  for (std::size_t i = 0; i < bars; ++i) {
    const Cells lead(table, table.rows[groups[i].lead]);
    const double y = 18.0 + 16.0 * static_cast<double>(i);
    const std::string klass = lead.text("class");
    html += fmt::format("<g class=\"{}\"><text x=\"0\" y=\"{:.1f}\">{} {} × {}</text></g>\n", klass,
                        y + 9.0, static_cast<char>(klass.empty() ? '?' : klass[0] - 32),
                        lead.text("part_a"), lead.text("part_b"));
    std::vector<std::size_t> rows(groups[i].others.rbegin(), groups[i].others.rend());
    rows.push_back(groups[i].lead);  // the worst on top
    for (const std::size_t row : rows) {
      const Cells clash(table, table.rows[row]);
      const double from = x(clash.number("begin_s"));
      const double to = x(clash.number("begin_s") + clash.number("duration_s"));
      html += fmt::format(
          "<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"10\" "
          "fill=\"currentColor\"/>\n",
          clash.text("class"), from, y, std::max(2.0, to - from));
    }
  }
  html += "</svg></div>\n";
  if (bars < groups.size())
    html += fmt::format("<p>The worst {} of {} pairs.</p>\n", bars, groups.size());
  return html;
}

// Pairs of parts, by their worst place.
std::string cards(const Table& clashes) {
  const std::vector<PairGroup> groups = pair_groups(clashes);
  const auto count = [&](const char* column, std::string_view value) {
    return std::count_if(groups.begin(), groups.end(), [&](const PairGroup& group) {
      return Cells(clashes, clashes.rows[group.lead]).text(column) == value;
    });
  };
  const auto still_open = std::count_if(groups.begin(), groups.end(), [&](const PairGroup& group) {
    const auto is_open = [&](std::size_t row) {
      return Cells(clashes, clashes.rows[row])["end_tick"].is_null();
    };
    return is_open(group.lead) || std::any_of(group.others.begin(), group.others.end(), is_open);
  });
  std::string html = "<div class=\"cards\">";
  for (const char* klass : kClasses)
    html += fmt::format("<div class=\"card\"><b>{}</b>{}</div>", count("class", klass),
                        letter_of(klass));
  html += fmt::format("<div class=\"card\"><b>{}</b>still open</div>", still_open);
  html += fmt::format("<div class=\"card\"><b>{}</b>not reviewed</div>", count("status", "new"));
  return html + "</div>\n";
}

std::string session_value(const std::vector<Table>& tables, std::string_view key) {
  for (const std::vector<Json>& row : table_named(tables, "session").rows)
    if (row[0] == key) return row[1].get<std::string>();
  return "";
}

}  // namespace

std::string html_of(const SessionReport& report) {
  const std::vector<Table>& tables = report.tables;
  const Table& clashes = table_named(tables, "clashes");
  const std::string duration =
      fmt::format("{:.1f}", std::atof(session_value(tables, "duration_s").c_str()));
  std::string html = page_begin("Clashes of " + report.session) +
                     fmt::format("<p class=\"dim\">Session {}, scenario {}, {} s; engine {}.</p>\n",
                                 escaped(session_value(tables, "session")),
                                 escaped(session_value(tables, "scenario")), duration,
                                 escaped(session_value(tables, "engine_version")));
  if (const std::string complete = session_value(tables, "complete"); complete != "yes")
    html += "<p><b>Incomplete</b>: " + escaped(complete) + "</p>\n";
  html += cards(clashes);
  html += clash_section(report);
  html += timeline(clashes, std::atof(session_value(tables, "end_s").c_str()));
  html += depth_section(report);
  html += picture_section(report);
  html += part_section(report);
  html += plain_table(table_named(tables, "by_part"), "By part");
  html += plain_table(table_named(tables, "by_pair"), "By pair");
  html += plain_table(table_named(tables, "by_user"), "By user");
  html += tolerance_section(report);
  html += plain_table(table_named(tables, "users"), "Users");
  html += plain_table(table_named(tables, "exclusions"), "Exclusions");
  html += plain_table(table_named(tables, "decisions"), "Decisions");
  html += plain_table(table_named(tables, "coverage"), "Coverage");
  html += tick_time_section(report);
  html += limits_section(report);
  html += plain_table(table_named(tables, "session"), "Session");
  return html + std::string(filter_script()) + page_end();
}

}  // namespace mortise
