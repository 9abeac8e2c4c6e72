#pragma once
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "client/tools/check/check.h"
#include "common/io/step/step_import.h"
#include "tests/support/test_data.h"
#include "tests/support/test_folder.h"

namespace mortise::test {

inline void use_built_importer() {
  setenv("MORTISE_STEP_IMPORTER", MORTISE_BIN_DIR "/mortise-import-step", 1);
}

/// Runs step_maker with these words; what it printed.
inline std::string step_maker(const std::string& words) {
  const std::string command = std::string(MORTISE_BIN_DIR "/step_maker ") + words;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  std::string said;
  std::array<char, 4096> piece;
  for (std::size_t n; (n = fread(piece.data(), 1, piece.size(), pipe)) > 0;)
    said.append(piece.data(), n);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return said;
}

struct Checked {
  OpenedScene opened;
  CheckReport report;
};

inline Checked checked(const std::filesystem::path& file, const CheckOptions& options = {}) {
  use_built_importer();
  auto opened = open_assembly(file, {{}, {}, {}, AfterReading::kKeepSolids});
  EXPECT_TRUE(opened) << opened.error().text;
  Checked c{std::move(*opened), {}};
  for (const Finding& finding : c.opened.findings) EXPECT_FALSE(finding.is_error) << finding.text;
  c.report = check_scene(c.opened, options);
  return c;
}

/// The published assemblies that are valid.
inline std::vector<std::filesystem::path> open_files() {
  std::vector<std::filesystem::path> files;
  for (const char* folder : {"assemblies", "step"}) {
    std::error_code absent;
    for (const auto& entry : std::filesystem::directory_iterator(data_folder() / folder, absent))
      if (is_step_name(entry.path()) && !entry.path().filename().string().starts_with("hostile"))
        files.push_back(entry.path());
  }
  return files;
}

}  // namespace mortise::test
