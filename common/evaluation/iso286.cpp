#include "common/evaluation/iso286.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>

#include "common/base/check.h"
#include "common/evaluation/iso286_tables.h"

namespace mortise {
namespace {

using namespace iso286;

constexpr double kMmPerUm = 1e-3;
// Letters of shafts in the order of the alphabet; those of holes are the same in capitals.
constexpr std::array<std::string_view, 28> kLetters{
    "a", "b", "c", "cd", "d", "e", "ef", "f", "fg", "g", "h", "j",  "js", "k",
    "m", "n", "p", "r",  "s", "t", "u",  "v", "x",  "y", "z", "za", "zb", "zc"};
// Up to this size (mm) the standard gives no a, b, N9 and coarser, IT14 and coarser.
constexpr double kTiny_mm = 1.0;
// Up to this size (mm) holes K ... ZC have no Delta, and k no deviation.
constexpr double kSmall_mm = kMainSteps_mm[0];

struct ClassName {
  std::string_view code;
  std::string letters;  // lower case
  bool hole = false;
  int grade = 0;  // IT01 is -1

  bool is(std::string_view x) const { return letters == x; }
};

template <std::size_t N>
std::size_t step_of(const std::array<double, N>& steps, double nominal_mm) {
  return static_cast<std::size_t>(std::lower_bound(steps.begin(), steps.end(), nominal_mm) -
                                  steps.begin());
}

double grade_um(int grade, double nominal_mm) {
  return kGrades_um[static_cast<std::size_t>(grade - kLowestGrade)]
                   [step_of(kMainSteps_mm, nominal_mm)];
}

std::string number(double x) {
  std::string text = std::to_string(x);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

Error unknown(std::string_view code, const std::string& why) {
  return fail(Code::kInvalidInput, "ISO 286 class '" + std::string(code) + "': " + why);
}

std::string shown_letters(std::string_view letters, bool hole) {
  std::string text(letters);
  if (hole)
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

// The known letters just before and after some that are not known, or have no value.
std::string nearest_letters(std::string_view letters, bool hole) {
  const auto [at, behind] = std::equal_range(kLetters.begin(), kLetters.end(), letters);
  std::string text;
  if (at != kLetters.begin()) text = shown_letters(*(at - 1), hole);
  if (behind != kLetters.end())
    text += (text.empty() ? "" : " and ") + shown_letters(*behind, hole);
  return text;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_small(char c) { return c >= 'a' && c <= 'z'; }
bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }

bool all_are(std::string_view text, bool (*kind)(char)) {
  return std::all_of(text.begin(), text.end(), kind);
}

std::optional<int> parse_grade(std::string_view digits) {
  if (digits == "01") return kLowestGrade;
  if (digits.empty() || digits.size() > 2 || !all_are(digits, is_digit) ||
      (digits.size() == 2 && digits[0] == '0'))
    return std::nullopt;
  return std::stoi(std::string(digits));
}

Result<ClassName> parse_class(std::string_view code) {
  std::size_t count = 0;
  while (count < code.size() && (is_small(code[count]) || is_capital(code[count]))) ++count;
  const std::string_view letters = code.substr(0, count), digits = code.substr(count);
  const std::optional<int> grade = parse_grade(digits);
  if (letters.empty() || letters.size() > 2 || !grade)
    return unknown(code, "write a letter and a grade, e.g. H7 or g6");
  ClassName name;
  name.code = code;
  name.hole = is_capital(letters[0]);
  name.grade = *grade;
  for (const char c : letters)
    name.letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (!all_are(letters, name.hole ? is_capital : is_small))
    return unknown(code, "write capitals for a hole, small letters for a shaft: " +
                             shown_letters(name.letters, true) + " or " + name.letters);
  if (!std::binary_search(kLetters.begin(), kLetters.end(), name.letters))
    return unknown(code, "letter '" + std::string(letters) + "' is not known; nearest known: " +
                             nearest_letters(name.letters, name.hole));
  if (name.grade > kHighestGrade)
    return unknown(code, "grade " + std::string(digits) +
                             " is not known; nearest known: " + std::to_string(kHighestGrade));
  return name;
}

// Value of a table at a size, or between which sizes the standard has none.
template <std::size_t N>
Result<double> value_um(const ClassName& name, const std::array<double, N>& steps,
                        const std::array<double, N>& row, double nominal_mm) {
  const std::size_t step = step_of(steps, nominal_mm);
  if (row[step] != kNoValue) return row[step];
  std::size_t edge = step;  // the last step without a value below one that has, or the reverse
  std::string where = "up to ";
  if (row.back() == kNoValue) {
    while (edge > 0 && row[edge] == kNoValue) --edge;
    where = "above ";
  } else {
    while (row[edge + 1] == kNoValue) ++edge;
  }
  return unknown(name.code, "the standard has no " + shown_letters(name.letters, name.hole) + " " +
                                where + number(steps[edge]) +
                                " mm; nearest known: " + nearest_letters(name.letters, name.hole));
}

// Fundamental deviation of the shaft with these letters, before the rules of grade.
Result<double> shaft_deviation_um(const ClassName& name, double nominal_mm) {
  for (const MainDeviation& row : kMainDeviations)
    if (name.is(row.letters)) return value_um(name, kMainSteps_mm, row.um, nominal_mm);
  const auto fine = std::find_if(kFineDeviations.begin(), kFineDeviations.end(),
                                 [&](const FineDeviation& row) { return name.is(row.letters); });
  MORTISE_CHECK(fine != kFineDeviations.end(), "every letter but j and js stands in a table");
  return value_um(name, kFineSteps_mm, fine->um, nominal_mm);
}

Result<Interval> limits_of_j_um(const ClassName& name, double nominal_mm) {
  const std::size_t step = step_of(kMainSteps_mm, nominal_mm);
  const double it = grade_um(name.grade, nominal_mm);
  if (name.hole) {
    if (name.grade < 6 || name.grade > 8)
      return unknown(name.code, "J has grades 6 to 8 only; use JS");
    const double upper = kHoleJ_um[static_cast<std::size_t>(name.grade - 6)][step];
    return Interval{upper - it, upper};
  }
  if (name.grade == 8 && nominal_mm <= kSmall_mm)
    return Interval{kShaftJ8UpTo3mm_um, kShaftJ8UpTo3mm_um + it};
  if (name.grade < 5 || name.grade > 7)
    return unknown(name.code, "j has grades 5 to 7 only (8 up to 3 mm); use js");
  const double lower = name.grade == 7 ? kShaftJ7_um[step] : kShaftJ56_um[step];
  return Interval{lower, lower + it};
}

// Upper deviation of K ... ZC holes from the lower one of the shaft. Up to K8, M8, N8 and P7 ...
// ZC7 a hole of grade n lies Delta = IT n - IT (n-1) higher, so that it fits the shaft of grade n -
// 1 as the hole of grade n fits that shaft in the system of basic holes.
Result<double> upper_of_hole_um(const ClassName& name, double nominal_mm, double shaft_um) {
  if (nominal_mm <= kSmall_mm) return -shaft_um;
  if (name.grade > 8 && name.is("k"))
    return unknown(name.code, "K above 3 mm has grades up to 8; nearest known: K8");
  if (name.grade > 8 && name.is("n")) return 0.0;
  // Exception of the standard: M6 above 250 up to 315 mm is -9, not -11.
  if (name.is("m") && name.grade == 6 && nominal_mm > 250.0 && nominal_mm <= 315.0) return -9.0;
  if (name.grade > (name.is("k") || name.is("m") || name.is("n") ? 8 : 7)) return -shaft_um;
  if (name.grade < 3)
    return unknown(name.code, "above 3 mm the standard has holes K to ZC from grade 3 on");
  return -shaft_um + grade_um(name.grade, nominal_mm) - grade_um(name.grade - 1, nominal_mm);
}

Result<Interval> limits_um(const ClassName& name, double nominal_mm) {
  const double it = grade_um(name.grade, nominal_mm);
  // The standard allows js7 ... js11 of an odd IT to be rounded down to whole micrometres; here
  // they are not, as in its table of deviations.
  if (name.is("js")) return Interval{-0.5 * it, 0.5 * it};
  if (name.is("j")) return limits_of_j_um(name, nominal_mm);
  const Result<double> shaft_um = shaft_deviation_um(name, nominal_mm);
  if (!shaft_um) return shaft_um.error();
  const bool clearance = name.letters[0] <= 'h';
  if (name.hole && clearance) return Interval{-*shaft_um, -*shaft_um + it};  // EI = -es
  if (name.hole) {
    const Result<double> upper_um = upper_of_hole_um(name, nominal_mm, *shaft_um);
    if (!upper_um) return upper_um.error();
    return Interval{*upper_um - it, *upper_um};
  }
  if (clearance) return Interval{*shaft_um - it, *shaft_um};
  const bool k_at_zero = name.is("k") && (name.grade < 4 || name.grade > 7);
  const double lower_um = k_at_zero ? 0.0 : *shaft_um;
  return Interval{lower_um, lower_um + it};
}

// What the standard says is not to be used at very small sizes; nothing when it may be.
std::optional<Error> refused_when_tiny(const ClassName& name, double nominal_mm) {
  if (nominal_mm > kTiny_mm) return std::nullopt;
  const std::string not_used = "not to be used up to 1 mm; nearest known: ";
  if (name.grade >= 14) return unknown(name.code, not_used + "grade 13");
  if (name.hole && name.is("n") && name.grade > 8) return unknown(name.code, not_used + "N8");
  if (name.is("a") || name.is("b"))
    return unknown(name.code, not_used + shown_letters("c", name.hole));
  return std::nullopt;
}

}  // namespace

Result<SizeLimits> iso286_limits(std::string_view code, double nominal_mm) {
  const Result<ClassName> name = parse_class(code);
  if (!name) return name.error();
  // A size that went through another unit must still meet the end of its step: 30 mm is not
  // above 30.
  nominal_mm = std::round(nominal_mm * 1e6) * 1e-6;
  const double largest_mm = kMainSteps_mm.back();
  if (!(nominal_mm > 0.0) || nominal_mm > largest_mm)
    return unknown(code, "nominal size " + number(nominal_mm) +
                             " mm is outside the table; known: above 0 up to " +
                             number(largest_mm) + " mm");
  if (const auto refused = refused_when_tiny(*name, nominal_mm)) return *refused;
  const Result<Interval> um = limits_um(*name, nominal_mm);
  if (!um) return um.error();
  SizeLimits limits;
  limits.code = std::string(code);
  limits.hole = name->hole;
  limits.nominal_mm = nominal_mm;
  limits.deviation_mm = {um->lo * kMmPerUm, um->hi * kMmPerUm};
  return limits;
}

Result<Fit> iso286_fit(std::string_view code, double nominal_mm) {
  const std::size_t slash = code.find('/');
  if (slash == std::string_view::npos)
    return fail(Code::kInvalidInput,
                "fit '" + std::string(code) + "': write hole and shaft, e.g. H7/g6");
  Result<SizeLimits> first = iso286_limits(code.substr(0, slash), nominal_mm);
  if (!first) return first.error();
  Result<SizeLimits> second = iso286_limits(code.substr(slash + 1), nominal_mm);
  if (!second) return second.error();
  if (!first->hole || second->hole)
    return fail(Code::kInvalidInput, "fit '" + std::string(code) +
                                         "': the hole (capital letter) stands first, then the "
                                         "shaft (small letter), e.g. H7/g6");
  Fit fit;
  fit.hole = std::move(first).value();
  fit.shaft = std::move(second).value();
  fit.clearance_mm = fit.hole.deviation_mm + -fit.shaft.deviation_mm;
  return fit;
}

}  // namespace mortise
