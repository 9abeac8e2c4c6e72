#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include "tests/network/program.h"

namespace mortise::test {
namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// What systemd has to say of a unit; empty: nothing.
std::string complaints(const TestFolder& folder, const std::string& unit) {
  const std::string file = folder.write("mortise-server@demo.service", unit);
  const std::string command = "systemd-analyze verify --man=no '" + file + "' 2>&1";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string said;
  std::array<char, 512> line{};
  while (pipe && std::fgets(line.data(), static_cast<int>(line.size()), pipe.get())) {
    // Of our unit only: the machine's other units are not ours to mend.
    if (std::string(line.data()).find("mortise") != std::string::npos) said += line.data();
  }
  return said;
}

TEST(ServiceUnit, IsWhatSystemdUnderstands) {
  if (std::system("systemd-analyze --version >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "program absent: systemd-analyze";
  std::ifstream in(std::string(MORTISE_SOURCE_DIR) + "/server/mortise-server@.service");
  std::stringstream text;
  text << in.rdbuf();
  const TestFolder folder;
  // The program stands where it was built, not where it is installed.
  const std::string unit =
      replaced(text.str(), "/usr/bin/mortise-server", program_path("mortise-server").string());
  EXPECT_EQ(complaints(folder, unit), "");
  EXPECT_NE(complaints(folder, replaced(unit, "ProtectSystem=", "ProtectSystm=")), "");
  EXPECT_NE(complaints(folder, replaced(unit, "ExecStart=/", "ExecStart=/no/such")), "");
}

}  // namespace
}  // namespace mortise::test
