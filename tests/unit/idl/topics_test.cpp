#include "idl/topics.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace mortise {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(MORTISE_SOURCE_DIR + ("/" + path));
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(Topics, KeysGrantAllOfThem) {
  const std::string script = text_of("client/tools/keys/mortise-keys");
  for (const TopicRow& row : topic_table()) {
    const std::string way = row.among_servers ? "among_servers="
                            : row.to_server   ? "to_server="
                                              : "to_clients=";
    const std::size_t at = script.find("\n" + way);
    ASSERT_NE(at, std::string::npos) << way;
    std::istringstream words(script.substr(at, script.find("\"\n", at) - at));  // up to its end
    bool found = false;
    for (std::string word; words >> word;) found = found || word.ends_with(row.topic);
    EXPECT_TRUE(found) << row.topic << " is not granted by " << way;
  }
}

TEST(Topics, ReadmePrintsTheTable) {
  EXPECT_NE(text_of("idl/README.md").find("\n\n" + topic_table_markdown() + "\n"),
            std::string::npos)
      << "idl/README.md must hold this table:\n"
      << topic_table_markdown();
}

TEST(Topics, TheTableKeepsItsRules) {
  for (const TopicRow& row : topic_table()) {
    SCOPED_TRACE(row.topic);
    EXPECT_GE(row.writer_depth, 1);
    EXPECT_GE(row.reader_depth, row.writer_depth);
    EXPECT_GE(row.max_keys, 1);
    EXPECT_EQ(*row.key == '\0', row.max_keys == 1);
    // The tick never waits for a socket, but to have told a second server before it acknowledges.
    EXPECT_EQ(row.asynchronous, !row.to_server && !row.among_servers);
    EXPECT_TRUE(row.reliable || !row.transient_local);
    // A reader that keeps all pushes back, which only a client may be made to feel.
    EXPECT_TRUE(row.to_server || row.among_servers || row.reader == TopicRow::Reader::kKeepLast);
  }
  EXPECT_TRUE(row_of(Topic::kPresence).presence);
  EXPECT_STREQ(row_of(Topic::kPulse).topic, "mortise_pulse");
}

}  // namespace
}  // namespace mortise
