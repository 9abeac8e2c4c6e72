#include "common/io/scenario/yaml_document.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

#include "common/base/plain_text.h"

namespace mortise {
namespace {

/// Nodes after aliases are followed. The largest scenario by size has fewer; an alias bomb has
/// more.
constexpr std::uint64_t kMaxExpandedNodes = 8'000'000;
/// Takes the keys of another map over, as YAML 1.1 has it.
constexpr const char* kMergeKey = "<<";

// Counts nodes as if every alias were written out, without writing any out.
class ExpandedSize : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override { ++documents_; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t anchor) override { leaf(anchor); }
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t anchor,
                const std::string& value) override {
    merges_ = merges_ || value == kMergeKey;
    leaf(anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto known = sizes_.find(anchor);
    if (known == sizes_.end()) {  // still open: the node would contain itself
      endless_line_ = mark.line + 1;
      return;
    }
    add(known->second);
  }
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(anchor);
  }
  void OnMapEnd() override { close(); }

  std::uint64_t total() const { return total_; }
  int documents() const { return documents_; }
  int endless_line() const { return endless_line_; }
  bool merges() const { return merges_; }

 private:
  struct Open {
    YAML::anchor_t anchor;
    std::uint64_t start;
  };
  void add(std::uint64_t nodes) {
    total_ = std::min(total_ + nodes, 2 * kMaxExpandedNodes);  // no overflow on the way up
  }
  void leaf(YAML::anchor_t anchor) {
    add(1);
    if (anchor != 0) sizes_[anchor] = 1;
  }
  void open(YAML::anchor_t anchor) {
    open_.push_back({anchor, total_});
    add(1);
  }
  void close() {
    if (open_.back().anchor != 0) sizes_[open_.back().anchor] = total_ - open_.back().start;
    open_.pop_back();
  }

  std::map<YAML::anchor_t, std::uint64_t> sizes_;
  std::vector<Open> open_;
  std::uint64_t total_ = 0;
  int documents_ = 0;
  int endless_line_ = 0;
  bool merges_ = false;
};

// Empty for UTF-8; else the line, and what is wrong there.
std::string wrong_encoding(std::string_view text) {
  const std::size_t good = std::min(utf8_prefix(text), text.find('\0'));
  if (good >= text.size()) return {};
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") || text[good] == '\0')
    return "1: is UTF-16 or binary";
  constexpr char kDigits[] = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(text[good]);
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(good), '\n');
  return std::to_string(line) + ": the byte 0x" + kDigits[byte >> 4] + kDigits[byte & 15] +
         " is not UTF-8";
}

// Keys of the maps that `<<` names, where the map has none of its own; in place, so that lines and
// shared nodes stay what they are.
void merge_named_maps(YAML::Node node) {
  if (node.IsSequence())
    for (const auto& item : node) merge_named_maps(item);
  if (!node.IsMap()) return;
  std::vector<YAML::Node> named;
  for (const auto& entry : node) {
    merge_named_maps(entry.second);
    if (!entry.first.IsScalar() || entry.first.Scalar() != kMergeKey) continue;
    if (entry.second.IsMap()) named.push_back(entry.second);
    if (entry.second.IsSequence())
      for (const auto& item : entry.second)
        if (item.IsMap()) named.push_back(item);
  }
  if (named.empty()) return;  // of another kind: an unknown key, said where the map is read
  node.remove(kMergeKey);
  const YAML::Node& own = node;  // asking a changeable one for a key adds it
  for (const YAML::Node& map : named)
    for (const auto& entry : map)
      if (entry.first.IsScalar() && !own[entry.first.Scalar()])
        node.force_insert(entry.first, entry.second);
}

}  // namespace

Result<YAML::Node> parse_yaml(std::string_view yaml, const std::string& name) {
  if (yaml.size() > kMostYaml_bytes)
    return fail(Code::kLimit, name + ": larger than 16 MiB; keep meshes in files of their own");
  if (const std::string wrong = wrong_encoding(yaml); !wrong.empty())
    return fail(Code::kInvalidInput, name + ":" + wrong + "; save the file as UTF-8");
  try {
    const std::string text(yaml);
    ExpandedSize size;
    {
      std::istringstream stream(text);
      YAML::Parser parser(stream);
      while (parser.HandleNextDocument(size)) {
        if (size.total() > kMaxExpandedNodes || size.documents() > 1) break;
      }
    }
    if (size.endless_line() != 0)
      return fail(Code::kInvalidInput, name + ":" + std::to_string(size.endless_line()) +
                                           ": an alias contains itself; write it out");
    if (size.total() > kMaxExpandedNodes)
      return fail(Code::kLimit, name + ": aliases expand to more than " +
                                    std::to_string(kMaxExpandedNodes) +
                                    " values; use fewer aliases");
    if (size.documents() > 1)
      return fail(Code::kInvalidInput, name + ": holds more than one document; keep the first");
    YAML::Node document = YAML::Load(text);
    if (size.merges()) merge_named_maps(document);
    return document;
  } catch (const YAML::Exception& e) {
    return fail(Code::kInvalidInput,
                name + ":" + std::to_string(e.mark.line + 1) + ": not YAML: " + e.msg +
                    (e.msg.find(" tab") != std::string::npos ? "; indent with blanks"
                                                             : "; check indent and quotes"));
  } catch (const std::exception& e) {
    return fail(Code::kInvalidInput, name + ": not YAML: " + std::string(e.what()));
  }
}

}  // namespace mortise
