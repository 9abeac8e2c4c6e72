// The archive of issues: what a BCF 3.0 reader expects, checked by xmllint against schemas, and
// numbers that are those of the tables.
#include "client/report/bcf.h"

#include <gtest/gtest.h>
#include <zip.h>

#include <cstdlib>
#include <fstream>
#include <pugixml.hpp>

#include "client/report/pair_groups.h"
#include "tests/golden/played_session.h"
#include "tests/support/programs.h"
#include "tests/unit/io/log_samples.h"

namespace mortise {
namespace {

std::map<std::string, std::string> entries_of(const std::filesystem::path& file) {
  std::map<std::string, std::string> entries;
  zip_t* zip = zip_open(file.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, nullptr);
  EXPECT_NE(zip, nullptr);
  if (zip == nullptr) return entries;
  for (zip_int64_t i = 0; i < zip_get_num_entries(zip, 0); ++i) {
    zip_stat_t stat;
    zip_stat_index(zip, static_cast<zip_uint64_t>(i), 0, &stat);
    std::string bytes(stat.size, '\0');
    zip_file_t* entry = zip_fopen_index(zip, static_cast<zip_uint64_t>(i), 0);
    EXPECT_EQ(zip_fread(entry, bytes.data(), bytes.size()), static_cast<zip_int64_t>(bytes.size()));
    zip_fclose(entry);
    entries[stat.name] = bytes;
  }
  zip_discard(zip);
  return entries;
}

std::string schema_of(const std::string& name) {
  if (name == "bcf.version") return "version";
  if (name == "project.bcfp") return "project";
  if (name == "extensions.xml") return "extensions";
  return name.ends_with("markup.bcf") ? "markup" : name.ends_with(".bcfv") ? "visinfo" : "";
}

bool has_xmllint() { return std::system("xmllint --version >/dev/null 2>&1") == 0; }

// By our schema, and by those of buildingSMART where a folder with them is named.
bool is_valid(const std::string& name, const std::string& xml) {
  const test::TemporaryFile file("bcf.xml");
  std::ofstream(file.path(), std::ios::binary) << xml;
  const std::string schema = schema_of(name);
  std::string command = "xmllint --noout --relaxng '" + std::string(MORTISE_SOURCE_DIR) +
                        "/tests/unit/replay/bcf/" + schema + ".rng' '" + file.path().string() + "'";
  if (const char* folder = std::getenv("MORTISE_BCF_XSD"))
    command += " && xmllint --noout --schema '" + std::string(folder) + "/" + schema + ".xsd' '" +
               file.path().string() + "'";
  return std::system(("{ " + command + "; } 2>/dev/null").c_str()) == 0;
}

class Bcf : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const std::string folder = std::string(MORTISE_SOURCE_DIR) + "/scenarios/thin_wall";
    auto session = test::play_session(folder + ".yaml", folder + ".play.yaml");
    ASSERT_TRUE(session) << session.error().text;
    const test::TemporaryFile file("bcf.mcap");
    ASSERT_TRUE(test::write_log(*session, file.path()));
    auto log = read_session_log(file.path());
    ASSERT_TRUE(log);
    // Somebody has looked at it, and writes what XML must not take for its own.
    ASSERT_FALSE(log->ticks.empty());
    for (TickRecord& record : log->ticks)
      for (ClashEvent& event : record.report.events)
        event.review = {ReviewStatus::kReviewed, "a <b> & \x01 \"c\"", UserId{1}, event.tick};
    log_ = std::make_unique<SessionLog>(std::move(*log));
    ReportWishes wishes;
    wishes.pictures.png = true;
    auto report = report_of(*log_, wishes);
    ASSERT_TRUE(report) << report.error().text;
    report_ = std::make_unique<SessionReport>(std::move(*report));
  }
  static void TearDownTestSuite() { log_.reset(), report_.reset(); }
  void SetUp() override { ASSERT_NE(report_, nullptr); }
  static inline std::unique_ptr<SessionLog> log_;
  static inline std::unique_ptr<SessionReport> report_;
};

TEST_F(Bcf, EveryFileIsValid) {
  if (!has_xmllint()) GTEST_SKIP() << "program absent: xmllint (libxml2-utils)";
  const test::TemporaryFile file("issues.bcf");
  ASSERT_TRUE(write_bcf(*report_, *log_, file.path()));
  const auto entries = entries_of(file.path());
  std::size_t checked = 0;
  for (const auto& [name, bytes] : entries) {
    if (name.ends_with(".png")) {
      EXPECT_EQ(bytes.substr(1, 3), "PNG") << name;
      continue;
    }
    EXPECT_TRUE(is_valid(name, bytes)) << name << "\n" << bytes;
    ++checked;
  }
  const std::size_t pairs = pair_groups(table_named(report_->tables, "clashes")).size();
  ASSERT_GT(pairs, 0U);
  EXPECT_EQ(checked, 3 + 2 * pairs);
  EXPECT_EQ(entries.size(), 3 + 3 * pairs);
}

