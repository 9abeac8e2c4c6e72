// The session as tables: CSV, JSON, SQLite and HTML say the same, and say it safely.
#include "client/replay/export.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
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
  EXPECT_TRUE(table_named(*tables, "coverage").rows.empty());
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
    EXPECT_EQ(count(table.name), static_cast<std::int64_t>(table.rows.size()))
        << table.name;
  for (const char* view : {"v_open", "v_to_review", "v_worst_by_pair", "v_by_user", "v_timeline"})
    EXPECT_GE(count(view), 0) << view;
  EXPECT_EQ(count("clashes WHERE class = 'real' AND overlap_lo_mm > 0"),
            count("clashes WHERE class = 'real'"));
}

// Names come from people: none of them becomes a tag, a formula of the page or another field.
TEST_F(Export, TextOfPeopleStaysText) {
  auto tables = tables_of(*log_, std::nullopt);
  ASSERT_TRUE(tables);
  const std::string evil = "</script><img src=x onerror=alert(1)>\",\"a\r\nb";
  for (Table& table : *tables)
    for (auto& row : table.rows)
      for (std::size_t i = 0; i < row.size(); ++i)
        if (table.columns[i].type == Table::Type::kText && table.columns[i].name != "class" &&
            table.columns[i].name != "key")
          row[i] = evil;
  const std::string html = html_of(*tables, evil);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_NE(html.find("&lt;img"), std::string::npos);
  EXPECT_EQ(html.find("http"), std::string::npos) << "the page needs the network";
  const auto lines = fields_of(csv_of(table_named(*tables, "clashes")));
  for (const auto& line : lines) EXPECT_EQ(line.size(), lines[0].size());
  EXPECT_NE(std::find(lines[1].begin(), lines[1].end(), evil), lines[1].end());
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
