#pragma once
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

namespace mortise::test {

struct Outcome {
  int exit_code = -1;
  std::string out, err;
  /// Discarded when `out` is no JSON.
  nlohmann::json document() const { return nlohmann::json::parse(out, nullptr, false); }
};

/// Runs a program of the house as a user would, in `folder` where one is given.
inline Outcome run(const std::string& program, const std::string& arguments,
                   const std::filesystem::path& folder = ".") {
  const auto errors =
      std::filesystem::temp_directory_path() / ("mortise_stderr_" + std::to_string(getpid()));
  const std::string command = "cd '" + folder.string() + "' && " + MORTISE_BIN_DIR + "/" + program +
                              " " + arguments + " 2>" + errors.string();
  Outcome outcome;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    outcome.out.append(buffer.data(), n);
  const int status = pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  std::ifstream in(errors, std::ios::binary);
  outcome.err.assign(std::istreambuf_iterator<char>(in), {});
  std::filesystem::remove(errors);
  return outcome;
}

/// A test with a folder of its own for the files that programs read.
class InFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("mortise_test_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Writes the file; its path.
  std::string file(const std::string& name, const std::string& text) const {
    const auto path = folder_ / name;
    std::ofstream(path) << text;
    return path.string();
  }

  std::filesystem::path folder_;
};

}  // namespace mortise::test