// The schemas do refuse.
TEST_F(Bcf, WhatIsWrongIsNotValid) {
  if (!has_xmllint()) GTEST_SKIP() << "program absent: xmllint (libxml2-utils)";
  const test::TemporaryFile file("issues.bcf");
  ASSERT_TRUE(write_bcf(*report_, *log_, file.path()));
  const std::pair<const char*, std::pair<const char*, const char*>> faults[] = {
      {"markup.bcf", {"TopicStatus", "Status"}},
      {"markup.bcf", {"<Title>", "<Title> </Title><Title>"}},
      {"markup.bcf", {"<CreationDate>", "<CreationDate>x"}},
      {"viewpoint.bcfv", {"AspectRatio", "Aspect"}},
      {"viewpoint.bcfv", {"Guid=\"", "Guid=\"X"}},
      {"bcf.version", {"3.0", "2.1"}},
      {"extensions.xml", {"TopicTypes", "Types"}},
      {"project.bcfp", {"ProjectId", "Id"}}};
  for (const auto& [of, fault] : faults) {
    bool found = false;
    for (auto [name, bytes] : entries_of(file.path())) {
      if (!name.ends_with(of)) continue;
      found = true;
      ASSERT_NE(bytes.find(fault.first), std::string::npos) << name;
      for (std::size_t at = 0; (at = bytes.find(fault.first, at)) != std::string::npos;
           at += std::string(fault.second).size())
        bytes.replace(at, std::string(fault.first).size(), fault.second);
      EXPECT_FALSE(is_valid(name, bytes)) << name << ": " << fault.first;
    }
    EXPECT_TRUE(found) << of;
  }
}

TEST_F(Bcf, TopicsSayWhatTheTablesSay) {
  const test::TemporaryFile file("issues.bcf"), again("again.bcf");
  ASSERT_TRUE(write_bcf(*report_, *log_, file.path()));
  EXPECT_FALSE(write_bcf(*report_, *log_, file.path()));  // never over what is there
  ASSERT_TRUE(write_bcf(*report_, *log_, again.path()));
  const auto entries = entries_of(file.path());
  EXPECT_EQ(entries, entries_of(again.path()));  // the same names: an update, not another issue
  std::size_t topics = 0;
  for (const auto& [name, bytes] : entries) {
    if (!name.ends_with("markup.bcf")) continue;
    ++topics;
    pugi::xml_document document;
    ASSERT_TRUE(document.load_buffer(bytes.data(), bytes.size()));
    const pugi::xml_node topic = document.child("Markup").child("Topic");
    EXPECT_EQ(name, std::string(topic.attribute("Guid").value()) + "/markup.bcf");
    EXPECT_STREQ(topic.attribute("TopicStatus").value(), "reviewed");
    EXPECT_TRUE(std::string(topic.child("Title").text().get()).starts_with("real: wall × cube"));
    EXPECT_STREQ(topic.child("Comments").child("Comment").child("Comment").text().get(),
                 "a <b> &  \"c\"");
    EXPECT_TRUE(entries.contains(
        std::string(topic.attribute("Guid").value()) + "/" +
        topic.child("Viewpoints").child("ViewPoint").child("Snapshot").text().get()));
  }
  EXPECT_EQ(topics, pair_groups(table_named(report_->tables, "clashes")).size());
}

// However many places a pair has, it is one issue; what was said of any of them is kept.
TEST_F(Bcf, APairIsOneTopic) {
  SessionReport report = *report_;
  Table& clashes = table_named(report.tables, "clashes");
  clashes.rows.resize(1);
  for (std::uint64_t i = 1; i < 8; ++i) {
    clashes.rows.push_back(clashes.rows[0]);
    clashes.rows.back()[0] = clashes.rows[0][0].get<std::uint64_t>() + i;
  }
  const test::TemporaryFile file("pair.bcf");
  ASSERT_TRUE(write_bcf(report, *log_, file.path()));
  std::size_t topics = 0;
  for (const auto& [name, bytes] : entries_of(file.path())) {
    if (!name.ends_with("markup.bcf")) continue;
    ++topics;
    EXPECT_NE(bytes.find("wall × cube (+7 places)</Title>"), std::string::npos) << bytes;
    EXPECT_TRUE(!has_xmllint() || is_valid(name, bytes)) << bytes;
    pugi::xml_document document;
    ASSERT_TRUE(document.load_buffer(bytes.data(), bytes.size()));
    const auto comments = document.child("Markup").child("Topic").child("Comments").children();
    EXPECT_EQ(std::distance(comments.begin(), comments.end()), 8);
  }
  EXPECT_EQ(topics, 1U);
}

}  // namespace
}  // namespace mortise
