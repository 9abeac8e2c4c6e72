#include "common/io/mesh/importer/obj_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "common/base/in_quotes.h"
#include "common/io/mesh/importer/plain_text.h"

namespace mortise {
namespace {

/// The statements of OBJ and of its free forms, which hold no triangles, but v, f, l and p.
constexpr std::array<std::string_view, 39> kKnownStatements = {
    "vt",       "vn",     "vp",     "g",          "o",         "s",     "mg",    "usemtl",
    "mtllib",   "usemap", "maplib", "cstype",     "deg",       "bmat",  "step",  "curv",
    "curv2",    "surf",   "parm",   "trim",       "hole",      "scrv",  "sp",    "end",
    "con",      "bevel",  "lod",    "shadow_obj", "trace_obj", "ctech", "stech", "c_interp",
    "d_interp", "call",   "csh",    "res",        "bzp",       "bsp",   "cdc"};

bool ends_line(char c) { return c == '\n' || c == '\r'; }
bool is_gap(char c) { return c == ' ' || c == '\t'; }

/// Words, line by line; one that ends with a backslash goes on in the next.
class ObjLines {
 public:
  explicit ObjLines(std::string_view bytes) : bytes_(bytes) {}

  /// The words of the next line without its comment. False: there is none.
  bool next(std::vector<std::string_view>& words) {
    words.clear();
    if (at_ >= bytes_.size()) return false;
    number_ += lines_of_last_;
    lines_of_last_ = 0;
    for (; at_ < bytes_.size() && !ends_line(bytes_[at_]); skip_blanks()) {
      if (bytes_[at_] == '#') {
        at_ = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size());
        break;
      }
      const std::size_t from = at_;
      while (at_ < bytes_.size() && !ends_line(bytes_[at_]) && !is_gap(bytes_[at_]) && !goes_on())
        ++at_;
      if (at_ > from) words.push_back(bytes_.substr(from, at_ - from));
    }
    pass_end();
    return true;
  }
  std::size_t number() const { return number_; }
  bool continued() const { return lines_of_last_ > 1; }

 private:
  bool goes_on() const {
    return bytes_[at_] == '\\' && at_ + 1 < bytes_.size() && ends_line(bytes_[at_ + 1]);
  }
  void pass_end() {
    if (at_ < bytes_.size()) at_ += bytes_.substr(at_, 2) == "\r\n" ? 2 : 1;
    ++lines_of_last_;
  }
  void skip_blanks() {
    while (at_ < bytes_.size() && (is_gap(bytes_[at_]) || goes_on())) {
      const bool next_line = goes_on();
      ++at_;
      if (next_line) pass_end();
    }
  }

  std::string_view bytes_;
  std::size_t at_ = 0, number_ = 1, lines_of_last_ = 0;
};

using Statement = std::vector<std::string_view>;

bool is_coordinate(std::string_view word, double& x) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), x);
  return status == std::errc{} && end == word.data() + word.size() && std::isfinite(x);
}

// Three coordinates; with a weight, which must be 1; with a colour of three or four.
std::string wrong_with_vertex(const Statement& words) {
  const std::size_t count = words.size() - 1;
  double x = 0.0;
  for (std::size_t i = 1; i < words.size(); ++i)
    if (!is_coordinate(words[i], x)) return in_quotes(words[i]) + " is no finite number";
  if (count == 4 && x != 1.0)
    return "a vertex has a weight of " + std::string(words[4]) +
           ", and nobody knows what that means for a mesh";
  if (count == 3 || count == 4 || count == 6 || count == 7) return {};
  return "a vertex has " + std::to_string(count) + " numbers, not three";
}

// v, v/vt, v//vn or v/vt/vn; numbers from 1, or from the end below 0.
bool is_corner(std::string_view word) {
  for (int part = 0; part < 3; ++part) {
    const std::string_view number = word.substr(0, word.find('/'));
    long long index = 0;
    const auto [end, status] = std::from_chars(number.data(), number.data() + number.size(), index);
    const bool whole = status == std::errc{} && end == number.data() + number.size() && index != 0;
    if (!whole && (part == 0 || !number.empty())) return false;
    if (number.size() == word.size()) return true;
    word.remove_prefix(number.size() + 1);
  }
  return false;
}

std::string wrong_with_face(const Statement& words) {
  if (words.size() < 4) return "a face has fewer than three corners";
  for (std::size_t i = 1; i < words.size(); ++i)
    if (!is_corner(words[i])) return in_quotes(words[i]) + " is no corner of a face";
  return {};
}

bool holds_shape(std::string_view word) {
  return word == "v" || word == "f" || word == "l" || word == "p";
}

std::string wrong_with(const Statement& words, bool continued) {
  if (words[0] == "v") return wrong_with_vertex(words);
  if (words[0] == "f") return wrong_with_face(words);
  if (holds_shape(words[0])) return {};
  if (std::find(kKnownStatements.begin(), kKnownStatements.end(), words[0]) ==
      kKnownStatements.end())
    return in_quotes(words[0]) + " is no statement of OBJ";
  // A name like C:\models\ in front of a vertex.
  if (continued && std::any_of(words.begin() + 1, words.end(), holds_shape))
    return in_quotes(words[0]) + " ends with a backslash, which joins the next statement to it";
  return {};
}

/// A point in the texture or a normal says nothing of the shape.
void append(const Statement& words, std::string& out) {
  if (!holds_shape(words[0])) return;
  out += words[0];
  const bool vertex = words[0] == "v";
  for (std::size_t i = 1; i < (vertex ? 4 : words.size()); ++i) {
    out += ' ';
    out += vertex ? words[i] : words[i].substr(0, words[i].find('/'));
  }
  out += '\n';
}

}  // namespace

Result<std::string> strict_obj(std::string_view bytes) {
  bytes = without_padding(without_mark(bytes));
  ObjLines lines(bytes);
  std::string out;
  out.reserve(bytes.size() + 1);
  for (Statement words; lines.next(words);) {
    if (words.empty()) continue;
    const std::string wrong = wrong_with(words, lines.continued());
    if (!wrong.empty())
      return fail(Code::kInvalidInput,
                  "line " + std::to_string(lines.number()) + ": " + wrong + "; export it again");
    append(words, out);
  }
  return out;
}

}  // namespace mortise
