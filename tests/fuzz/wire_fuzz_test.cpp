// The door under broken bytes: a bounded run of the fuzz targets, from their seeds and the kept
// corpus, with mutations of our own. The same targets run under libFuzzer: see CMakeLists.txt.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/mutated.h"
#include "tests/fuzz/targets.h"
#include "tests/support/effort.h"

namespace mortise::test {
namespace {

using Target = bool (*)(std::span<const std::uint8_t>);

bool feed(Target target, const std::string& bytes) {
  return target({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

/// Seeds of today, and what was kept: inputs that once went a new way.
std::vector<std::string> corpus(const std::string& name, std::vector<std::string> seeds) {
  const auto folder = std::filesystem::path(MORTISE_SOURCE_DIR) / "tests/fuzz/corpus" / name;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  EXPECT_FALSE(files.empty()) << folder;
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return seeds;
}

void run(Target target, const std::vector<std::string>& from, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  int passed = 0;
  for (const std::string& bytes : from) (void)feed(target, bytes);
  for (int i = 0; i < count; ++i) {
    std::string bytes = mutated(from[random() % from.size()], random);
    if (random() % 4 == 0) bytes = mutated(std::move(bytes), random);
    passed += feed(target, bytes);
  }
  std::printf("%d mutated inputs, %d of them pass\n", count, passed);
  EXPECT_GT(passed, count / 100) << "hardly anything gets through: the run tests only the refusals";
  EXPECT_LT(passed, count - count / 20) << "hardly anything is refused: the mutations are too mild";
}

TEST(WireFuzz, EverySeedPasses) {
  for (const std::string& seed : wire_seeds()) EXPECT_TRUE(feed(fuzz_wire, seed)) << int{seed[0]};
  for (const std::string& seed : inbox_seeds()) EXPECT_TRUE(feed(fuzz_inbox, seed));
}

/// What programs of before said stands in tests/golden/wire, a sample of each topic; written by
/// MORTISE_RECORD_WIRE=FOLDER when a version is released, and never changed afterwards.
class WireOfBefore : public testing::Test {
 protected:
  static std::filesystem::path file(const std::filesystem::path& folder, std::size_t topic) {
    return folder / ("sample" + std::to_string(topic));
  }
  void SetUp() override {
    const std::vector<std::string> now = wire_seeds();
    if (const char* folder = std::getenv("MORTISE_RECORD_WIRE"))
      for (std::size_t i = 0; i < now.size(); ++i)
        std::ofstream(file(folder, i), std::ios::binary) << now[i];
    for (std::size_t i = 0; i < now.size(); ++i) {
      std::ifstream in(file(std::filesystem::path(MORTISE_SOURCE_DIR) / "tests/golden/wire", i),
                       std::ios::binary);
      before_.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
  }
  std::vector<std::string> before_;
};

TEST_F(WireOfBefore, IsUnderstoodByThisBuild) {
  for (const std::string& sample : before_) {
    ASSERT_FALSE(sample.empty());
    EXPECT_TRUE(feed(fuzz_wire, sample)) << "topic " << int{sample[0]};
  }
}

/// A program of before lacks what was appended since. Of these seeds the last member is empty.
TEST_F(WireOfBefore, IsUnderstoodWithoutItsLastMember) {
  int understood = 0;
  for (const std::string& sample : wire_seeds()) {
    if (!sample.ends_with(std::string(4, '\0'))) continue;
    EXPECT_TRUE(feed(fuzz_wire, sample.substr(0, sample.size() - 4))) << "topic " << int{sample[0]};
    ++understood;
  }
  EXPECT_GE(understood, 3);
}

/// New members stand at the end of a topic's struct: a reader of before finds all that it knows.
TEST_F(WireOfBefore, UnderstandsThisBuild) {
  const std::vector<std::string> now = wire_seeds();
  for (std::size_t i = 0; i < now.size(); ++i) {
    ASSERT_FALSE(before_[i].empty()) << "topic " << i;
    EXPECT_TRUE(now[i].starts_with(before_[i])) << "topic " << i << " says the same in another way";
  }
}

/// Run by hand when the wire has changed: puts today's seeds into the kept corpus.
TEST(WireFuzz, DISABLED_WriteSeeds) {
  const auto write = [](const std::string& name, const std::vector<std::string>& seeds) {
    const auto folder = std::filesystem::path(MORTISE_SOURCE_DIR) / "tests/fuzz/corpus" / name;
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      std::ofstream(folder / ("seed" + std::to_string(i)), std::ios::binary) << seeds[i];
    }
  };
  write("wire", wire_seeds());
  write("inbox", inbox_seeds());
}

TEST(WireFuzz, TheDoorHoldsUnderMutatedSamples) {
  run(fuzz_wire, corpus("wire", wire_seeds()), effort(60'000), 4242);
}

TEST(WireFuzz, TheInboxHoldsUnderMutatedScripts) {
  run(fuzz_inbox, corpus("inbox", inbox_seeds()), effort(20'000), 4243);
}

}  // namespace
}  // namespace mortise::test
