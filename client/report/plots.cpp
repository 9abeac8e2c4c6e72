#include "client/report/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "client/report/cells.h"
#include "client/report/pair_groups.h"
#include "common/io/log/log_series.h"
#include "common/messages/length_text.h"

namespace mortise {
namespace {

// The axis of time, as that of the timeline.
constexpr double kLeft = 300.0, kWidth = 780.0, kAll = 1100.0;
// A clash has a row of its own; of many the worst.
constexpr double kRow = 46.0, kHead = 18.0, kDeepest = 34.0;
constexpr std::size_t kMostPlotRows = 40;
// Columns of the plot of times: as many as can be told apart.
constexpr std::size_t kMostColumns = 390;
constexpr double kTimesHeight = 160.0;

std::string session_value(const SessionReport& report, std::string_view key) {
  for (const auto& row : table_named(report.tables, "session").rows)
    if (row[0] == key) return row[1].get<std::string>();
  return "";
}

double in_session(const SessionReport& report, std::string_view key) {
  return std::atof(session_value(report, key).c_str());
}

double x_of(double s, double seconds) { return kLeft + kWidth * std::clamp(s / seconds, 0.0, 1.0); }

// As many letters as stand before the plot.
std::string shortened(const std::string& text) {
  // kLeft has room for them, 7 px each.
  constexpr std::size_t kMost = 42;
  return text.size() <= kMost ? text : text.substr(0, kMost - 3) + "...";
}

std::string begin_svg(double height, const std::string& label) {
  return fmt::format(
      "<div class=\"wide\"><svg width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\" role=\"img\" aria-label=\"{2}\">\n",
      kAll, height, label);
}

std::string time_axis(double seconds, double height) {
  std::string svg;
  for (int i = 0; i <= 4; ++i)
    svg += fmt::format(
        "<path d=\"M{0:.1f} 14V{1:.1f}\" stroke=\"currentColor\" opacity=\".15\"/><text "
        "x=\"{0:.1f}\" y=\"10\" text-anchor=\"{3}\">{2:.1f} s</text>\n",
        x_of(seconds * i / 4, seconds), height, seconds * i / 4, i == 4 ? "end" : "middle");
  return svg;
}

DepthSeries pieces_of(const Table& events, double seconds) {
  DepthSeries all;
  for (const auto& row : events.rows) {
    const Cells event(events, row);
    add_event(all, event["clash"].get<std::uint64_t>(), event.raw("kind"),
              {event.number("time_s"), seconds, event.number("overlap_lo_mm"),
               event.number("overlap_hi_mm"), event.number("fake_below_mm"),
               event.number("real_above_mm"), event.text("class")});
  }
  return all;
}

// What is certain of the depth filled, what it is at most as a line, both thresholds dashed.
std::string drawn(const std::vector<DepthPiece>& pieces, double bottom, double seconds) {
  const double scale = kDeepest / largest_mm(pieces);
  const auto y = [&](double mm) { return bottom - std::min(kDeepest, scale * mm); };
  std::string svg, fake, real;
  for (const DepthPiece& piece : pieces) {
    const double from = x_of(piece.from, seconds);
    const double to = std::max(from + 2.0, x_of(piece.to, seconds));
    svg += fmt::format(
        "<g class=\"{}\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
        "fill=\"currentColor\" opacity=\".6\"/>",
        piece.klass, from, y(piece.least_mm), to - from, std::max(1.0, bottom - y(piece.least_mm)));
    if (std::isfinite(piece.most_mm))
      svg += fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"currentColor\"/>", from,
                         y(piece.most_mm), to);
    svg += "</g>\n";
    if (std::isfinite(piece.fake_below_mm))
      fake += fmt::format("M{:.1f} {:.1f}H{:.1f}", from, y(piece.fake_below_mm), to);
    if (std::isfinite(piece.real_above_mm))
      real += fmt::format("M{:.1f} {:.1f}H{:.1f}", from, y(piece.real_above_mm), to);
  }
  const auto dashed = [&](const std::string& path, const char* dashes) {
    if (!path.empty())
      svg += fmt::format("<path d=\"{}\" stroke=\"currentColor\" stroke-dasharray=\"{}\"/>\n", path,
                         dashes);
  };
  dashed(fake, "1 3");
  dashed(real, "5 3");
  return svg;
}

std::string depth_row(const Cells& clash, const std::vector<DepthPiece>& pieces, double top,
                      double seconds) {
  const double bottom = top + kRow - 8.0;
  const std::string klass = clash.text("class");
  std::string svg = fmt::format(
      "<g class=\"{}\"><text x=\"0\" y=\"{:.1f}\">{} #{} {}</text></g><text x=\"0\" "
      "y=\"{:.1f}\" opacity=\".75\">{}</text><text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\" "
      "opacity=\".75\">{}</text><path d=\"M{:.1f} {:.1f}h{:.1f}\" stroke=\"currentColor\" "
      "opacity=\".3\"/>\n",
      klass, top + 14.0, static_cast<char>(klass.empty() ? '?' : klass[0] - 32),
      clash.text("clash"), escaped(shortened(clash.raw("part_a"))), top + 27.0,
      escaped("× " + shortened(clash.raw("part_b"))), kLeft - 6.0, top + 12.0,
      length_text(largest_mm(pieces)), kLeft, bottom, kWidth);
  return svg + drawn(pieces, bottom, seconds);
}

std::vector<TimeColumn> columns_of(const Table& times) {
  std::vector<TimeColumn> columns;
  for (const auto& cells : times.rows) {
    const Cells row(times, cells);
    columns.push_back({row.number("begin_s"), row.number("end_s"), row.number("ticks"),
                       row.number("ticks") * row.number("mean_us"), row.number("max_us")});
  }
  return joined_columns(columns, kMostColumns);
}

std::string time_text(double us) {
  return us < 1e3   ? fmt::format("{:.0f} µs", us)
         : us < 1e6 ? fmt::format("{:.4g} ms", 1e-3 * us)
                    : fmt::format("{:.4g} s", 1e-6 * us);
}

}  // namespace

