// The session as tables: CSV, JSON, SQLite and HTML say the same, and say it safely.
#include "client/report/circumstances.h"
#include "client/report/export_files.h"
#include "client/report/export_html.h"
#include "client/report/export_sqlite.h"
#include "client/report/report.h"
#include "client/report/summary_tables.h"
#include "common/geometry/signed_distance.h"
#include "common/io/log/replay.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "tests/golden/played_session.h"
#include "tests/support/programs.h"
#include "tests/unit/io/log_samples.h"

namespace mortise {
namespace {

class Export : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const std::string folder = std::string(MORTISE_SOURCE_DIR) + "/scenarios/thin_wall";
    auto session = test::play_session(folder + ".yaml", folder + ".play.yaml");
    ASSERT_TRUE(session) << session.error().text;
    file_ = std::make_unique<test::TemporaryFile>("export.mcap");
    ASSERT_TRUE(test::write_log(*session, file_->path()));
    auto log = read_session_log(file_->path());
    ASSERT_TRUE(log) << log.error().text;
    log_ = std::make_unique<SessionLog>(std::move(*log));
  }
  static void TearDownTestSuite() { file_.reset(), log_.reset(); }
  void SetUp() override { ASSERT_NE(log_, nullptr); }
  static inline std::unique_ptr<test::TemporaryFile> file_;
  static inline std::unique_ptr<SessionLog> log_;
};

// Fields of RFC 4180 text, by line.
std::vector<std::vector<std::string>> fields_of(const std::string& csv) {
  std::vector<std::vector<std::string>> lines{{""}};
  bool quoted = false;
  for (std::size_t i = 0; i < csv.size(); ++i) {
    const char c = csv[i];
    if (quoted && c == '"' && i + 1 < csv.size() && csv[i + 1] == '"')
      lines.back().back() += csv[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && c == ',')
      lines.back().emplace_back();
    else if (!quoted && c == '\n')
      lines.push_back({""});
    else if (quoted || c != '\r')
      lines.back().back() += c;
  }
  lines.pop_back();
  return lines;
}

std::string plain(const Json& value) {
  return value.is_null() ? "" : value.is_string() ? value.get<std::string>() : value.dump();
}

TEST_F(Export, CsvAndJsonSayTheSame) {
  const auto tables = tables_of(*log_, StepCounters{});
  ASSERT_TRUE(tables) << tables.error().text;
  const Json document = json_of(*tables);
  for (const Table& table : *tables) {
    const auto lines = fields_of(csv_of(table));
    const Json& rows = document["tables"][table.name];
    ASSERT_EQ(lines.size(), rows.size() + 1) << table.name;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      ASSERT_EQ(lines[i + 1].size(), lines[0].size()) << table.name << " " << i;
      for (std::size_t k = 0; k < lines[0].size(); ++k)
        EXPECT_EQ(lines[i + 1][k], plain(rows[i][lines[0][k]])) << table.name;
    }
  }
  const Json& clashes = document["tables"]["clashes"];
  ASSERT_GE(clashes.size(), 1U);
  EXPECT_EQ(clashes[0]["class"], "real");
  EXPECT_EQ(clashes[0]["part_a"], "wall");
  EXPECT_EQ(clashes[0]["part_b"], "cube");
  EXPECT_TRUE(clashes[0]["status_tick"].is_null());
  for (const Json& clash : clashes) {
    const auto same = std::ranges::count_if(clashes, [&](const Json& other) {
      return std::ranges::all_of(std::array{"part_a", "face_a", "part_b", "face_b"},
                                 [&](const char* key) { return clash[key] == other[key]; });
    });
    EXPECT_EQ(clash["occurrences"], same);
    const auto grouped = std::ranges::count_if(
        clashes, [&](const Json& other) { return other["group_id"] == clash["group_id"]; });
    EXPECT_EQ(grouped, same);
    const double undecided_mm =
        clash["real_above_mm"].get<double>() - clash["fake_below_mm"].get<double>();
    if (undecided_mm > 0.0)
      EXPECT_DOUBLE_EQ(clash["severity"].get<double>() * undecided_mm,
                       clash["margin_mm"].get<double>());
    else
      EXPECT_TRUE(clash["severity"].is_null());
  }
  EXPECT_GT(document["tables"]["coverage"].size(), 20U);
  EXPECT_EQ(document["tables"]["parts"].size(), log_->mesh_of_part.size());
}

