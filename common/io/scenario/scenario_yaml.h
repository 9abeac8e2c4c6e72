#pragma once
#include <yaml-cpp/yaml.h>

#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/ranges.h"
#include "common/io/scenario/scenario_file.h"
#include "common/io/scenario/yaml_document.h"
#include "common/math/types.h"

/// Strict access to YAML: every read names the type that it expects, and an error becomes a finding
/// with file and line instead of an exception. Private to the scenario reader.
namespace mortise {

/// What all levels of the document share: where findings go, and the unit of lengths.
struct YamlContext {
  std::string file;
  std::vector<Finding> findings;
  double unit_mm = 1.0;

  void error(const YAML::Node& at, const std::string& text) { say(true, line_of(at), text); }
  void error(int line, const std::string& text) { say(true, line, text); }
  void warning(const YAML::Node& at, const std::string& text) { say(false, line_of(at), text); }
  int line_of(const YAML::Node& node) const { return node.Mark().line + 1; }

 private:
  void say(bool is_error, int line, const std::string& text);
};

/// One mapping of the document. The constructor reports unknown and duplicate keys. A node that is
/// no mapping is one error and then reads as empty.
class YamlMap {
 public:
  YamlMap(YamlContext& context, const YAML::Node& node, std::string what,
          std::initializer_list<std::string_view> known);

  bool usable() const { return usable_; }
  bool has(std::string_view key) const { return static_cast<bool>(find(key)); }
  YAML::Node find(std::string_view key) const;  ///< an undefined node when absent
  const YAML::Node& node() const { return node_; }
  int line() const { return context_.line_of(node_); }
  void error(const std::string& text) const { context_.error(node_, what_ + ": " + text); }
  void error(std::string_view key, const std::string& text) const;

  std::optional<std::string> text(std::string_view key) const;  ///< of one line
  std::optional<double> number(std::string_view key) const;
  std::optional<double> length_mm(std::string_view key) const;  ///< up to kLongest_mm
  /// kShortest_mm to kLongest_mm
  std::optional<double> positive_length_mm(std::string_view key) const;
  std::optional<bool> boolean(std::string_view key) const;
  std::optional<std::vector<double>> numbers(std::string_view key, std::size_t count) const;
  std::optional<Vec3> vector(std::string_view key) const;  ///< as written, unit not applied
  std::optional<Vec3> position_mm(std::string_view key) const;
  std::optional<std::vector<std::string>> texts(std::string_view key) const;
  /// Which of these keys is present; more than one is an error, none gives "".
  std::string one_of(std::initializer_list<std::string_view> keys) const;

 private:
  void say_unknown(const YAML::Node& at, const std::string& key,
                   const std::vector<std::string>& words);
  YamlContext& context_;
  YAML::Node node_;
  std::string what_;
  bool usable_ = false;
  std::map<std::string, YAML::Node, std::less<>> values_;  ///< of known keys, the first of each
  std::size_t unknown_ = 0;
};

/// The number that a text begins with, and where it ends; nothing when there is none, or one beyond
/// kLargestNumber.
std::optional<std::pair<double, std::size_t>> leading_number(const std::string& text);

/// A number up to kLargestNumber, or an error at the node.
std::optional<double> yaml_number(YamlContext& context, const YAML::Node& node,
                                  const std::string& what);

/// Is a length of the file, in mm, no longer than any length may be? Else an error at the node.
bool within_range(YamlContext& context, const YAML::Node& at, const std::string& what,
                  const Vec3& mm);

}  // namespace mortise
