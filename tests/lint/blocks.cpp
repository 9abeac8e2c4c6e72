#include "tests/lint/blocks.h"

#include <algorithm>
#include <cctype>
#include <regex>

namespace mortise::lint {
namespace {

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// The end of what begins at `at` if that is a comment, a literal or a line of the preprocessor;
// else `at`.
std::size_t end_of_noise(const std::string& text, std::size_t at, bool begins_line) {
  const auto after = [&](std::string_view what, std::size_t from) {
    const std::size_t found = text.find(what, from);
    return found == std::string::npos ? text.size() : found + what.size();
  };
  if (text[at] == '#' && begins_line) {
    std::size_t end = text.find('\n', at);
    while (end != std::string::npos && text[end - 1] == '\\') end = text.find('\n', end + 1);
    return std::min(end, text.size());
  }
  if (text.compare(at, 2, "//") == 0) return std::min(text.find('\n', at), text.size());
  if (text.compare(at, 2, "/*") == 0) return after("*/", at + 2);
  if (text.compare(at, 2, "R\"") == 0 && (at == 0 || !is_word(text[at - 1]))) {
    const std::size_t open = text.find('(', at);
    return after(")" + text.substr(at + 2, open - at - 2) + "\"", open);
  }
  const bool separates_digits = text[at] == '\'' && at > 0 && is_word(text[at - 1]);
  if (text[at] != '"' && (text[at] != '\'' || separates_digits)) return at;
  std::size_t end = at + 1;
  while (end < text.size() && text[end] != text[at]) end += text[end] == '\\' ? 2 : 1;
  return std::min(end + 1, text.size());
}

// The source without comments, literals and preprocessor, every line where it was.
std::string without_noise(std::string text) {
  bool begins_line = true;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = end_of_noise(text, at, begins_line);
    for (; at < end; ++at)
      if (text[at] != '\n') text[at] = ' ';
    if (at >= text.size()) break;
    if (end_of_noise(text, at, false) != at) continue;
    begins_line = text[at] == '\n' || (begins_line && text[at] == ' ');
    ++at;
  }
  return text;
}

enum class Opens { kNamespace, kClass, kFunction, kMemberInitializer, kOther };

const std::regex kNamespaceHead("^\\s*((inline )?namespace\\b|extern\\s*$)[^(]*");
const std::regex kEnum("\\benum\\b");
const std::regex kClassHead("\\b(?:class|struct|union)\\s+([A-Za-z_][\\w:]*)[^(]*$");
const std::regex kNoise(
    "(public|private|protected):|alignas\\([^)]*\\)|\\[\\[[^\\]]*\\]\\]|template <[^()]*>\\s");
const std::regex kFunctionName("((?:\\w+::)*(?:operator[^(]*|~?\\w+))\\(");
const std::regex kTest("TEST\\w*\\([^)]*\\)");

// What a brace after `head` opens, outside of functions.
Opens opened_by(const std::string& head) {
  if (std::regex_match(head, kNamespaceHead)) return Opens::kNamespace;
  if (std::regex_search(head, kEnum)) return Opens::kOther;
  if (std::regex_search(head, kClassHead)) return Opens::kClass;
  if (head.find('(') == std::string::npos) return Opens::kOther;
  if (head.find("operator") != std::string::npos) return Opens::kFunction;
  int depth = 0;
  bool assigns = false, initializes = false, has_arguments = false;
  for (std::size_t i = 0; i < head.size(); ++i) {
    const char before = i > 0 ? head[i - 1] : ' ', next = i + 1 < head.size() ? head[i + 1] : ' ';
    if (head[i] == '(' || head[i] == '[') ++depth;
    if (head[i] == ')' || head[i] == ']') --depth;
    if (depth > 0) has_arguments = true;
    if (depth == 0 && head[i] == '=' && next != '[' && head.find("= [", i) != i) assigns = true;
    if (depth == 0 && has_arguments && head[i] == ':' && before != ':' && next != ':')
      initializes = true;
  }
  if (assigns) return Opens::kOther;
  const char last = head[head.find_last_not_of(" \n")];
  return initializes && (is_word(last) || last == '>') ? Opens::kMemberInitializer
                                                       : Opens::kFunction;
}

class Scan {
 public:
  explicit Scan(const std::string& source) : text_(without_noise(source)) {}

  std::vector<Block> blocks() {
    for (at_ = 0; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '(' || c == '[') ++depth_;
      if (c == ')' || c == ']') --depth_;
      if (c == ';' && depth_ == 0) head_ = at_ + 1;
      if (c == '{') open();
      if (c == '}' && !open_.empty()) close();
    }
    return std::move(blocks_);
  }

 private:
  struct Brace {
    Opens opens = Opens::kOther;
    std::string name;
    std::size_t head = 0, line = 0;
    int depth = 0;  ///< of parentheses around it
  };

  std::size_t line_of(std::size_t at) const { return 1 + lines_in(text_.substr(0, at)); }

  void open() {
    Brace brace;
    brace.head = head_;
    brace.depth = depth_;
    const bool inside = std::any_of(open_.begin(), open_.end(), [](const Brace& b) {
      return b.opens == Opens::kFunction || b.opens == Opens::kOther;
    });
    if (!inside && depth_ == 0) {
      const std::string head = std::regex_replace(text_.substr(head_, at_ - head_), kNoise, "");
      brace.opens = opened_by(head);
      brace.name = name_of(head, brace.opens);
      const std::string written = head.substr(std::min(head.find_first_not_of(" \n"), head.size()));
      brace.line = line_of(at_) - lines_in(written);
    }
    if (brace.opens != Opens::kMemberInitializer) head_ = at_ + 1;
    open_.push_back(brace);
    depth_ = 0;
  }

  void close() {
    const Brace brace = open_.back();
    open_.pop_back();
    depth_ = brace.depth;
    const bool goes_on = brace.opens == Opens::kMemberInitializer ||
                         (brace.opens == Opens::kOther && brace.depth > 0);
    head_ = goes_on ? brace.head : at_ + 1;
    if (brace.opens != Opens::kClass && brace.opens != Opens::kFunction) return;
    Block block{brace.opens == Opens::kClass ? Block::Kind::kClass : Block::Kind::kFunction,
                brace.name, "", brace.line, line_of(at_) - brace.line + 1};
    const bool in_class = !open_.empty() && open_.back().opens == Opens::kClass;
    const std::size_t colons = brace.name.rfind("::");
    if (block.kind == Block::Kind::kFunction && !in_class && colons != std::string::npos)
      block.member_of = brace.name.substr(0, colons);
    blocks_.push_back(block);
  }

  std::string name_of(const std::string& head, Opens opens) const {
    std::smatch match;
    if (opens == Opens::kFunction && std::regex_search(head, match, kTest)) return match[0];
    if (opens != Opens::kClass && opens != Opens::kFunction) return "";
    if (!std::regex_search(head, match, opens == Opens::kClass ? kClassHead : kFunctionName))
      return "?";
    std::string name = match[1];
    for (auto brace = open_.rbegin(); brace != open_.rend(); ++brace)
      if (brace->opens == Opens::kClass) return brace->name + "::" + name;
    return name;
  }

  std::string text_;
  std::size_t at_ = 0, head_ = 0;
  int depth_ = 0;
  std::vector<Brace> open_;
  std::vector<Block> blocks_;
};

}  // namespace

std::vector<Block> blocks_of(const std::string& source) { return Scan(source).blocks(); }

}  // namespace mortise::lint