// What the tables count is what the events of the log say.
TEST_F(Export, CountsWhatTheLogTells) {
  const auto tables = tables_of(*log_, std::nullopt);
  ASSERT_TRUE(tables);
  std::size_t events = 0, begun = 0, increments = 0;
  for (const TickRecord& record : log_->ticks) {
    events += record.report.events.size();
    increments += record.increments.size();
    for (const ClashEvent& event : record.report.events)
      begun += event.kind == ClashEvent::Kind::kBegin;
  }
  EXPECT_EQ(table_named(*tables, "events").rows.size(), events);
  EXPECT_EQ(table_named(*tables, "clashes").rows.size(), begun);
  std::size_t sent = 0;
  const Json document = json_of(*tables);
  for (const Json& user : document["tables"]["users"])
    sent += user["increments"].get<std::size_t>();
  EXPECT_EQ(sent, increments);
}

TEST_F(Export, SqliteHoldsTheTablesAndViews) {
  const auto tables = tables_of(*log_, StepCounters{});
  ASSERT_TRUE(tables);
  const test::TemporaryFile file("export.db");
  ASSERT_TRUE(write_sqlite(*tables, file.path()));
  EXPECT_FALSE(write_sqlite(*tables, file.path()));  // never over what is there
  sqlite3* handle = nullptr;
  ASSERT_EQ(sqlite3_open(file.path().c_str(), &handle), SQLITE_OK);
  const std::unique_ptr<sqlite3, decltype(&sqlite3_close)> closing(handle, sqlite3_close);
  const auto count = [&](const std::string& from) {
    std::int64_t found = -1;
    sqlite3_exec(
        handle, ("SELECT count(*) FROM " + from).c_str(),
        [](void* to, int, char** value, char**) {
          *static_cast<std::int64_t*>(to) = std::atoll(value[0]);
          return 0;
        },
        &found, nullptr);
    return found;
  };
  for (const Table& table : *tables)
    EXPECT_EQ(count(table.name), static_cast<std::int64_t>(table.rows.size())) << table.name;
  for (const char* view : {"v_open", "v_to_review", "v_worst_by_pair", "v_by_user", "v_timeline"})
    EXPECT_GE(count(view), 0) << view;
  EXPECT_EQ(count("clashes WHERE class = 'real' AND overlap_lo_mm > 0"),
            count("clashes WHERE class = 'real'"));
}

// Names come from people: none of them becomes a tag, a formula of the page or another field.
TEST_F(Export, TextOfPeopleStaysText) {
  auto report = report_of(*log_);
  ASSERT_TRUE(report);
  std::vector<Table>& tables = report->tables;
  report->pictures = {};
  const std::string evil = "</script><img src=x onerror=alert(1)>\",\"a\r\nb";
  report->session = evil;
  for (Table& table : tables)
    for (auto& row : table.rows)
      for (std::size_t i = 0; i < row.size(); ++i)
        if (table.columns[i].type == Table::Type::kText && table.columns[i].name != "class" &&
            table.columns[i].name != "key")
          row[i] = evil;
  const std::string html = html_of(*report);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_NE(html.find("&lt;img"), std::string::npos);
  EXPECT_EQ(html.find("http"), std::string::npos) << "the page needs the network";
  const auto lines = fields_of(csv_of(table_named(tables, "clashes")));
  for (const auto& line : lines) EXPECT_EQ(line.size(), lines[0].size());
  EXPECT_NE(std::find(lines[1].begin(), lines[1].end(), evil), lines[1].end());
}

