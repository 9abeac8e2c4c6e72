#include "common/io/scenario/scenario_yaml.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <unordered_set>

#include "common/base/in_quotes.h"
#include "common/base/nearest_word.h"
#include "common/base/plain_text.h"

namespace mortise {
namespace {

/// Findings that are told of one file, and unknown keys of one mapping: more is read by nobody.
constexpr std::size_t kMostFindings = 200, kMostUnknownKeys = 20;
/// Longer ones quote long values; they are cut.
constexpr std::size_t kLongestFinding_bytes = 1000;
/// A word of a list: the names of a part and a feature with a dot between.
constexpr std::size_t kLongestWord_bytes = 2 * kMostName_bytes + 1;

std::string list_of(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string not_known(const std::string& key, const std::vector<std::string>& words) {
  const std::string nearest = nearest_word(key, words);
  return (nearest.empty() ? ". Known: " : "; did you mean '" + nearest + "'? Known: ") +
         list_of(words);
}

}  // namespace

void YamlContext::say(bool is_error, int line, const std::string& text) {
  if (findings.size() < kMostFindings)  // what it quotes may be anything, of any length
    findings.push_back({is_error, file + ":" + std::to_string(line) + ": " +
                                      one_line(text.substr(0, kLongestFinding_bytes))});
  else if (findings.size() == kMostFindings)
    findings.push_back({is_error, file + ": has more findings; correct these first"});
  else
    findings.back().is_error = findings.back().is_error || is_error;
}

YamlMap::YamlMap(YamlContext& context, const YAML::Node& node, std::string what,
                 std::initializer_list<std::string_view> known)
    : context_(context), node_(node), what_(std::move(what)) {
  if (!node_.IsMap()) {
    error("expected keys and values, e.g. " + std::string(*known.begin()) + ": ...");
    return;
  }
  usable_ = true;
  const std::vector<std::string> words(known.begin(), known.end());
  std::unordered_set<std::string> strange;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    const bool is_known = std::find(words.begin(), words.end(), key) != words.end();
    if (!entry.first.IsScalar())
      context_.error(entry.first, what_ + ": a key must be a word");
    else if (is_known ? !values_.emplace(key, entry.second).second : !strange.insert(key).second)
      context_.error(entry.first,
                     what_ + ": key " + in_quotes(key) + " stands here twice; keep one");
    else if (!is_known)
      say_unknown(entry.first, key, words);
  }
}

void YamlMap::say_unknown(const YAML::Node& at, const std::string& key,
                          const std::vector<std::string>& words) {
  if (++unknown_ == kMostUnknownKeys + 1)
    context_.error(node_, what_ + ": more than " + std::to_string(kMostUnknownKeys) +
                              " unknown keys; is this a scenario?");
  if (unknown_ > kMostUnknownKeys) return;
  // A word that is much longer than all known ones is none of them with a slip.
  const bool near = key.size() <= 40;
  context_.error(at, what_ + ": unknown key " + in_quotes(key) +
                         (near ? not_known(key, words) : "; known: " + list_of(words)));
}

YAML::Node YamlMap::find(std::string_view key) const {
  const auto value = values_.find(key);
  return value == values_.end() ? YAML::Node(YAML::NodeType::Undefined) : value->second;
}

void YamlMap::error(std::string_view key, const std::string& text) const {
  const YAML::Node value = find(key);
  context_.error(value ? value : node_, what_ + ": " + std::string(key) + ": " + text);
}

std::optional<std::string> YamlMap::text(std::string_view key) const {
  const YAML::Node value = find(key);
  if (!value) return std::nullopt;
  if (!value.IsScalar() || value.Scalar().empty()) {
    error(key, "expected a word or a sentence");
    return std::nullopt;
  }
  std::string text = value.Scalar();
  text.erase(text.find_last_not_of('\n') + 1);  // of a block
  if (is_text(text) && !text.empty()) return text;
  error(key, "expected one line without control characters, not " + in_quotes(text));
  return std::nullopt;
}

std::optional<double> yaml_number(YamlContext& context, const YAML::Node& node,
                                  const std::string& what) {
  double value = 0.0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value)) {
    context.error(node, what + ": expected a number" +
                            (node.IsScalar() ? ", not " + in_quotes(node.Scalar()) : ""));
    return std::nullopt;
  }
  if (std::fabs(value) <= kLargestNumber) return value;
  context.error(node, what + ": " + in_quotes(node.Scalar()) + " is beyond ±1e9; check it");
  return std::nullopt;
}

