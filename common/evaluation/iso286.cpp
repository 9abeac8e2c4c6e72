#include "common/evaluation/iso286.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>

#include "common/evaluation/iso286_tables.h"

namespace mortise {
namespace {

using namespace iso286;

constexpr double kMmPerUm = 1e-3;
constexpr std::string_view kShaftLetters = "abcdefghjkmnprstu";  // js stands beside j

struct ClassName {
  std::string letters;  // as written: "H", "js"
  char letter = 0;      // lower case, 'j' for js too
  bool js = false;
  bool hole = false;
  int grade = 0;
};

template <std::size_t N>
std::size_t step_of(const std::array<double, N>& steps, double nominal_mm) {
  return static_cast<std::size_t>(std::lower_bound(steps.begin(), steps.end(), nominal_mm) -
                                  steps.begin());
}

double grade_um(int grade, double nominal_mm) {
  return kGrades_um[grade - kLowestGrade][step_of(kMainSteps_mm, nominal_mm)];
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

// The known letters just before and after one that is not known.
std::string nearest_letters(char letter, bool hole) {
  const auto shown = [&](char c) {
    return std::string(1, hole ? static_cast<char>(std::toupper(c)) : c);
  };
  const auto after = std::lower_bound(kShaftLetters.begin(), kShaftLetters.end(), letter);
  std::string text;
  if (after != kShaftLetters.begin()) text = shown(*(after - 1));
  if (after != kShaftLetters.end()) text += (text.empty() ? "" : " and ") + shown(*after);
  return text;
}

Result<ClassName> parse_class(std::string_view code) {
  std::size_t letters = 0;
  while (letters < code.size() && std::isalpha(static_cast<unsigned char>(code[letters])) != 0)
    ++letters;
  const std::string_view digits = code.substr(letters);
  const bool numeric = !digits.empty() && digits.size() <= 2 &&
                       std::all_of(digits.begin(), digits.end(), [](char c) {
                         return std::isdigit(static_cast<unsigned char>(c)) != 0;
                       });
  if (letters == 0 || letters > 2 || !numeric)
    return unknown(code, "write a letter and a grade, e.g. H7 or g6");

  ClassName name;
  name.letters = std::string(code.substr(0, letters));
  name.hole = std::isupper(static_cast<unsigned char>(code[0])) != 0;
  name.letter = static_cast<char>(std::tolower(static_cast<unsigned char>(code[0])));
  name.grade = std::stoi(std::string(digits));
  name.js = name.letters == "js" || name.letters == "JS";
  if (letters == 2 && !name.js)
    return unknown(code, "letter '" + name.letters + "' is not known; nearest known: " +
                             nearest_letters(name.letter, name.hole) + ", and js/JS");
  if (kShaftLetters.find(name.letter) == std::string_view::npos)
    return unknown(code, "letter '" + name.letters + "' is not known; nearest known: " +
                             nearest_letters(name.letter, name.hole));
  if (name.grade < kLowestGrade || name.grade > kHighestGrade)
    return unknown(code, "grade " + std::string(digits) + " is not known; nearest known: " +
                             std::to_string(std::clamp(name.grade, kLowestGrade, kHighestGrade)));
  return name;
}

// Fundamental deviation of the shaft with this letter, um, before the rules of grade.
std::optional<double> shaft_deviation_um(char letter, double nominal_mm) {
  for (const MainDeviation& row : kMainDeviations)
    if (row.letter == letter) return row.um[step_of(kMainSteps_mm, nominal_mm)];
  for (const FineDeviation& row : kFineDeviations)
    if (row.letter == letter) {
      const double um = row.um[step_of(kFineSteps_mm, nominal_mm)];
      if (um != kNoValue) return um;
    }
  return std::nullopt;
}

Result<Interval> limits_of_j_um(const ClassName& name, std::string_view code, double nominal_mm) {
  const std::size_t step = step_of(kMainSteps_mm, nominal_mm);
  const double it = grade_um(name.grade, nominal_mm);
  if (name.hole) {
    if (name.grade < 6 || name.grade > 8) return unknown(code, "J has grades 6 to 8 only; use JS");
    const double upper = kHoleJ_um[name.grade - 6][step];
    return Interval{upper - it, upper};
  }
  if (name.grade < 5 || name.grade > 7) return unknown(code, "j has grades 5 to 7 only; use js");
  const double lower = name.grade == 7 ? kShaftJ7_um[step] : kShaftJ56_um[step];
  return Interval{lower, lower + it};
}

// Delta of K ... ZC holes: a hole of grade n lies so that it fits the shaft of grade n - 1 as well.
double delta_um(int grade, double nominal_mm) {
  return nominal_mm <= kMainSteps_mm[0]
             ? 0.0
             : grade_um(grade, nominal_mm) - grade_um(grade - 1, nominal_mm);
}

Result<Interval> limits_of_hole_um(const ClassName& name, std::string_view code, double nominal_mm,
                                   double shaft_um) {
  const double it = grade_um(name.grade, nominal_mm);
  if (name.letter <= 'h') return Interval{-shaft_um, -shaft_um + it};  // EI = -es

  const bool small = nominal_mm <= kMainSteps_mm[0];
  const bool has_delta = name.grade >= 3 && name.grade <= (name.letter <= 'n' ? 8 : 7);
  double upper = -shaft_um + (has_delta ? delta_um(name.grade, nominal_mm) : 0.0);
  if (name.letter == 'k' && name.grade > 8 && !small)
    return unknown(code, "K above 3 mm has grades up to 8; nearest known: K8");
  if (name.letter == 'n' && name.grade > 8 && !small) upper = 0.0;
  // Exception of the standard: M6 above 250 up to 315 mm is -9, not -11.
  if (name.letter == 'm' && name.grade == 6 && nominal_mm > 250.0 && nominal_mm <= 315.0)
    upper = -9.0;
  return Interval{upper - it, upper};
}

Result<Interval> limits_um(const ClassName& name, std::string_view code, double nominal_mm) {
  const double it = grade_um(name.grade, nominal_mm);
  if (name.js) return Interval{-0.5 * it, 0.5 * it};
  if (name.letter == 'j') return limits_of_j_um(name, code, nominal_mm);

  std::optional<double> shaft_um = shaft_deviation_um(name.letter, nominal_mm);
  if (!shaft_um)
    return unknown(code, "the standard has no letter t up to 24 mm; nearest known: s and u");
  if (name.hole) return limits_of_hole_um(name, code, nominal_mm, *shaft_um);
  if (name.letter <= 'h') return Interval{*shaft_um - it, *shaft_um};
  if (name.letter == 'k' && (name.grade < 4 || name.grade > 7)) shaft_um = 0.0;
  return Interval{*shaft_um, *shaft_um + it};
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
  if (nominal_mm <= 1.0 &&
      (name->grade >= 14 || (name->hole && name->letter == 'n' && name->grade > 8)))
    return unknown(code, "not to be used up to 1 mm; nearest known grade: " +
                             std::string(name->grade >= 14 ? "13" : "8"));
  const Result<Interval> um = limits_um(*name, code, nominal_mm);
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
