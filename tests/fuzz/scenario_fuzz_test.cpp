// Mutated scenarios, from the file to the verdict: a scenario is used or refused with findings of
// one line each, in bounded time, and nothing behind the reader falls over what it let through. For
// MORTISE_SOAK_S seconds where that is set.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string_view>

#include "tests/fuzz/mutated.h"
#include "tests/fuzz/targets.h"
#include "tests/support/effort.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {
namespace {

// Everything that a scenario may say, small.
constexpr const char* kRich = R"(name: rich
units: mm
tick_rate_hz: 60
policy: slide
max_jump: 50
lease_s: 5
deviation: recognized
parts:
  - name: plate
    generator: {kind: plate_with_bore, bore: 20, facets: 8}
    pose: {position: [0, 0, 1], rotation_deg: [0, 0, 30]}
    tolerance: "±0.05"
    features:
      bore: {iso: H7, position: {zone: 0.05, at: mmc}}
  - name: peg
    generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 8, phase_deg: 5.6}
    moving: true
    pose: {position: [0, 0, -10], axis_angle: {axis: [0, 0, 1], angle_deg: 10}}
    features:
      journal: {tolerance: {profile: 0.02, unequal: 0.01}}
  - name: solid
    mesh: {file: a.stl, unit: in, scale: 0.5}
    chord_error: 0.01
    pose: {position: [5, 5, 5], quaternion: [1, 0, 0, 0]}
    deviation: none
    features:
      floor: {kind: plane, point: [0, 0, 0], axis: [0, 0, -1], tolerance: {lower: -0.01, upper: 0.02}}
      side: {kind: plane, point: [0, 0, 0], axis: [-1, 0, 0]}
  - name: row
    generator: {kind: block, x: 4, y: 4, z: 4}
    repeat: {count: [2, 2, 1], step: [4, 5, 0]}
  - generator: {kind: block, x: 3, y: 3, z: 3}
    instances:
      - {name: one, pose: {position: [30, 0, 0]}}
      - {name: two, pose: {position: [31, 0, 0]}, moving: true}
fits:
  - {between: [plate.bore, peg.journal], code: Ø20 H7/g6}
  - {between: [one, "t*"], plus_minus: 0.02}
exclusions:
  - {between: [row_1, solid], reason: of another line}
users:
  - {name: ann, may_hold: ["*"], may: [policy, review], role: designer}
  - {name: eve, may_hold: []}
)";

// What goes wrong in numbers and words, and what has a meaning in YAML.
constexpr std::array<std::string_view, 44> kWords = {
    "0",         "-1",       "1e-300",    "1e300",       "1e15",     "-1e9",  "1e9",         "1e12",
    "1e-7",      ".nan",     ".inf",      "4294967296",  "1e-12",    "~",     "true",        "[]",
    "{}",        "''",       "\"\\x01\"", "\"\\u202e\"", "J\xe4ger", "Jäger", "&a x",        "*a",
    "<<",        "!!binary", "|",         ">",           "- ",       "? ",    ": ",          "#",
    "\t",        "\r\n",     "*",         ".",           "H7/g6",    "±0.1",  "profile 0.2", "a.b",
    "[1, 2, 3]", "stop",     "0x10",      "Ø0"};

// Numbers that an honest scenario may hold: most of these results are judged.
constexpr std::array<std::string_view, 14> kNumbers = {
    "0.5", "1", "3", "8", "20", "-10", "90", "0.001", "1000", "0", "2e-6", "7.8e6", "1e8", "-0.02"};

std::size_t below(std::mt19937_64& random, std::size_t n) { return n == 0 ? 0 : random() % n; }

bool in_word(char c) {
  return c > ' ' && std::string_view("[]{},:\"'").find(c) == std::string_view::npos;
}

