#include "tests/lint/constants.h"

#include <regex>
#include <sstream>

namespace mortise::lint {
namespace {

const std::regex kConstant("\\s*(?:inline |static )*constexpr .*\\bk[A-Z].*");
const std::regex kNumber(
    "\\s*(?:inline |static )*constexpr (?:double|float|int|unsigned|long|short|auto|"
    "std::(?:u?int\\d+_t|u?intmax_t|size_t|ptrdiff_t|byte|chrono::\\w+))(?: \\w+)? "
    "(k[A-Z]\\w*)[^;]*;?.*");
const std::regex kAsksForNone("\\w+Count|k[A-Z]\\w*Per[A-Z]\\w*");
// Digits in these are no values.
const std::regex kNames("\\b[A-Za-z_]\\w*");
const std::regex kValue("0[xX][0-9a-fA-F']+|\\d[\\d.']*(?:[eE][+-]?\\d+)?");
const std::regex kEvident("[012]|[012]\\.0?|0[xX][fF']+");

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream all(text);
  for (std::string line; std::getline(all, line);) lines.push_back(line);
  return lines;
}

bool has_value(const std::string& declaration, bool evident_counts) {
  const std::string bare = std::regex_replace(declaration, kNames, "");
  for (auto value = std::sregex_iterator(bare.begin(), bare.end(), kValue);
       value != std::sregex_iterator(); ++value)
    if (evident_counts || !std::regex_match(value->str(), kEvident)) return true;
  return false;
}

/// A length or a time is chosen, also of 1.
bool has_unit(const std::string& name) { return name.find('_') != std::string::npos; }

}  // namespace

std::vector<BareConstant> constants_without_reason(const std::string& source) {
  const std::vector<std::string> lines = lines_of(source);
  std::vector<BareConstant> bare;
  bool said_above = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t begin = lines[i].find_first_not_of(' ');
    const bool is_comment = begin != std::string::npos && lines[i].compare(begin, 2, "//") == 0;
    if (is_comment || !std::regex_match(lines[i], kConstant)) {
      said_above = is_comment;
      continue;
    }
    const std::size_t line = i + 1;
    std::string declaration;
    bool said_behind = false;
    for (bool ended = false; !ended && i < lines.size(); ended ? i : ++i) {
      const std::size_t comment = lines[i].find("//");
      said_behind |= comment != std::string::npos;
      declaration += lines[i].substr(0, comment) + " ";
      ended = declaration.find(';') != std::string::npos;
    }
    std::smatch match;
    if (said_above || said_behind || !std::regex_match(declaration, match, kNumber)) continue;
    const std::string name = match[1];
    if (!std::regex_match(name, kAsksForNone) && has_value(declaration, has_unit(name)))
      bare.push_back({name, line});
  }
  return bare;
}

}  // namespace mortise::lint