// A spreadsheet must not compute what somebody is called.
TEST_F(Export, NoFieldIsAFormula) {
  Table table{"t", "", {{"text", Table::Type::kText}, {"number", Table::Type::kNumber}}, {}};
  for (const char* text : {"=1+1", "+x", "-x", "@x", "\tx", "\rx", "plain", ""})
    table.rows.push_back({text, -1.5});
  const auto lines = fields_of(csv_of(table));
  ASSERT_EQ(lines.size(), 9U);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    EXPECT_EQ(lines[i][1], "-1.5");  // numbers stay numbers
    const char first = lines[i][0].empty() ? 'x' : lines[i][0][0];
    EXPECT_EQ(std::string("=+-@\t\r").find(first), std::string::npos) << lines[i][0];
  }
  EXPECT_EQ(lines[1][0], "'=1+1");
  EXPECT_EQ(lines[7][0], "plain");
}

TEST(Circumstances, AFitIsOfTheTwoFacesThatMakeIt) {
  EXPECT_TRUE(is_of_fit("Ø20 H7/k6", "Ø20 H7", "Ø20 k6"));
  EXPECT_TRUE(is_of_fit("Ø20 H7/k6", "Ø20 k6 and position 0.1", "Ø20 H7"));
  EXPECT_FALSE(is_of_fit("Ø20 H7/k6", "Ø20 H7", "-0.1 .. -0.04"));  // a chamfer in the bore
  EXPECT_FALSE(is_of_fit("Ø20 H7/k6", "Ø20 H7", ""));
  EXPECT_FALSE(is_of_fit("Ø20 H7/k6", "Ø20 H7", "Ø20 H7"));
  EXPECT_FALSE(is_of_fit("", "Ø20 H7", "Ø20 k6"));
}

// Who held the parts, the mesh error there, and the fit with its clearance: as the scenario says.
TEST(ExportCircumstances, OfAFitAreThoseOfTheStandardAndOfTheMesh) {
  const std::string folder = std::string(MORTISE_SOURCE_DIR) + "/scenarios/gearbox";
  const auto session = test::play_session(folder + ".yaml", folder + ".play.yaml");
  ASSERT_TRUE(session) << session.error().text;
  const test::TemporaryFile file("gearbox.mcap"), db("gearbox.db");
  ASSERT_TRUE(test::write_log(*session, file.path()));
  const auto log = read_session_log(file.path());
  ASSERT_TRUE(log);
  const auto report = report_of(*log, {.pictures = {0, 0}, .coverage = {}, .more = {}});
  ASSERT_TRUE(report) << report.error().text;
  const Table& clashes = table_named(report->tables, "clashes");
  const Json rows = json_of(report->tables)["tables"]["clashes"];
  const auto lines = fields_of(csv_of(clashes));
  const std::string html = html_of(*report);
  std::size_t fitted = 0, unfitted = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Json& row = rows[i];
    SCOPED_TRACE(row.dump());
    for (std::size_t k = 0; k < lines[0].size(); ++k)
      EXPECT_EQ(lines[i + 1][k], plain(row[lines[0][k]])) << lines[0][k];
    // Who moved it held it, and nobody holds the other.
    const std::string by = row["user"];
    EXPECT_TRUE(row["holder_a"] == by || row["holder_b"] == by);
    if (row["part_a"] != "input_shaft" || row["part_b"] != "gear_in") {
      unfitted += row["fit"] == "" && row["clearance_lo_mm"].is_null();
      continue;
    }
    ++fitted;
    // ISO 286-2: H7 of Ø20 is 0 to 21 µm, k6 is 2 to 15 µm.
    EXPECT_EQ(row["fit"], "Ø20 H7/k6");
    EXPECT_NEAR(row["clearance_lo_mm"].get<double>(), -0.015, 1e-12);
    EXPECT_NEAR(row["clearance_hi_mm"].get<double>(), 0.019, 1e-12);
    // The corners of the shaft's mesh are on it, its facets inside; the hole's facets stand
    // inwards.
    EXPECT_NEAR(row["eps_a_lo_mm"].get<double>(), 0.0, 1e-9);
    EXPECT_GT(row["eps_a_hi_mm"].get<double>(), 0.01);
    EXPECT_NEAR(row["eps_b_hi_mm"].get<double>(), 0.0, 1e-9);
    EXPECT_LT(row["eps_b_lo_mm"].get<double>(), -0.01);
    EXPECT_NE(html.find("Ø20 H7/k6, clearance -15.0 to 19.0 µm"), std::string::npos);
  }
  EXPECT_GT(fitted, 0U);
  EXPECT_GT(unfitted, 0U);
  // The database has the same columns.
  ASSERT_TRUE(write_sqlite(report->tables, db.path()));
  sqlite3* handle = nullptr;
  ASSERT_EQ(sqlite3_open(db.path().c_str(), &handle), SQLITE_OK);
  std::size_t found = 0;
  const auto count = [](void* to, int, char** values, char**) {
    *static_cast<std::size_t*>(to) = std::strtoul(values[0], nullptr, 10);
    return 0;
  };
  EXPECT_EQ(sqlite3_exec(handle,
                         "SELECT count(*) FROM clashes WHERE fit = 'Ø20 H7/k6' AND "
                         "part_a = 'input_shaft' AND part_b = 'gear_in' AND "
                         "round(clearance_lo_mm, 6) = -0.015 AND eps_a_hi_mm > 0.01 AND "
                         "group_id > 0",
                         count, &found, nullptr),
            SQLITE_OK);
  sqlite3_close(handle);
  EXPECT_EQ(found, fitted);
}

