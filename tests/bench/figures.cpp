#include "tests/bench/figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <thread>

namespace mortise::bench {
namespace {

using Json = nlohmann::ordered_json;
using Row = std::vector<std::string>;

constexpr std::size_t kLineLength = 160;

// Characters of UTF-8 text.
std::size_t length_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](unsigned char c) { return (c & 0xc0U) != 0x80U; }));
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// A sentence that is too long for a line of its table ends with "…".
constexpr std::size_t kCellLength = 100;

std::string cut(const std::string& text) {
  if (length_of(text) <= kCellLength) return text;
  std::string kept;
  std::size_t length = 0;
  for (const char c : text) {
    length += (static_cast<unsigned char>(c) & 0xc0U) != 0x80U;
    if (length == kCellLength) break;
    kept.push_back(c);
  }
  return kept + "…";
}

std::string cell_text(const Json& cell) {
  if (cell.is_null()) return "-";
  if (cell.is_string()) return cut(cell.get<std::string>());
  if (cell.is_number_float()) return number_text(cell.get<double>());
  return cell.dump();
}

std::string line_of(const Row& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line.append(" ").append(cell).append(" |");
  return line;
}

std::string rule_of(std::size_t columns) {
  std::string rule = "|";
  for (std::size_t c = 0; c < columns; ++c) rule += "---|";
  return rule;
}

// The columns in pieces that fit a line, each piece with the first column.
std::string table_text(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths;
  for (const Row& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c == widths.size()) widths.push_back(0);
      widths[c] = std::max(widths[c], length_of(row[c]) + 3);
    }
  std::string text;
  for (std::size_t first = 1; first < std::max<std::size_t>(widths.size(), 2);) {
    std::size_t end = first, width = 1 + widths[0];
    while (end < widths.size() && (end == first || width + widths[end] <= kLineLength))
      width += widths[end++];
    for (const Row& row : rows) {
      Row piece = {row[0]};
      for (std::size_t c = first; c < std::min(end, row.size()); ++c) piece.push_back(row[c]);
      text.append(line_of(piece)).append("\n");
      if (&row == rows.data()) text.append(rule_of(piece.size())).append("\n");
    }
    text += "\n";
    first = std::max(end, first + 1);
  }
  return text;
}

std::string wrapped(const std::string& text) {
  std::string out, line;
  std::string word;
  const auto take = [&] {
    if (word.empty()) return;
    if (!line.empty() && length_of(line) + 1 + length_of(word) > kLineLength) {
      out.append(line).append("\n");
      line.clear();
    }
    line.append(line.empty() ? "" : " ").append(word);
    word.clear();
  };
  for (const char c : text) {
    if (c == ' ' || c == '\n')
      take();
    else
      word.push_back(c);
  }
  take();
  return out + line + "\n";
}

std::string machine_text() {
  std::ifstream in("/proc/cpuinfo");
  std::string line, model = "an unknown processor";
  while (std::getline(in, line))
    if (line.starts_with("model name")) {
      model = line.substr(line.find(':') + 2);
      break;
    }
  return model + ", " + std::to_string(std::thread::hardware_concurrency()) + " processors";
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  char text[16];
  std::strftime(text, sizeof text, "%Y-%m-%d", std::gmtime(&now));
  return text;
}

// The rows of the README's table.
struct Headline {
  const char* question;
  const char* benchmark;
  const char* bar;
  const char* unit;
};
constexpr Headline kHeadlines[] = {
    {"First contact beside FCL's repaired advancement", "first-contact",
     "times as fast as FCL advancement repaired, OBBRSS", " times as fast"},
    {"A tick in which nothing moves, p99", "first-contact",
     "tick in which nothing moves, 10,000 static parts, p99 us", " µs"},
    {"Verdicts that contradict the exact truth", "judgement",
     "contradictions of the truth, all grades but estimated", ""},
    {"Deadlines missed with 64 users at 60 Hz", "session", "64 users at 60 Hz: deadlines missed, %",
     " %"},
    {"Computing a recorded session again", "records", "verify, times real time (CPU)",
     " times as fast as it was played"},
};

std::string figure_text(const std::vector<KeptRun>& runs, const Headline& headline) {
  for (const KeptRun& run : runs)
    if (run["benchmark"] == headline.benchmark)
      for (const Json& bar : run["report"]["bars"])
        if (bar["name"] == headline.bar) return cell_text(bar["figure"]) + headline.unit;
  return "not measured";
}