std::string depth_section(const SessionReport& report) {
  const Table& clashes = table_named(report.tables, "clashes");
  const double seconds = in_session(report, "end_s");
  if (clashes.rows.empty() || !(seconds > 0.0)) return "";
  const auto pieces = pieces_of(table_named(report.tables, "events"), seconds);
  std::vector<std::size_t> rows;
  for (const PairGroup& group : pair_groups(clashes)) {
    rows.push_back(group.lead);
    rows.insert(rows.end(), group.others.begin(), group.others.end());
  }
  const std::size_t shown = std::min(rows.size(), kMostPlotRows);
  const double height = kHead + kRow * static_cast<double>(shown) + 4.0;
  std::string html =
      "<h2>Depth over time</h2>\n<p class=\"dim\">One row a clash, the worst first, each to its "
      "own scale, whose end is written before it. Filled: the overlap that is certain, in the "
      "colour of its class then; a line: what it is at most. Dotted: fake up to here; dashed: real "
      "above. As the events tell it: between two of them the depth grew by less than a "
      "tenth.</p>\n";
  html += begin_svg(height,
                    "How deep each clash was over time; the same is in the table of events "
                    "of the other exports");
  html += time_axis(seconds, height);
  for (std::size_t i = 0; i < shown; ++i) {
    const Cells clash(clashes, clashes.rows[rows[i]]);
    const auto found = pieces.find(clash["clash"].get<std::uint64_t>());
    if (found == pieces.end() || found->second.empty()) continue;  // begun before this log
    html += depth_row(clash, found->second, kHead + kRow * static_cast<double>(i), seconds);
  }
  html += "</svg></div>\n";
  if (shown < rows.size())
    html += fmt::format("<p>The worst {} of {} clashes.</p>\n", shown, rows.size());
  return html;
}

std::string tick_time_section(const SessionReport& report) {
  const Table& times = table_named(report.tables, "tick_times");
  const double seconds = in_session(report, "end_s");
  if (times.rows.empty() || !(seconds > 0.0)) return "";
  const std::vector<TimeColumn> columns = columns_of(times);
  const double period_us = 1e6 / std::max(1e-3, in_session(report, "tick_rate_hz"));
  double least = 1e3, most = period_us;
  for (const TimeColumn& column : columns) {
    least = std::min(least, column.mean_us());
    most = std::max(most, column.max_us);
  }
  const double low = std::floor(std::log10(std::max(1e-3, least)));
  const double high = std::ceil(std::log10(most));
  const double bottom = kHead + kTimesHeight;
  const auto y = [&](double us) {
    return bottom - kTimesHeight *
                        std::clamp((std::log10(std::max(us, 1e-9)) - low) / (high - low), 0.0, 1.0);
  };
  std::string html =
      "<h2>Tick times</h2>\n<p class=\"dim\">What the engine took for the ticks into which "
      "something went, each column about a second: filled their mean, the line their longest. "
      "Dashed: the time from one tick to the next. The scale goes by factors of ten.</p>\n";
  html += begin_svg(bottom + 6.0,
                    "What ticks took over time; the same is in the table of tick "
                    "times of the other exports");
  html += time_axis(seconds, bottom);
  for (double power = low; power <= high; power += 1.0)
    html += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}h{2:.1f}\" stroke=\"currentColor\" opacity=\".15\"/><text "
        "x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        kLeft, y(std::pow(10.0, power)), kWidth, kLeft - 6.0, y(std::pow(10.0, power)) + 4.0,
        time_text(std::pow(10.0, power)));
  for (const TimeColumn& column : columns) {
    const double from = x_of(column.from, seconds);
    const double to = std::max(from + 1.5, x_of(column.to, seconds));
    const double mean = y(column.mean_us());
    html += fmt::format(
        "<rect x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{3:.1f}\" "
        "fill=\"currentColor\" opacity=\".4\"/><path d=\"M{0:.1f} {4:.1f}h{2:.1f}\" "
        "stroke=\"currentColor\"/>\n",
        from, mean, to - from, std::max(1.0, bottom - mean), y(column.max_us));
  }
  html += fmt::format(
      "<path d=\"M{0:.1f} {1:.1f}h{2:.1f}\" stroke=\"currentColor\" stroke-dasharray=\"5 3\"/>"
      "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5} from tick to tick</text>\n",
      kLeft, y(period_us), kWidth, kLeft + kWidth, y(period_us) - 4.0, time_text(period_us));
  return html + "</svg></div>\n";
}

}  // namespace mortise
