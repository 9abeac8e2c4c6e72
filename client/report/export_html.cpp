#include "client/report/export_html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "client/report/cells.h"
#include "client/report/html_page.h"
#include "client/report/html_sections.h"

namespace mortise {
namespace {

constexpr const char* kClasses[] = {"real", "potential", "fake"};
constexpr const char* kStatuses[] = {"new", "active", "reviewed", "approved", "resolved"};

// Rows of the timeline and of long tables; the rest is counted, and is in the other exports.
constexpr std::size_t kMostBars = 200, kMostRows = 2000;

// Overlap against both thresholds: a bar over a scale that ends beyond the larger of them.
std::string bar(const Cells& clash) {
  const double overlap = clash.number("overlap_lo_mm"), fake = clash.number("fake_below_mm"),
               real = clash.number("real_above_mm");
  const double most = 1.15 * std::max({overlap, fake, real, 1e-6});
  if (!std::isfinite(most)) return "";
  const auto x = [&](double mm) { return 120.0 * std::clamp(mm / most, 0.0, 1.0); };
  return fmt::format(
      "<svg width=\"124\" height=\"18\" role=\"img\" aria-label=\"overlap {:.1f}, fake up to "
      "{:.1f}, real above {:.1f} µm\"><rect x=\"0\" y=\"5\" width=\"{:.1f}\" height=\"8\" "
      "fill=\"currentColor\" opacity=\".55\"/><path d=\"M{:.1f} 1v16M{:.1f} 1v16\" "
      "stroke=\"currentColor\" stroke-dasharray=\"2 2\"/></svg>",
      1e3 * overlap, 1e3 * fake, 1e3 * real, x(overlap), x(fake), x(real));
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
  return clash.micrometres(name + "_lo_mm") + " … " + clash.micrometres(name + "_hi_mm");
}

std::string clash_row(const Cells& clash, const Pictures& pictures) {
  const std::string klass = clash.text("class");
  std::string row = fmt::format("<tr data-class=\"{}\" data-status=\"{}\"><td class=\"n\">{}</td>",
                                klass, clash.text("status"), number_of(clash, pictures));
  row += "<td>" + letter_of(klass) + "</td>";
  row += fmt::format("<td>{}{}<br>{}{}</td>", clash.text("part_a"),
                     clash.text("face_a").empty() ? "" : " · " + clash.text("face_a"),
                     clash.text("part_b"),
                     clash.text("face_b").empty() ? "" : " · " + clash.text("face_b"));
  row += fmt::format("<td class=\"n\">{:.2f} s<br>{:.2f} s</td>", clash.number("begin_s"),
                     clash.number("duration_s"));
  row += fmt::format("<td class=\"n {}\">{} µm<br>{}</td><td class=\"n\">{}<br>{}</td>", klass,
                     clash.micrometres("overlap_lo_mm"), bar(clash),
                     clash.micrometres("fake_below_mm"), clash.micrometres("real_above_mm"));
  row += fmt::format("<td class=\"n\">{}</td>", clash.micrometres("margin_mm"));
  row += fmt::format("<td class=\"n\">{}<br>{}</td>", clash.micrometres("real_until_widened_mm"),
                     clash.micrometres("fake_until_widened_mm"));
  row += fmt::format("<td class=\"n\">{}<br>{}</td>", clash.micrometres("gpd_lo_mm"),
                     clash.micrometres("gpd_hi_mm"));
  row += fmt::format("<td>{}{}<br>{}</td>", clash.text("status"),
                     clash.text("status_by").empty() ? "" : " by " + clash.text("status_by"),
                     clash.text("comment"));
  row += fmt::format("<td>{}<br>{}</td>", known(clash, "holder_a"), known(clash, "holder_b"));
  row += fmt::format("<td class=\"n\">{}<br>{}</td>", range(clash, "eps_a"), range(clash, "eps_b"));
  row += fmt::format("<td>{}<br>{}</td>", clash.text("fit"), range(clash, "clearance"));
  row +=
      fmt::format("<td>{}</td><td>{}</td></tr>\n", clash.text("user"), clash.text("explanation"));
  return row;
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
  std::string html =
      "<h2>Clashes</h2>\n<p class=\"dim\">Each by its worst moment. Lengths in µm; overlap of the "
      "meshes against two thresholds: fake up to the first, real above the second, potential "
      "between. GPD: generalized penetration depth, as a bracket. Mesh error: how far the true "
      "surface "
      "lies outside of the mesh there. Clearance: of the diameters of the fit.</p>\n" +
      filters() +
      "<div class=\"wide\"><table id=\"clashes\"><thead><tr><th>#</th><th>class</th><th>parts, "
      "faces</th><th>from, for</th><th>overlap</th><th>fake up to, real above</th><th>margin</th>"
      "<th>real, fake until zones wider by</th>"
      "<th>GPD</th><th>review</th><th>held by</th><th>mesh error</th><th>fit, clearance</th>"
      "<th>by</th><th>why</th></tr></thead><tbody>\n";
  std::size_t rows = 0;
  for (const char* klass : kClasses)
    for (const std::vector<Json>& row : table.rows)
      if (const Cells clash(table, row); clash.text("class") == klass && rows++ < kMostRows)
        html += clash_row(clash, report.pictures);
  html += "</tbody></table></div>\n";
  if (rows > kMostRows)
    html += fmt::format("<p>{} more clashes are in the CSV, JSON and SQLite exports.</p>\n",
                        rows - kMostRows);
  return html;
}

std::string timeline(const Table& table, double seconds) {
  if (table.rows.empty() || !(seconds > 0.0)) return "";
  const std::size_t bars = std::min(table.rows.size(), kMostBars);
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
    const Cells clash(table, table.rows[i]);
    const double y = 18.0 + 16.0 * static_cast<double>(i), from = x(clash.number("begin_s"));
    const double to = x(clash.number("begin_s") + clash.number("duration_s"));
    const std::string klass = clash.text("class");
    html += fmt::format(
        "<g class=\"{0}\"><text x=\"0\" y=\"{1:.1f}\">{2} {3} × {4}</text><rect x=\"{5:.1f}\" "
        "y=\"{6:.1f}\" width=\"{7:.1f}\" height=\"10\" fill=\"currentColor\"/></g>\n",
        klass, y + 9.0, static_cast<char>(klass.empty() ? '?' : klass[0] - 32),
        clash.text("part_a"), clash.text("part_b"), from, y, std::max(2.0, to - from));
  }
  html += "</svg></div>\n";
  if (bars < table.rows.size())
    html += fmt::format("<p>The first {} of {} clashes.</p>\n", bars, table.rows.size());
  return html;
}

std::string cards(const Table& clashes) {
  const auto count = [&](const char* column, std::string_view value) {
    return std::count_if(clashes.rows.begin(), clashes.rows.end(), [&](const auto& row) {
      return Cells(clashes, row).text(column) == value;
    });
  };
  std::string html = "<div class=\"cards\">";
  for (const char* klass : kClasses)
    html += fmt::format("<div class=\"card\"><b>{}</b>{}</div>", count("class", klass),
                        letter_of(klass));
  html += fmt::format("<div class=\"card\"><b>{}</b>still open</div>", count("end_tick", ""));
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
  const std::string title = "Clashes of " + report.session;
  const Table& clashes = table_named(tables, "clashes");
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>{0}</title><style>{1}</style></head><body>\n"
      "<h1>{0}</h1>\n<p class=\"dim\">Session {2}, scenario {3}, {4} s; engine {5}.</p>\n",
      escaped(title), report_style(), escaped(session_value(tables, "session")),
      escaped(session_value(tables, "scenario")), escaped(session_value(tables, "duration_s")),
      escaped(session_value(tables, "engine_version")));
  if (const std::string complete = session_value(tables, "complete"); complete != "yes")
    html += "<p><b>Incomplete</b>: " + escaped(complete) + "</p>\n";
  html += cards(clashes);
  html += timeline(clashes, std::atof(session_value(tables, "duration_s").c_str()));
  html += clash_section(report);
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
  html += limits_section(report);
  html += plain_table(table_named(tables, "session"), "Session");
  return html + "<script>" + std::string(report_script()) + "</script></body></html>\n";
}

}  // namespace mortise
