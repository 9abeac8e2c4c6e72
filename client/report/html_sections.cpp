#include "client/report/html_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "client/report/cells.h"
#include "client/report/pair_groups.h"
#include "common/messages/length_text.h"

namespace mortise {
namespace {

// Bounds the page; CSV and SQLite have all rows.
constexpr std::size_t kMostRows = 2000;

std::string base64(const std::string& bytes) {
  constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() * 4 / 3 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    const std::size_t here = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (k < here ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text.push_back(k <= here ? kLetters[three >> (18 - 6 * k) & 63] : '=');
  }
  return text;
}

std::string counted(std::size_t clashes) {
  return clashes == 1 ? "1 clash" : fmt::format("{} clashes", clashes);
}

std::string signed_um(double mm) { return fmt::format("{:+.0f}", 1e3 * mm); }

// A name of several words may be broken into lines.
std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// To read: as many digits as mean something. The other exports have them all.
std::string value_text(const Cells& cells, const Table::Column& column) {
  const double x = cells.number(column.name);
  return column.type == Table::Type::kNumber && std::isfinite(x) ? fmt::format("{:.6g}", x)
                                                                 : cells.text(column.name);
}

}  // namespace

std::string letter_of(const std::string& klass) {
  return fmt::format(
      "<span class=\"letter {0}\" aria-hidden=\"true\">{1}</span> "
      "<span class=\"{0}\">{0}</span>",
      klass, klass.empty() ? "" : std::string(1, static_cast<char>(klass[0] - 32)));
}

std::string plain_table(const Table& table, const std::string& title) {
  if (table.rows.empty()) return "";
  std::string html = fmt::format(
      "<h2>{}</h2>\n<p class=\"dim\">{}</p>\n<div class=\"wide\"><table "
      "id=\"{}\"><thead><tr>",
      title, escaped(table.about), escaped(table.name));
  for (const Table::Column& column : table.columns)
    html += (column.type == Table::Type::kText ? "<th>" : "<th class=\"n\">") +
            spaced(escaped(column.name)) + "</th>";
  html += "</tr></thead><tbody>\n";
  for (std::size_t i = 0; i < std::min(table.rows.size(), kMostRows); ++i) {
    const Cells cells(table, table.rows[i]);
    html += "<tr>";
    for (const Table::Column& column : table.columns)
      html += (column.type == Table::Type::kText ? "<td>" : "<td class=\"n\">") +
              value_text(cells, column) + "</td>";
    html += "</tr>\n";
  }
  html += "</tbody></table></div>\n";
  if (table.rows.size() > kMostRows)
    html += fmt::format("<p>The first {} of {} rows.</p>\n", kMostRows, table.rows.size());
  return html;
}

std::string picture_section(const SessionReport& report) {
  const Pictures& pictures = report.pictures;
  const Table& clashes = table_named(report.tables, "clashes");
  if (clashes.rows.empty()) return "";
  std::string html = "<h2>Pictures</h2>\n";
  if (!pictures.missing.empty()) return html + "<p>None: " + escaped(pictures.missing) + "</p>\n";
  html +=
      "<p class=\"dim\">Each clash in section through its deepest point, at its worst moment: "
      "meshes, the surfaces that they stand for, where the real surfaces may lie, overlap and both "
      "thresholds. Drawn from the poses in the log, which are rounded to a float and to 4e-6 rad; "
      "numbers are those of the engine.</p>\n";
  const auto figure = [&](std::size_t row) -> std::string {
    const Cells clash(clashes, clashes.rows[row]);
    const auto found = pictures.of_clash.find(clash["clash"].get<std::uint64_t>());
    if (found == pictures.of_clash.end()) return "";
    return fmt::format(
        "<figure id=\"clash-{0}\">{1}<figcaption>{2} #{0} {3} × {4}, tick {5}</figcaption>"
        "</figure>\n",
        found->first, found->second, letter_of(clash.text("class")), clash.text("part_a"),
        clash.text("part_b"), clash.text("worst_tick"));
  };
  for (const PairGroup& group : pair_groups(clashes)) {
    html += figure(group.lead);
    std::string others;
    for (const std::size_t row : group.others) others += figure(row);
    if (!others.empty())
      html += "<details><summary>" + also_text(group) + "</summary>\n" + others + "</details>\n";
  }
  if (pictures.clashes_left_out > 0)
    html +=
        fmt::format("<p>{} clashes are not drawn: the worst are.</p>\n", pictures.clashes_left_out);
  return html;
}

std::string part_section(const SessionReport& report) {
  const Pictures& pictures = report.pictures;
  std::string html;
  if (!pictures.of_part.empty()) {
    html =
        "<h2>Where parts were touched</h2>\n<p class=\"dim\">Faces have the colour of the class of "
        "their "
        "worst clash, the deeper the nearer to the next class; each ring is a clash, the larger "
        "the "
        "worse, with the letter of its class; the deepest three with their overlap.</p>\n<div "
        "class=\"parts\">\n";
    for (const PartPicture& part : pictures.of_part)
      html += fmt::format(
          "<figure><img alt=\"{0}: {1}, the deepest {2}\" width=\"450\" "
          "src=\"data:image/png;base64,{3}\"><figcaption>{0}: {1}, at most {2}"
          "</figcaption></figure>\n",
          escaped(part.part), counted(part.clashes), length_text(part.deepest_mm),
          base64(part.png));
    html += "</div>\n";
    if (pictures.parts_left_out > 0)
      html +=
          fmt::format("<p>{} more parts were touched less deep.</p>\n", pictures.parts_left_out);
  }
  return html + plain_table(table_named(report.tables, "by_face"), "By face");
}

std::string tolerance_section(const SessionReport& report) {
  const Table& table = table_named(report.tables, "tolerance");
  if (table_named(report.tables, "clashes").rows.empty()) return "";
  std::string html =
      "<h2>With other tolerances</h2>\n<p class=\"dim\">Number of clashes by class if the "
      "zone of every face were wider (+) or narrower (−) by so many µm to each side, each at its "
      "worst recorded moment. Parts that would have stopped elsewhere are not moved here: "
      "<code>mortise replay whatif</code> computes the session again.</p>\n<div "
      "class=\"wide\"><table>"
      "<thead><tr>"
      "<th class=\"n\">zones, µm</th>";
  constexpr const char* kColumns[] = {"real", "potential", "fake", "none", "not_known"};
  for (const char* column : kColumns)
    html += fmt::format("<th class=\"n\">{}</th>", spaced(column));
  html += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    const Cells cells(table, row);
    const double mm = cells.number("widening_mm");
    html += fmt::format("<tr{}><td class=\"n\">{}</td>", mm == 0.0 ? " class=\"now\"" : "",
                        mm == 0.0 ? "as recorded" : signed_um(mm));
    for (const char* column : kColumns) html += "<td class=\"n\">" + cells.text(column) + "</td>";
    html += "</tr>\n";
  }
  html += "</tbody></table></div>\n";
  for (const Table& more : report.tables)
    if (more.name == "what_if") html += plain_table(more, "What if");
  return html;
}