std::optional<std::pair<double, std::size_t>> leading_number(const std::string& text) {
  const char* begin = text.c_str();
  char* end = nullptr;
  const double value = std::strtod(begin, &end);
  if (end == begin || !(std::fabs(value) <= kLargestNumber)) return std::nullopt;
  return std::pair(value, static_cast<std::size_t>(end - begin));
}

bool within_range(YamlContext& context, const YAML::Node& at, const std::string& what,
                  const Vec3& mm) {
  if ((mm.array().abs() <= kLongest_mm).all()) return true;
  context.error(at, what + ": lies beyond 1000 km; check the number and the unit");
  return false;
}

std::optional<double> YamlMap::number(std::string_view key) const {
  const YAML::Node value = find(key);
  if (!value) return std::nullopt;
  return yaml_number(context_, value, what_ + ": " + std::string(key));
}

std::optional<double> YamlMap::length_mm(std::string_view key) const {
  const std::optional<double> value = number(key);
  if (!value) return value;
  const double mm = *value * context_.unit_mm;
  const bool good = within_range(context_, find(key), what_ + ": " + std::string(key), {mm, 0, 0});
  return good ? std::optional(mm) : std::nullopt;
}

std::optional<double> YamlMap::positive_length_mm(std::string_view key) const {
  const std::optional<double> value = length_mm(key);
  if (!value || *value >= kShortest_mm) return value;
  error(key, "must be greater than 0, and at least a nanometre");
  return std::nullopt;
}

std::optional<bool> YamlMap::boolean(std::string_view key) const {
  const YAML::Node value = find(key);
  if (!value) return std::nullopt;
  bool truth = false;
  if (!value.IsScalar() || !YAML::convert<bool>::decode(value, truth)) {
    error(key, "expected true or false");
    return std::nullopt;
  }
  return truth;
}

std::optional<std::vector<double>> YamlMap::numbers(std::string_view key, std::size_t count) const {
  const YAML::Node value = find(key);
  if (!value) return std::nullopt;
  if (!value.IsSequence() || value.size() != count) {
    const bool commas = value.IsSequence() && value.size() == 2 * count;
    error(key, "expected a list of " + std::to_string(count) + " numbers" +
                   (commas ? "; decimals have a point, 0.5" : ""));
    return std::nullopt;
  }
  std::vector<double> list;
  for (const auto& item : value) {
    const auto x = yaml_number(context_, item, what_ + ": " + std::string(key));
    if (!x) return std::nullopt;
    list.push_back(*x);
  }
  return list;
}

std::optional<Vec3> YamlMap::vector(std::string_view key) const {
  const auto list = numbers(key, 3);
  return list ? std::optional(Vec3((*list)[0], (*list)[1], (*list)[2])) : std::nullopt;
}

std::optional<Vec3> YamlMap::position_mm(std::string_view key) const {
  const auto written = vector(key);
  if (!written) return written;
  const Vec3 mm = *written * context_.unit_mm;
  const bool good = within_range(context_, find(key), what_ + ": " + std::string(key), mm);
  return good ? std::optional(mm) : std::nullopt;
}

std::optional<std::vector<std::string>> YamlMap::texts(std::string_view key) const {
  const YAML::Node value = find(key);
  if (!value) return std::nullopt;
  std::vector<std::string> list;
  if (value.IsSequence())
    for (const auto& item : value)
      if (item.IsScalar() && is_name(item.Scalar(), kLongestWord_bytes))
        list.push_back(item.Scalar());
  if (!value.IsSequence() || list.size() != value.size()) {
    error(key, "expected a list of words");
    return std::nullopt;
  }
  return list;
}

std::string YamlMap::one_of(std::initializer_list<std::string_view> keys) const {
  std::string found;
  for (const std::string_view key : keys) {
    if (!has(key)) continue;
    if (!found.empty()) error(key, "stands beside '" + found + "', which says the same; keep one");
    if (found.empty()) found = key;
  }
  return found;
}

}  // namespace mortise