// The report draws each clash and each part that was touched, without any other file.
TEST_F(Export, ThePageHasPicturesAndSaysItsLimits) {
  const auto report = report_of(*log_);
  ASSERT_TRUE(report) << report.error().text;
  const Table& clashes = table_named(report->tables, "clashes");
  EXPECT_EQ(report->pictures.missing, "");
  EXPECT_EQ(report->pictures.of_clash.size(), clashes.rows.size());
  EXPECT_EQ(report->pictures.of_part.size(), 2U);
  const std::string html = html_of(*report);
  for (const auto& [clash, svg] : report->pictures.of_clash) {
    EXPECT_NE(svg.find("wall × cube"), std::string::npos);
    EXPECT_NE(html.find("id=\"clash-" + std::to_string(clash)), std::string::npos);
  }
  for (const char* section : {"Where parts were touched", "By face", "With other tolerances",
                              "Coverage", "Limits", "data:image/png;base64,iVBOR"})
    EXPECT_NE(html.find(section), std::string::npos) << section;
  EXPECT_EQ(html.find("src=\"http"), std::string::npos);
  // What is not drawn is counted.
  ReportWishes few;
  few.pictures = {0, 1};
  const auto less = report_of(*log_, few);
  ASSERT_TRUE(less);
  EXPECT_EQ(less->pictures.clashes_left_out, clashes.rows.size());
  EXPECT_EQ(less->pictures.parts_left_out, 1U);
  EXPECT_NE(html_of(*less).find("clashes are not drawn"), std::string::npos);
}

// Places of a pair are one row, and a number stands under a head of its own side.
TEST_F(Export, ThePageHasOneRowAPair) {
  auto report = report_of(*log_, {.pictures = {0, 0}, .coverage = {}, .more = {}});
  ASSERT_TRUE(report) << report.error().text;
  Table& clashes = table_named(report->tables, "clashes");
  clashes.rows.resize(1);
  for (int i = 1; i < 8; ++i) clashes.rows.push_back(clashes.rows[0]);
  const std::string html = html_of(*report);
  std::size_t rows = 0;
  for (std::size_t at = 0; (at = html.find("<tr data-class", at)) != std::string::npos; ++at)
    ++rows;
  EXPECT_EQ(rows, 1U);
  EXPECT_NE(html.find("<b>+7 places</b>"), std::string::npos);
  EXPECT_NE(html.find("<th class=\"n\">overlap</th>"), std::string::npos);
  EXPECT_NE(html.find("<div class=\"card\"><b>1</b><span class=\"letter real\""),
            std::string::npos);
}