std::string limits_section(const SessionReport& report) {
  const Table& clashes = table_named(report.tables, "clashes");
  const auto count = [&](const char* column, auto&& is) {
    return std::count_if(clashes.rows.begin(), clashes.rows.end(),
                         [&](const auto& row) { return is(Cells(clashes, row).raw(column)); });
  };
  std::vector<std::string> lines;
  const auto say = [&](std::ptrdiff_t number, const std::string& what) {
    if (number > 0) lines.push_back(fmt::format("{} {}", number, what));
  };
  say(count("mesh_error", [](const std::string& grade) { return grade == "nominal"; }),
      "clashes are judged without any declaration: the mesh is taken for the surface.");
  say(count("mesh_error", [](const std::string& grade) { return grade == "estimated"; }),
      "clashes rest on an estimate of the mesh error, which is not guaranteed.");
  say(count("explanation",
            [](const std::string& text) { return text.find("no inside") != std::string::npos; }),
      "clashes are of a part that is open and has no inside: their depth is not known.");
  say(count("explanation",
            [](const std::string& text) { return text.find("work limit") != std::string::npos; }),
      "clashes were left with wide brackets at the limit of work.");
  const Table& coverage = table_named(report.tables, "coverage");
  for (const auto& row : coverage.rows) {
    const Cells cells(coverage, row);
    const auto number = static_cast<std::ptrdiff_t>(cells.number("count"));
    if (cells.raw("what") == "not_examined")
      say(number,
          "times a pair was not examined to the end of a tick; none of them counts as "
          "clear.");
    if (cells.raw("what") == "parts_without_inside")
      say(number,
          "times a part took part that is open or not manifold: crossing is found, depth "
          "is not.");
  }
  for (const auto& row : table_named(report.tables, "session").rows)
    if (row[0] == "gap" || row[0] == "note") lines.push_back(row[1].get<std::string>());
  std::string html = "<h2>Limits</h2>\n";
  if (lines.empty()) return html + "<p>Nothing is missing, and nothing was given up.</p>\n";
  html += "<ul>\n";
  for (const std::string& line : lines) html += "<li>" + escaped(line) + "</li>\n";
  return html + "</ul>\n";
}

}  // namespace mortise
