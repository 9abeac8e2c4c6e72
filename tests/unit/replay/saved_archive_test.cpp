// A saved session as an archive: what Save writes is taken back whole, and of strangers' archives
// nothing but such files, to no other place.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zip.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>

#include "client/saved/saved_session.h"
#include "client/saved/unpack.h"
#include "common/generators/generators.h"
#include "common/io/scenario/brought_part.h"
#include "tests/support/programs.h"
#include "tests/support/test_folder.h"
#include "tests/unit/io/step_samples.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;
using Files = std::map<std::string, std::string>;

SavedScenario sample() {
  const auto made = generate("dowel", {{"diameter_mm", 20.0}, {"length_mm", 40}, {"facets", 48}});
  EXPECT_TRUE(made) << made.error().text;
  const auto pin = brought_mesh(brought_bytes(test::ring_and_pins(), 1));
  EXPECT_TRUE(pin) << pin.error().text;
  return {.yaml = "name: sample\n",
          .meshes = {{"meshes/peg.obj", std::make_shared<const Solid>(made->mesh), false},
                     {"meshes/pin.mstp", std::make_shared<const Solid>(*pin), true}},
          .left_out = {}};
}

Files files_in(const fs::path& folder) {
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    files[entry.path().lexically_relative(folder).generic_string()] = {
        std::istreambuf_iterator<char>(in), {}};
  }
  return files;
}

class SavedArchive : public ::testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  fs::path archive_of(const Files& files) const {
    const fs::path file = path("given.zip");
    fs::remove(file);
    zip_t* zip = zip_open(file.c_str(), ZIP_CREATE | ZIP_EXCL, nullptr);
    EXPECT_NE(zip, nullptr);
    for (const auto& [name, text] : files) {
      zip_source_t* source = zip_source_buffer(zip, text.data(), text.size(), 0);
      EXPECT_GE(zip_file_add(zip, name.c_str(), source, ZIP_FL_ENC_UTF_8), 0) << name;
    }
    EXPECT_EQ(zip_close(zip), 0);
    return file;
  }
  /// Refused in one line that says this; nothing is left of it, here or elsewhere.
  void expect_refused(const fs::path& archive, const std::string& says, SavedLimits limits = {}) {
    SCOPED_TRACE(says);
    const Files before = files_in(folder_.path());
    const Status status = unpack(archive, path("out"), limits);
    ASSERT_FALSE(status);
    const std::string& text = status.error().text;
    EXPECT_NE(text.find(says), std::string::npos) << text;
    EXPECT_NE(text.find("give an archive that Save wrote"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_EQ(files_in(folder_.path()), before);
    EXPECT_FALSE(fs::exists(path("out")));
  }

  test::TestFolder folder_;
};

TEST_F(SavedArchive, HoldsTheFilesOfTheFolder) {
  const SavedScenario saved = sample();
  ASSERT_TRUE(write_folder(saved, path("folder")));
  const auto bytes = zip_of(saved);
  ASSERT_TRUE(bytes) << bytes.error().text;
  EXPECT_LT(bytes->size(), fs::file_size(path("folder") / "meshes" / "peg.obj"));
  folder_.write("saved.zip", *bytes);
  const Status done = unpack(path("saved.zip"), path("out"));
  ASSERT_TRUE(done) << done.error().text;
  EXPECT_EQ(files_in(path("out")), files_in(path("folder")));
  EXPECT_EQ(files_in(path("out")).size(), 3U);
}

TEST_F(SavedArchive, NothingGoesElsewhere) {
  for (const char* name : {"../evil.obj", "/tmp/evil.obj", "meshes/../../evil.obj",
                           "meshes/sub/evil.obj", "meshes/.obj", "meshes/.mstp", "meshes/a.b.obj",
                           "evil.sh", "meshes\\evil.obj", "Scenario.yaml"})
    expect_refused(archive_of({{"scenario.yaml", "name: x\n"}, {name, "v 0 0 0\n"}}),
                   "which no saved session has");
}

TEST_F(SavedArchive, WhatIsNoSavedSessionIsRefused) {
  folder_.write("given.zip", "no archive");
  expect_refused(path("given.zip"), "is no archive that can be read");
  expect_refused(path("nowhere.zip"), "is no archive that can be read");
  expect_refused(archive_of({{"meshes/peg.obj", "v 0 0 0\n"}}), "holds no scenario.yaml");
  // Damaged where it lies packed.
  std::string bytes = *zip_of(sample());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x5a);
  folder_.write("given.zip", bytes);
  expect_refused(path("given.zip"), "is damaged");
}

TEST_F(SavedArchive, WhatUnpacksToMoreThanIsTakenIsRefused) {
  const std::string large(std::size_t{1} << 20, 'x');
  const fs::path bomb = archive_of({{"scenario.yaml", "name: x\n"}, {"meshes/x.obj", large}});
  EXPECT_LT(fs::file_size(bomb), large.size() / 100);
  expect_refused(bomb, "unpacks to more than 1000000 bytes", {.files = 10, .bytes = 1'000'000});
  expect_refused(bomb, "holds 2 files, more than 1", {.files = 1, .bytes = 10'000'000});
}

