#include "server/console.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdio>

namespace mortise {
namespace {

/// What a console prints, and what is seen of it on a terminal.
class ConsoleTest : public ::testing::Test {
 protected:
  ~ConsoleTest() override { std::fclose(out_); }
  std::shared_ptr<Console> console(ConsoleStyle style) {
    return std::make_shared<Console>(out_, [style] { return style; });
  }
  static void say(Console& console, LogLevel level, const char* text) {
    console.take({level, std::chrono::system_clock::now(), "server", text});
  }
  std::string printed() {
    std::fflush(out_);
    std::string text(static_cast<std::size_t>(std::ftell(out_)), '\0');
    std::rewind(out_);
    EXPECT_EQ(std::fread(text.data(), 1, text.size(), out_), text.size());
    return text;
  }
  // Rows of a terminal so wide, after what was printed: \r, \n, up by rows, erase below.
  std::vector<std::string> seen(std::size_t columns) {
    std::vector<std::string> rows{""};
    std::size_t row = 0, column = 0;
    const std::string text = printed();
    const auto next_row = [&] {
      if (++row == rows.size()) rows.emplace_back();
      column = 0;
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\r') {
        column = 0;
      } else if (text[i] == '\n') {
        next_row();
      } else if (text.compare(i, 2, "\033[") == 0) {
        const std::size_t end = text.find_first_of("AJm", i);
        const std::string count = text.substr(i + 2, end - i - 2);
        if (text[end] == 'A') row -= std::stoul(count);
        if (text[end] == 'J') {
          rows.resize(row + 1);
          rows[row].resize(column);
        }
        i = end;
      } else {
        if (column == columns) next_row();
        rows[row].resize(std::max(rows[row].size(), column + 1), ' ');
        rows[row][column++] = text[i];
      }
    }
    return rows;
  }
  std::FILE* out_ = std::tmpfile();
};

TEST_F(ConsoleTest, BeginsNewsWithItsOwnFirstWordOnATerminal) {
  const auto made = console({.terminal = true, .columns = 100});
  say(*made, LogLevel::kInfo, "REAL  cover × bearing");
  say(*made, LogLevel::kWarning, "overload");
  say(*made, LogLevel::kError, "no room");
  EXPECT_EQ(printed(), "REAL  cover × bearing\nwarning: overload\nerror: no room\n");
}

TEST_F(ConsoleTest, KeepsTheTimeOfDayInAFile) {
  const auto made = console({});
  say(*made, LogLevel::kInfo, "REAL  cover × bearing");
  const std::string line = printed();
  ASSERT_EQ(line.size(), std::string("12:30:01 REAL  cover × bearing\n").size());
  EXPECT_EQ(line[2], ':');
  EXPECT_EQ(line.substr(9), "REAL  cover × bearing\n");
}

TEST_F(ConsoleTest, ColoursWarningsOnlyWhereColoursAreWanted) {
  const auto made = console({.terminal = true, .color = true});
  say(*made, LogLevel::kWarning, "overload");
  EXPECT_EQ(printed(), "\033[33;1mwarning\033[0m: overload\n");
}

TEST_F(ConsoleTest, HasLinesThatStayBelowAllMessages) {
  const auto made = console({.terminal = true, .columns = 20});
  made->stay({"1.0 s, 0 users and more than fits", "http://a.long/address"});  // two rows each
  say(*made, LogLevel::kInfo, "ann joined");
  made->stay({"2.0 s", "http://a.long/address"});
  say(*made, LogLevel::kInfo, "REAL  a × b");
  EXPECT_EQ(seen(20), (std::vector<std::string>{"ann joined", "REAL  a × b", "2.0 s",
                                                "http://a.long/addres", "s"}));
}

TEST_F(ConsoleTest, LeavesThemBehindAtTheEnd) {
  const auto made = console({.terminal = true, .columns = 80});
  made->stay({"0.5 s", "http://x"});
  made->stay({"1.0 s", "http://x"});
  made->leave();
  say(*made, LogLevel::kInfo, "ended");
  EXPECT_EQ(seen(80), (std::vector<std::string>{"1.0 s", "http://x", "ended", ""}));
}

TEST_F(ConsoleTest, HasNoLinesThatStayInAFile) {
  const auto made = console({});
  made->stay({"1.0 s"});
  made->leave();
  EXPECT_EQ(printed(), "");
}

TEST(ConsoleStyle, HasNoColoursWhereTheyAreNotWantedOrThereIsNoTerminal) {
  setenv("NO_COLOR", "1", 1);
  EXPECT_FALSE(style_of_stderr().color);
  unsetenv("NO_COLOR");
  EXPECT_EQ(style_of_stderr().color, style_of_stderr().terminal);
}

}  // namespace
}  // namespace mortise
