// Session logs are read by @mcap/core, the reader of the authors of the format, and give the same
// messages as were written.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/io/log/log_json.h"
#include "common/io/log/spool.h"
#include "tests/unit/io/log_samples.h"

namespace mortise {
namespace {

using nlohmann::json;
const std::string kFolder = std::string(MORTISE_SOURCE_DIR) + "/tests/unit/io/mcap_check";

struct Answer {
  int exit_code = -1;
  json found;
  std::string text;
};

Answer ask_independent_reader(const std::filesystem::path& file) {
  const std::string command = "node '" + kFolder + "/check.mjs' '" + file.string() + "' 2>&1";
  Answer answer;
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return answer;
  std::array<char, 4096> buffer;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    answer.text.append(buffer.data(), count);
  answer.exit_code = ::pclose(pipe);
  answer.found = json::parse(answer.text, nullptr, false);
  return answer;
}

class IndependentReader : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    if (std::system("node --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "program absent: node";
    if (!std::filesystem::exists(kFolder + "/node_modules/@mcap/core"))
      GTEST_SKIP() << "program absent: @mcap/core; run npm ci in tests/unit/io/mcap_check";
  }
};

TEST_P(IndependentReader, FindsWhatWasWritten) {
  const test::TemporaryFile file("independent.mcap");
  constexpr std::uint64_t kTicks = 500;
  ASSERT_TRUE(
      test::write_sample(file.path(), kTicks, {.compress = GetParam(), .chunk_bytes = 16'384}));
  std::map<std::string, std::uint64_t> expected;
  std::vector<ClashEvent> events;
  for (std::uint64_t tick = 1; tick <= kTicks; ++tick) {
    const TickRecord record = test::sample_tick(tick, 7);
    ++expected["/ticks"];
    expected["/increments"] += record.increments.empty() ? 0 : 1;
    expected["/decisions"] += record.decisions.empty() ? 0 : 1;
    expected["/poses"] += record.report.moved.empty() ? 0 : 1;
    for (const ClashEvent& event : record.report.events) events.push_back(event);
  }
  expected["/clashes"] = events.size();
  expected["/statistics"] = 9;  // 500 ticks at 60 a second: eight full seconds and the rest

  const Answer answer = ask_independent_reader(file.path());
  ASSERT_EQ(answer.exit_code, 0) << answer.text;
  const json& found = answer.found;
  EXPECT_TRUE(found["index_agrees"].get<bool>());
  EXPECT_EQ(found["topics"], json(expected));
  EXPECT_GT(found["statistics"]["chunks"], 3);
  EXPECT_EQ(found["metadata"]["mortise.session"]["session"], "sample");
  EXPECT_EQ(found["attachments"].size(), 1u + 2u + 3u);
  EXPECT_EQ(found["records"]["Attachment"], 2 * (1 + 2 + 3)) << "at the front and at the end";
  ASSERT_EQ(found["schemas"].size(), 4u);
  for (const json& schema : found["schemas"]) {
    if (schema["name"] == "mortise.Checkpoint") continue;  // not for others
    EXPECT_EQ(schema["encoding"], "jsonschema");
    EXPECT_EQ(schema["schema"]["type"], "object");
  }
  ASSERT_EQ(found["clashes"].size(), events.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    ClashEvent read;
    ASSERT_TRUE(log_json::decode(found["clashes"][i].dump(), read));
    EXPECT_EQ(log_json::first_difference(events[i], read), "");
  }
}

// The index of so many chunks is kept beside the log until its end.
TEST_P(IndependentReader, FindsWhatLiesInManyChunks) {
  const test::TemporaryFile file("many_chunks.mcap");
  ASSERT_TRUE(test::write_sample(file.path(), 800, {.compress = GetParam(), .chunk_bytes = 1}));
  const Answer answer = ask_independent_reader(file.path());
  ASSERT_EQ(answer.exit_code, 0) << answer.text.substr(0, 500);
  EXPECT_TRUE(answer.found["index_agrees"].get<bool>());
  EXPECT_EQ(answer.found["topics"]["/ticks"], 800);
  EXPECT_GT(answer.found["statistics"]["chunks"].get<std::size_t>() * 100, Spool::kBlockBytes);
}

// The check must be able to fail: one flipped bit inside a chunk.
TEST_P(IndependentReader, SeesADamagedLog) {
  const test::TemporaryFile file("independent_damaged.mcap");
  ASSERT_TRUE(test::write_sample(file.path(), 200, {.compress = GetParam()}));
  std::fstream stream(file.path(), std::ios::in | std::ios::out | std::ios::binary);
  const auto middle = static_cast<std::streamoff>(std::filesystem::file_size(file.path()) / 2);
  stream.seekg(middle);
  const char byte = static_cast<char>(stream.get() ^ 0x20);
  stream.seekp(middle);
  stream.put(byte);
  stream.close();
  EXPECT_NE(ask_independent_reader(file.path()).exit_code, 0);
}

INSTANTIATE_TEST_SUITE_P(, IndependentReader, testing::Values(true, false),
                         [](const auto& compressed) {
                           return compressed.param ? "zstd" : "plain";
                         });

}  // namespace
}  // namespace mortise
