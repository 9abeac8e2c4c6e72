#include "common/io/mesh/importer/written_digits.h"

#include <assimp/fast_atof.h>
#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <limits>

namespace mortise {
namespace {

/// More digits than this tell no more than a double holds; fewer than that are a design.
constexpr int kFewDigits = 6, kManyDigits = 15;

/// So many different coordinates that use the last digit are no design in round numbers.
constexpr std::size_t kEnough = 20;

/// A float written with nine digits comes back this near.
constexpr double kFloatLike = 5e-9;

/// What assimp's header throws where it finds no number; its own exception is not in its library.
struct NoNumber : std::exception {
  template <class... Words>
  explicit NoNumber(Words&&...) {}
};

const char* skip_blanks(const char* at) {
  while (*at != '\0' && std::isspace(static_cast<unsigned char>(*at)) != 0) ++at;
  return at;
}

/// The three numbers after the keyword of a line, as written and as assimp reads them. False: there
/// are not three, or a fourth that is a weight.
bool numbers_of(const char* at, Triple& written, std::array<float, 3>& read) {
  int count = 0;
  for (at = skip_blanks(at); *at != '\0' && count < 8; at = skip_blanks(at)) {
    char* end = nullptr;
    const double x = std::strtod(at, &end);
    if (end == at || !std::isfinite(x)) break;
    if (count < 3) {
      float f = 0.0F;
      try {
        Assimp::fast_atoreal_move<float, NoNumber>(at, f);
      } catch (const NoNumber&) {
        return false;
      }
      written[static_cast<std::size_t>(count)] = x;
      read[static_cast<std::size_t>(count)] = f;
    }
    ++count;
    at = end;
  }
  return count >= 3 && count != 4;
}

/// 10^exponent, the same on every machine: exact up to 22.
double power_of_ten(int exponent) {
  double power = 1.0;
  for (int i = 0; i < std::abs(exponent); ++i) power *= 10.0;
  return exponent < 0 ? 1.0 / power : power;
}

/// The place of the first digit of a number > 0: 2 of 123.
int decade_of(double x) {
  int decade = 0;
  while (x >= power_of_ten(decade + 1)) ++decade;
  while (x < power_of_ten(decade)) --decade;
  return decade;
}

/// Are all coordinates decimal with so many digits? `fine`: different ones that use the last digit.
bool has_digits(const std::vector<Triple>& coordinates, int digits, double slack,
                std::size_t& fine) {
  std::vector<double> found;
  for (const Triple& triple : coordinates)
    for (const double coordinate : triple) {
      const double x = std::abs(coordinate);
      if (x < std::numeric_limits<float>::min()) continue;
      const int places = digits - 1 - decade_of(x);
      const double steps = places < 0 ? x / power_of_ten(-places) : x * power_of_ten(places);
      const double whole = std::round(steps);
      if (std::abs(steps - whole) > slack * steps) return false;
      // Its last digit is not zero: written with so many places, no fewer.
      if (std::fmod(whole, 10.0) > 0.5) found.push_back(x);
    }
  std::sort(found.begin(), found.end());
  fine = static_cast<std::size_t>(std::unique(found.begin(), found.end()) - found.begin());
  return true;
}

}  // namespace

double half_ulp(double x) {
  const float magnitude = std::abs(static_cast<float>(x));
  return 0.5 * (static_cast<double>(std::nextafter(magnitude, std::numeric_limits<float>::max())) -
                static_cast<double>(magnitude));
}

WrittenDigits::Key WrittenDigits::key_of(float x, float y, float z) {
  const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f + 0.0F); };  // no -0
  return {bits(x), bits(y), bits(z)};
}

std::size_t WrittenDigits::Hash::operator()(const Key& key) const {
  std::uint64_t hash = 0;
  for (const std::uint32_t bits : key) hash = (hash ^ bits) * 0x9e3779b97f4a7c15ULL;
  return hash ^ (hash >> 32U);
}

WrittenDigits::WrittenDigits(const std::string& text, const std::string& extension) {
  const std::string keyword = extension == ".obj" ? "v" : extension == ".stl" ? "vertex" : "";
  if (keyword.empty()) return;
  std::string line;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    line.assign(text, from, end - from);
    from = end + 1;
    if (line.find('\0') != std::string::npos) return;  // binary
    const char* at = skip_blanks(line.c_str());
    if (line.compare(static_cast<std::size_t>(at - line.c_str()), keyword.size(), keyword) != 0)
      continue;
    at += keyword.size();
    Triple written{};
    std::array<float, 3> read{};
    if (std::isspace(static_cast<unsigned char>(*at)) == 0 || !numbers_of(at, written, read))
      continue;
    const auto [found, fresh] = of_.try_emplace(key_of(read[0], read[1], read[2]), Found{written});
    if (!fresh && found->second.written != written) found->second.several = true;
  }
}

const Triple* WrittenDigits::find(float x, float y, float z) const {
  const auto found = of_.find(key_of(x, y, z));
  return found == of_.end() || found->second.several ? nullptr : &found->second.written;
}

double written_quantum(const std::vector<Triple>& coordinates, double slack) {
  double largest = 0.0;
  bool floats = true;
  for (const Triple& triple : coordinates)
    for (const double x : triple) {
      largest = std::max(largest, std::abs(x));
      floats = floats &&
               std::abs(x - static_cast<double>(static_cast<float>(x))) <= kFloatLike * std::abs(x);
    }
  if (largest == 0.0) return 0.0;
  const double least = floats ? half_ulp(largest) : 0.0;
  for (int digits = kFewDigits; digits <= kManyDigits; ++digits) {
    const double unit = power_of_ten(decade_of(largest) - digits + 1);
    if (slack * largest > 0.25 * unit) break;  // any number would do
    std::size_t fine = 0;
    if (!has_digits(coordinates, digits, slack, fine)) continue;
    return fine < kEnough ? least : std::max(least, 0.5 * unit);
  }
  return least;
}

}  // namespace mortise