// One to three changes of words and lines, so that most results are still YAML.
std::string mutated_words(std::string text, std::mt19937_64& random) {
  for (std::size_t changes = 1 + below(random, 3); changes > 0 && !text.empty(); --changes) {
    std::size_t at = below(random, text.size());
    const auto line_end = [&](std::size_t from) {
      return std::min(text.find('\n', from), text.size() - 1) + 1;
    };
    const std::size_t begin = text.rfind('\n', at) + 1;  // npos + 1 is the first line
    const std::size_t kind = below(random, 10);
    switch (kind) {
      case 0:
      case 1:
      case 2:
      case 3:
      case 4:
      case 5: {  // another word, or a number for a number
        while (at > 0 && !in_word(text[at])) --at;
        std::size_t first = at, last = at;
        while (first > 0 && in_word(text[first - 1])) --first;
        while (last < text.size() && in_word(text[last])) ++last;
        const bool is_number = first < text.size() && text[first] >= '0' && text[first] <= '9';
        text.replace(first, last - first,
                     kind > 1 && is_number ? kNumbers[below(random, kNumbers.size())]
                     : kind > 1            ? text.substr(first, last - first)
                                           : kWords[below(random, kWords.size())]);
        break;
      }
      case 6:  // a line less
        text.erase(begin, line_end(at) - begin);
        break;
      case 7: {  // a line twice, or somewhere else
        const std::string line = text.substr(begin, line_end(at) - begin);
        const std::size_t to = text.rfind('\n', below(random, text.size())) + 1;
        text.insert(to, line);
        break;
      }
      default:  // deeper or less deep
        if (begin < text.size() && text[begin] == ' ')
          text.erase(begin, 2);
        else
          text.insert(begin, "  ");
    }
  }
  return text;
}

bool feed(const std::string& bytes) {
  return fuzz_scenario({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

std::vector<std::string> seeds() { return {kRich, blocks_yaml(), peg_yaml()}; }

// What falls over is left behind in the file that MORTISE_LAST names.
void keep(const std::string& bytes) {
  static const char* const file = std::getenv("MORTISE_LAST");
  if (file != nullptr) std::ofstream(file, std::ios::binary) << bytes;
}

double soak_s() {
  const char* seconds = std::getenv("MORTISE_SOAK_S");
  return seconds != nullptr ? std::atof(seconds) : 0.0;
}

double seconds_since(std::chrono::steady_clock::time_point begun) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

TEST(ScenarioFuzz, TheSeedsAreUsable) {
  for (const std::string& seed : seeds()) EXPECT_TRUE(feed(seed)) << seed.substr(0, 40);
}

TEST(ScenarioFuzz, MutatedScenariosAreUsedOrRefused) {
  std::mt19937_64 random(20'261'125);
  const std::vector<std::string> from = seeds();
  const int at_least = effort(300);
  const auto first = std::chrono::steady_clock::now();
  int count = 0, used = 0, slowest = 0;
  double slowest_s = 0.0;
  for (; count < at_least || seconds_since(first) < soak_s(); ++count) {
    const std::string& seed = from[below(random, from.size())];
    std::string bytes = mutated_words(seed, random);
    if (below(random, 4) == 0) bytes = mutated(std::move(bytes), random);
    keep(bytes);
    const std::clock_t begun = std::clock();  // of processors: others may use them too
    used += feed(bytes);
    const double took_s = static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
    if (took_s <= slowest_s) continue;
    slowest_s = took_s;
    slowest = count;
  }
  std::printf("%d mutated scenarios in %.1f s, %d usable; number %d took longest, %.2f s of CPU\n",
              count, seconds_since(first), used, slowest, slowest_s);
  EXPECT_GE(seconds_since(first), soak_s());
  EXPECT_GT(used, count / 20) << "hardly anything gets through: only refusals are tested";
  EXPECT_LT(used, count - count / 20) << "the mutations are too mild";
  if (timed()) {
    EXPECT_LT(slowest_s, 5.0);
  }
}

}  // namespace
}  // namespace mortise::test