// No reader takes a scenario of more than 16 MiB.
TEST_F(SavedArchive, AScenarioThatNobodyReadsIsRefused) {
  const std::string zeros(std::size_t{17} << 20, '\0');
  expect_refused(archive_of({{"scenario.yaml", zeros}}),
                 "scenario.yaml has more than 16777216 bytes");
}

TEST_F(SavedArchive, AFolderThatHoldsSomethingIsLeftAsItIs) {
  fs::create_directories(path("out"));
  folder_.write("out/mine.txt", "x");
  const Status status = unpack(archive_of({{"scenario.yaml", "name: x\n"}}), path("out"));
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().text.find("is not empty; name a new folder"), std::string::npos);
  EXPECT_EQ(files_in(path("out")).size(), 1U);
}

/// What the reading process says, as bytes, and what is taken of them.
class SavedArchiveWords : public SavedArchive {
 protected:
  static std::string word(char what, const std::string& bytes = "") {
    const auto size = static_cast<std::uint32_t>(bytes.size());
    std::string text(1, what);
    text.append(reinterpret_cast<const char*>(&size), sizeof size);
    return text + bytes;
  }
  Status take(const std::string& words, SavedLimits limits = {}) {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    EXPECT_EQ(write(ends[1], words.data(), words.size()), static_cast<ssize_t>(words.size()));
    close(ends[1]);
    const Status status = take_unpacked(ends[0], path("given.zip"), path("out"), limits);
    close(ends[0]);
    return status;
  }
  const std::string names_ = word('N', "scenario.yaml") + word('N', "meshes/a.obj");
  const std::string said_ = names_ + word('B', "name: x\n") + word('E') + word('B', "v 0 0 0\n") +
                            word('B', "v 1 0 0\n") + word('E') + word('D');
};

TEST_F(SavedArchiveWords, AreTakenWhereTheyAreThoseOfASavedSession) {
  const Status done = take(said_);
  ASSERT_TRUE(done) << done.error().text;
  EXPECT_EQ(files_in(path("out")),
            (Files{{"scenario.yaml", "name: x\n"}, {"meshes/a.obj", "v 0 0 0\nv 1 0 0\n"}}));
}

TEST_F(SavedArchiveWords, AreBelievedInNothing) {
  const std::string huge("N\xff\xff\xff\x7f", 5);
  const std::pair<std::string, std::string> refused[] = {
      {names_ + word('N', "meshes/../../a.obj") + word('E'), "which no saved session has"},
      {names_ + word('N', "scenario.yaml") + word('E'), "twice"},
      {names_ + word('E') + word('N', "meshes/b.obj"), "before all was read"},
      {names_ + word('E') + word('D'), "before all was read"},
      {names_ + word('E') + word('E') + word('E'), "before all was read"},
      {names_ + word('E') + word('E'), "before all was read"},
      {names_ + "X", "before all was read"},
      {names_ + huge, "before all was read"},
      {word('B', "text"), "holds no scenario.yaml"},
      {word('D'), "before all was read"},
      {"", "before all was read"},
      {word('R', "is\nmany\x1b[2Jlines"), "is many [2Jlines"}};
  for (const auto& [words, says] : refused) {
    SCOPED_TRACE(says);
    const Status status = take(words);
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().text.find(says), std::string::npos) << status.error().text;
    EXPECT_EQ(status.error().text.find('\n'), std::string::npos);
    EXPECT_FALSE(fs::exists(path("out")));
  }
  EXPECT_FALSE(take(said_, {.files = 1, .bytes = 1000}));
  EXPECT_FALSE(take(said_, {.files = 2, .bytes = 10}));
  EXPECT_TRUE(take(said_, {.files = 2, .bytes = 24}));
}

// Whatever bit of them is turned: files of the names that were given, or none.
TEST_F(SavedArchiveWords, DoNoHarmDamaged) {
  for (std::size_t bit = 0; bit < 8 * said_.size(); ++bit) {
    std::string words = said_;
    words[bit / 8] = static_cast<char>(words[bit / 8] ^ (1 << bit % 8));
    const Status status = take(words);
    if (status)
      EXPECT_EQ(files_in(path("out")).size(), 2U) << bit;
    else
      EXPECT_FALSE(fs::exists(path("out"))) << bit;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      EXPECT_EQ(entry.path().filename(), "out") << bit;
    fs::remove_all(path("out"));
  }
}

// Nobody writes into the pipe: who opens it waits.
TEST_F(SavedArchive, FoldersAndPipesAreNoArchives) {
  fs::create_directory(path("folder.zip"));
  ASSERT_EQ(mkfifo(path("pipe.zip").c_str(), 0600), 0);
  for (const char* name : {"folder.zip", "pipe.zip"})
    expect_refused(path(name), "is no archive that can be read");
}

TEST_F(SavedArchive, TheProgramSaysWhatIsWrong) {
  folder_.write("saved.zip", *zip_of(sample()));
  const auto run = [&](const std::string& words) {
    return test::run("mortise-replay", words, folder_.path());
  };
  EXPECT_EQ(run("unpack saved.zip --out kept").exit_code, 0);
  EXPECT_EQ(files_in(path("kept")).size(), 3U);
  const test::Outcome again = run("unpack saved.zip --out kept");
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_NE(again.err.find("is not empty"), std::string::npos) << again.err;
}

}  // namespace
}  // namespace mortise