TEST(ByFace, RealClashesComeFirst) {
  const std::vector<Table::Column> columns{{"clash"},  {"class"},  {"part_a"},       {"face_a"},
                                           {"part_b"}, {"face_b"}, {"overlap_lo_mm"}};
  const Table clashes{"clashes",
                      "",
                      columns,
                      {{1, "fake", "a", "", "b", "", 0.1},
                       {2, "real", "y", "", "z", "", 0.1},
                       {3, "potential", "c", "", "z", "", 0.1}}};
  std::string order;
  for (const auto& row : by_face_table(clashes, {}).rows) order += row[0].get<std::string>();
  EXPECT_EQ(order, "zycab");
}

// The place of a clash on a part is on the part.
TEST_F(Export, PlacesAreOnTheirParts) {
  const auto report = report_of(*log_);
  ASSERT_TRUE(report);
  ASSERT_EQ(report->pictures.touches.size(), table_named(report->tables, "clashes").rows.size());
  auto scene = scene_of(*log_);
  ASSERT_TRUE(scene);
  const Table& faces = table_named(report->tables, "by_face");
  ASSERT_GE(faces.rows.size(), 2U);
  for (const auto& row : faces.rows) {
    const Part* part = scene->world.find_part(row[0].get<std::string>());
    ASSERT_NE(part, nullptr);
    const Vec3 at(row[7].get<double>(), row[8].get<double>(), row[9].get<double>());
    const double overlap_mm = row[5].get<double>();
    EXPECT_LT(std::fabs(nearest_point(*part->solid, at).distance_mm), overlap_mm + 0.01)
        << part->name;
  }
}

TEST_F(Export, CoverageIsInTheLog) {
  const auto tables = tables_of(*log_, std::nullopt);
  ASSERT_TRUE(tables);
  const Table& coverage = table_named(*tables, "coverage");
  std::uint64_t ticks = 0, increments = 0, sent = 0;
  for (const auto& row : coverage.rows) {
    if (row[0] == "ticks") ticks = row[1].get<std::uint64_t>();
    if (row[0] == "increments_in") increments = row[1].get<std::uint64_t>();
  }
  for (const TickRecord& record : log_->ticks) sent += record.increments.size();
  EXPECT_EQ(ticks, log_->ticks.size());
  EXPECT_EQ(increments, sent);
}

// Thresholds that move as the zones do; by hand.
TEST_F(Export, WiderZonesMakeClassesPotential) {
  const auto at = [](double widening_mm) {
    return class_when_widened(0.010, 0.010, 0.004, 0.008, widening_mm);
  };
  EXPECT_EQ(at(0.0), "real");
  EXPECT_EQ(at(0.0009), "real");
  EXPECT_EQ(at(0.0011), "potential");
  EXPECT_EQ(at(-0.1), "real");  // no zone at all: one threshold at 6 µm
  EXPECT_EQ(class_when_widened(0.003, 0.003, 0.004, 0.008, 0.0), "fake");
  EXPECT_EQ(class_when_widened(0.003, 0.003, 0.004, 0.008, 0.001), "potential");
  EXPECT_EQ(class_when_widened(-0.003, -0.001, 0.004, 0.008, 0.0), "none");
}

TEST_F(Export, TheProgramWritesWhatIsAskedFor) {
  const test::TemporaryFile folder("csv"), html("r.html"), json("r.json");
  const auto quoted = [](const std::filesystem::path& path) {
    return std::string("'").append(path.string()).append("'");
  };
  const std::string log = quoted(file_->path());
  EXPECT_EQ(test::run("mortise-replay", "export " + log).exit_code, 2);
  ASSERT_EQ(test::run("mortise-replay", "export --recompute --csv " + quoted(folder.path()) +
                                            " --html " + quoted(html.path()) + " --json " +
                                            quoted(json.path()) + " " + log)
                .exit_code,
            0);
  std::ifstream in(json.path());
  const Json document = Json::parse(in, nullptr, false);
  ASSERT_TRUE(document.is_object());
  EXPECT_GT(document["tables"]["coverage"].size(), 20U);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "clashes.csv"));
  EXPECT_GT(std::filesystem::file_size(html.path()), 4000U);
  EXPECT_EQ(test::run("mortise-replay", "export --html /nowhere/r.html " + log).exit_code, 1);
  std::filesystem::remove_all(folder.path());
}

}  // namespace
}  // namespace mortise
