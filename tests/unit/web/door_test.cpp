// Who is let in: tokens, origins, hosts; and that a flood of refusals is no flood of messages.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "client/web/admission.h"
#include "client/web/incidents.h"
#include "client/web/limits.h"
#include "client/web/tokens.h"
#include "tests/support/test_folder.h"

namespace mortise::web {
namespace {

TEST(Tokens, SayWhoTheBearerMayBe) {
  const Tokens tokens = make_tokens();
  EXPECT_EQ(tokens.designer.size(), 32u);
  EXPECT_NE(tokens.designer, tokens.observer);
  EXPECT_NE(tokens.designer, make_tokens().designer);
  ASSERT_TRUE(bearer_of(tokens, tokens.designer) && bearer_of(tokens, tokens.observer));
  EXPECT_EQ(bearer_of(tokens, tokens.designer)->role, Role::kDesigner);
  EXPECT_EQ(bearer_of(tokens, tokens.observer)->role, Role::kObserver);
  EXPECT_EQ(bearer_of(tokens, tokens.designer)->name, "");
  EXPECT_FALSE(bearer_of(tokens, ""));
  EXPECT_FALSE(bearer_of(tokens, tokens.designer + "0"));
  EXPECT_FALSE(bearer_of(tokens, tokens.designer.substr(1)));
  std::string off_by_one = tokens.designer;
  off_by_one.back() = off_by_one.back() == '0' ? '1' : '0';
  EXPECT_FALSE(bearer_of(tokens, off_by_one));
}

TEST(Tokens, AreKeptInAFileThatOnlyItsOwnerReads) {
  namespace fs = std::filesystem;
  const test::TestFolder folder;
  const fs::path file = folder.path() / "tokens";
  const auto made = tokens_of_file(file);
  ASSERT_TRUE(made) << made.error().text;
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  const auto again = tokens_of_file(file);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->designer, made->designer);
  EXPECT_EQ(again->observer, made->observer);
  for (const char* bad : {"", "short\nshort2\n", "0123456789abcdef\n0123456789abcdef\n",
                          "0123456789abcde \n0123456789abcdee\n", "0123456789abcdef\n"}) {
    std::ofstream(file) << bad;
    const auto tokens = tokens_of_file(file);
    ASSERT_FALSE(tokens) << bad;
    EXPECT_EQ(tokens.error().code, Code::kInvalidInput);
    EXPECT_NE(tokens.error().text.find(file.string()), std::string::npos);
  }
}

TEST(Tokens, AreBoundToAPersonAndARole) {
  const test::TestFolder folder;
  const std::filesystem::path file = folder.path() / "tokens";
  std::ofstream(file) << "# made by mortise keys\ndesigner anna 0123456789abcdef\n"
                         "observer ben  fedcba9876543210\n";
  const auto tokens = tokens_of_file(file);
  ASSERT_TRUE(tokens) << tokens.error().text;
  const auto anna = bearer_of(*tokens, "0123456789abcdef"),
             ben = bearer_of(*tokens, "fedcba9876543210");
  ASSERT_TRUE(anna && ben);
  EXPECT_EQ(anna->name, "anna");
  EXPECT_EQ(anna->role, Role::kDesigner);
  EXPECT_EQ(ben->name, "ben");
  EXPECT_EQ(ben->role, Role::kObserver);
  EXPECT_FALSE(bearer_of(*tokens, "")) << "there is no token for everybody";
  for (const char* bad :
       {"designer anna short\n", "server anna 0123456789abcdef\n", "designer 0123456789abcdef\n",
        "designer anna 0123456789abcdef more\n", "# nobody\n",
        "designer anna 0123456789abcdef\nobserver ben 0123456789abcdef\n"}) {
    std::ofstream(file) << bad;
    const auto none = tokens_of_file(file);
    ASSERT_FALSE(none) << bad;
    EXPECT_NE(none.error().text.find("ROLE NAME TOKEN"), std::string::npos) << none.error().text;
  }
}

TEST(Admission, KnowsItsOwnHost) {
  for (const char* own : {"127.0.0.1", "127.0.0.1:8080", "192.168.1.7:80", "localhost",
                          "LocalHost:99", "[::1]:8080", "[::1]", "cad.example:8443"})
    EXPECT_TRUE(is_own_host(own, {"cad.example"})) << own;
  for (const char* other : {"", "evil.example", "evil.example:8080", "127.0.0.1.evil.example",
                            "localhost.evil.example:1", "127.0.0.1:x", "127.0.0.1:1:2", ":80",
                            "[::1", "cad.example.:1", "127.0.0.1:123456"})
    EXPECT_FALSE(is_own_host(other, {"cad.example"})) << other;
}

TEST(Admission, KnowsItsOwnOrigin) {
  EXPECT_TRUE(is_own_origin("http://127.0.0.1:80", "127.0.0.1:80", false, {}));
  EXPECT_TRUE(is_own_origin("https://localhost:80", "localhost:80", true, {}));
  EXPECT_TRUE(is_own_origin("https://a.example", "127.0.0.1:1", false, {"https://a.example"}));
  for (const char* other : {"", "null", "http://127.0.0.1:81", "https://127.0.0.1:80",
                            "http://127.0.0.1:80.evil.example", "http://evil.example"})
    EXPECT_FALSE(is_own_origin(other, "127.0.0.1:80", false, {})) << other;
}

TEST(Admission, FindsTokens) {
  EXPECT_EQ(bearer_token("Bearer abc"), "abc");
  EXPECT_EQ(bearer_token("bearer abc"), "abc");
  EXPECT_EQ(bearer_token("Basic abc"), "");
  EXPECT_EQ(bearer_token(""), "");
  EXPECT_EQ(subprotocol_token("mortise.1, token.abc"), "abc");
  EXPECT_EQ(subprotocol_token("token.abc,mortise.1"), "abc");
  EXPECT_EQ(subprotocol_token("mortise.1"), "");
  EXPECT_FALSE(subprotocol_token("token.abc"));
  EXPECT_FALSE(subprotocol_token("mortise.2, token.abc"));
  EXPECT_FALSE(subprotocol_token(""));
  EXPECT_FALSE(subprotocol_token(",,,"));
}

TEST(Rate, LetsABurstThroughAndThenItsRate) {
  Rate rate(10.0, 20.0);
  int taken = 0;
  for (int i = 0; i < 100; ++i) taken += rate.take(1.0) ? 1 : 0;
  EXPECT_EQ(taken, 20);
  for (int i = 1; i <= 1000; ++i) taken += rate.take(1.0 + i * 0.001) ? 1 : 0;
  EXPECT_NEAR(taken, 30, 1);
}

TEST(Incidents, AreAllCountedAndSaidOnceASecond) {
  std::vector<std::string> lines;
  Incidents incidents([&](const std::string& line) { lines.push_back(line); });
  for (int i = 0; i < 1000; ++i)
    incidents.note(Incident::kWrongToken, "1.2.3.4", "wrong", 10.0 + i * 0.0005);
  incidents.note(Incident::kFlood, "1.2.3.4", "flood", 10.2);
  incidents.note(Incident::kWrongToken, "5.6.7.8", "wrong", 11.5);
  EXPECT_EQ(incidents.count(Incident::kWrongToken), 1001u);
  EXPECT_EQ(incidents.counts().at("wrong_token"), 1001u);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], "1.2.3.4: wrong");
  EXPECT_EQ(lines[2], "5.6.7.8: wrong (and 999 more of this kind)");
}

}  // namespace
}  // namespace mortise::web