std::string page_of(const KeptRun& run) {
  const std::string name = run["benchmark"];
  std::string page = "\n## " + name + "\n";
  page += wrapped("`" + run["command"].get<std::string>() + "`, " + run["date"].get<std::string>() +
                  ", " + run["machine"].get<std::string>() + ".");
  const Json& report = run["report"];
  for (const Json& table : report["tables"]) {
    std::vector<Row> rows;
    for (const Json& row : table["rows"]) {
      Row names, cells;
      for (const auto& [column, cell] : row.items()) {
        names.push_back(column);
        cells.push_back(cell_text(cell));
      }
      if (rows.empty()) rows.push_back(names);
      rows.push_back(cells);
    }
    if (!rows.empty())
      page += "\n### " + table["title"].get<std::string>() + "\n" + table_text(rows);
  }
  for (const Json& note : report["notes"]) page += "\n" + wrapped(note.get<std::string>());
  if (report["bars"].empty()) return page;
  std::vector<Row> bars = {{"bar", "figure", "bound", "holds"}};
  for (const Json& bar : report["bars"])
    bars.push_back({bar["name"], cell_text(bar["figure"]),
                    bar["kind"].get<std::string>() + " " + cell_text(bar["bound"]),
                    bar["holds"].get<bool>() ? "yes" : "**no**"});
  return page + "\n### Bars of " + name + "\n" + table_text(bars);
}

// A list with an entry a line.
void add_lines(const Json& list, std::string& text) {
  text += "[";
  const char* separator = "\n";
  for (const Json& entry : list) {
    text.append(separator).append(entry.dump());
    separator = ",\n";
  }
  text += "]";
}

}  // namespace

KeptRun kept_run(const std::string& benchmark, const std::string& command, Json report) {
  return {{"benchmark", benchmark},
          {"command", command},
          {"date", today()},
          {"machine", machine_text()},
          {"report", std::move(report)}};
}

std::string text_of(const KeptRun& run) {
  KeptRun head = run;
  const Json report = head["report"];
  head.erase("report");
  std::string text = head.dump();
  text.back() = ',';
  text += "\n\"report\":{\"tables\":[";
  for (const Json& table : report["tables"]) {
    text += text.ends_with('[') ? "\n" : ",\n";
    text.append("{\"title\":").append(table["title"].dump()).append(",\"rows\":");
    add_lines(table["rows"], text);
    text += "}";
  }
  text += "],\n\"notes\":";
  add_lines(report["notes"], text);
  text += ",\n\"bars\":";
  add_lines(report["bars"], text);
  return text + "}}\n";
}

std::vector<KeptRun> runs_in(const std::filesystem::path& folder) {
  std::vector<KeptRun> runs;
  std::error_code none;  // a folder that is not there has no runs
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    if (entry.path().extension() != ".json") continue;
    std::ifstream in(entry.path());
    runs.push_back(KeptRun::parse(in));
  }
  std::sort(runs.begin(), runs.end(),
            [](const KeptRun& a, const KeptRun& b) { return a["benchmark"] < b["benchmark"]; });
  return runs;
}

std::string figures_page(const std::vector<KeptRun>& runs) {
  std::string page =
      "# Figures\n" +
      wrapped(
          "Generated by `./mortise bench --figures` from the last runs in "
          "`tests/bench/figures`; not edited by hand. Machines differ and may be shared: "
          "compare figures of one run. Runs with `--quick` are shorter and rougher. "
          "[README.md](README.md) says what the tables mean.");
  for (const KeptRun& run : runs) page += page_of(run);
  while (page.ends_with("\n\n")) page.pop_back();
  return page;
}

std::string with_figures(const std::string& document, const std::vector<KeptRun>& runs) {
  const std::string begin = "<!-- figures -->\n";
  const std::size_t from = document.find(begin), to = document.find("<!-- /figures -->\n");
  if (from == std::string::npos || to == std::string::npos) return document;
  std::string table = "| question | figure | benchmark |\n|---|---|---|\n";
  for (const Headline& h : kHeadlines) {
    const std::string link =
        std::string("[") + h.benchmark + "](tests/bench/FIGURES.md#" + h.benchmark + ")";
    table += line_of({h.question, figure_text(runs, h), link}) + "\n";
  }
  return document.substr(0, from + begin.size()) + table + document.substr(to);
}

}  // namespace mortise::bench
