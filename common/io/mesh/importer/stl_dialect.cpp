#include "common/io/mesh/importer/stl_dialect.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "common/base/in_quotes.h"
#include "common/io/mesh/importer/plain_text.h"

namespace mortise {
namespace {

// Of a binary file: a text of 80 bytes and a count of 4; a triangle of twelve floats and 2 bytes.
constexpr std::size_t kHeader = 80, kFront = 84, kRecord = 50;
// As far as a file is looked at to tell text from binary: the count of a binary file, which has a
// zero byte, and its first triangle.
constexpr std::size_t kProbe = kFront + kRecord;

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

Error bad(std::string what) { return fail(Code::kInvalidInput, std::move(what)); }

/// The words of a text in lower case, with their lines, which end with LF, CR or both.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  /// Empty at the end.
  std::string_view next() {
    skip_blanks();
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    word_.assign(text_.substr(begin, at_ - begin));
    std::transform(word_.begin(), word_.end(), word_.begin(), lower);
    return word_;
  }
  std::string_view rest_of_line() const {
    return text_.substr(at_, text_.find_first_of("\r\n", at_) - at_);
  }
  void skip(std::size_t characters) { at_ += characters; }
  std::size_t line() const { return line_; }
  bool over() const { return at_ == text_.size(); }

 private:
  void skip_blanks() {
    for (; at_ < text_.size() && is_blank(text_[at_]); ++at_)
      if (text_[at_] == '\n' || (text_[at_] == '\r' && text_.substr(at_ + 1, 1) != "\n")) ++line_;
  }
  std::string_view text_;
  std::string word_;
  std::size_t at_ = 0, line_ = 1;
};

class TextReader {
 public:
  explicit TextReader(std::string_view text) : words_(text) {}

  Result<StrictStl> read() {
    out_.bytes = "solid part\n";
    for (std::string word(words_.next()); !word.empty(); word = words_.next()) {
      if (word == "end") word += words_.next();
      if (!take(word))
        return bad("line " + std::to_string(words_.line()) + ": " + fault_ + "; export it again");
    }
    if (open_) return bad("the file ends within a facet: it was cut off; export it again");
    if (!ended_) out_.note = "the file has no endsolid: it may have been cut off";
    out_.bytes += "endsolid part\n";
    return std::move(out_);
  }

 private:
  bool fault(std::string what) {
    fault_ = std::move(what);
    return false;
  }

  bool take(const std::string& word) {
    if (word == "vertex") return vertex();
    if (word == "facet") return begin_facet();
    if (word == "endfacet") return end_facet();
    if (word == "normal") return skip_normal();
    if (word == "outer" || word == "loop" || word == "endloop") return true;
    if (word == "solid" || word == "endsolid") {
      ended_ = word == "endsolid";
      skip_name();
      return !open_ || fault(word + " stands within a facet");
    }
    if (word[0] == ';' || word[0] == '#' || word.starts_with("//")) {
      words_.skip(words_.rest_of_line().size());
      return true;
    }
    return words_.over() ? cut_off() : fault(in_quotes(word) + " is no word of STL");
  }

  bool cut_off() { return fault("the file ends within a facet: it was cut off"); }

  // The rest of the line, which may say anything; a file may have no lines.
  void skip_name() {
    std::string rest(words_.rest_of_line());
    std::transform(rest.begin(), rest.end(), rest.begin(), lower);
    words_.skip(std::min(rest.find("facet normal"), rest.size()));
  }

  bool begin_facet() {
    if (open_) return fault("a facet begins within a facet");
    open_ = true;
    corners_ = 0;
    out_.bytes += "facet normal 0 0 1\nouter loop\n";
    return true;
  }

  // It is computed from the corners anyway: any three words.
  bool skip_normal() {
    for (int k = 0; k < 3; ++k) words_.next();
    return true;
  }

  bool vertex() {
    if (!open_) return fault("a vertex stands outside of a facet");
    if (++corners_ > 3) return fault("a facet has more than three vertices");
    out_.bytes += "vertex";
    for (int k = 0; k < 3; ++k) {
      std::string_view word = words_.next();
      if (word.starts_with('+')) word.remove_prefix(1);
      double x = 0.0;
      const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), x);
      const bool number = status == std::errc{} && end == word.data() + word.size();
      if (word.empty()) return cut_off();
      if (!number || !(std::fabs(x) <= std::numeric_limits<float>::max()))
        return fault(in_quotes(word) + " is no finite number" +
                     (word.find(',') == word.npos ? "" : " (decimals have a point)"));
      out_.bytes += ' ';
      out_.bytes += word;
    }
    out_.bytes += '\n';
    return true;
  }

  bool end_facet() {
    if (!open_ || corners_ != 3)
      return fault("a facet has " + std::to_string(open_ ? corners_ : 0) + " vertices, not 3");
    open_ = false;
    out_.bytes += "endloop\nendfacet\n";
    return true;
  }

  Words words_;
  StrictStl out_;
  std::string fault_;
  bool open_ = false, ended_ = false;
  int corners_ = 0;
};

bool begins_as_text(std::string_view bytes) {
  constexpr std::string_view kSolid = "solid";
  while (!bytes.empty() && is_blank(bytes.front())) bytes.remove_prefix(1);
  return bytes.size() >= kSolid.size() && std::equal(kSolid.begin(), kSolid.end(), bytes.begin(),
                                                     [](char a, char b) { return a == lower(b); });
}

bool has_zero_byte(std::string_view bytes) {
  return bytes.substr(0, kProbe).find('\0') != std::string_view::npos;
}

std::uint32_t count_in_header(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeader, sizeof count);
  return count;
}

Result<StrictStl> read_binary(std::string_view bytes) {
  const std::uint64_t says = count_in_header(bytes), holds = (bytes.size() - kFront) / kRecord;
  const std::uint64_t left = bytes.size() - kFront - std::min(says, holds) * kRecord;
  const std::string_view behind = bytes.substr(bytes.size() - left);
  const bool padding = std::all_of(behind.begin(), behind.end(), [](char c) { return c == 0; });
  if (says > holds || (left > 0 && left % kRecord == 0 && !padding))
    return bad("the header says " + std::to_string(says) + " triangles, the file holds " +
               std::to_string(holds) + ": it is damaged or was cut off; export it again");
  StrictStl out;
  out.bytes.assign(kHeader, ' ');
  out.bytes += bytes.substr(kHeader, 4 + says * kRecord);
  for (std::uint64_t t = 0; t < says; ++t) {
    std::array<float, 9> x{};
    std::memcpy(x.data(), out.bytes.data() + kFront + t * kRecord + 12, sizeof x);
    if (!std::all_of(x.begin(), x.end(), [](float c) { return std::isfinite(c); }))
      return bad("triangle " + std::to_string(t + 1) +
                 " has a coordinate that is no finite number; export it again");
  }
  if (left > 0) out.note = std::to_string(left) + " bytes behind the last triangle were left out";
  return out;
}

}  // namespace

Result<StrictStl> strict_stl(std::string_view bytes) {
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
    return bad("is UTF-16 text; save it as plain text, or export it as binary STL");
  // Exactly as long as its count says: binary, whatever its header says.
  if (bytes.size() >= kFront &&
      bytes.size() == kFront + std::uint64_t{count_in_header(bytes)} * kRecord)
    return read_binary(bytes);
  const std::string_view text = without_mark(bytes);
  if (begins_as_text(text) && !has_zero_byte(text)) return TextReader(without_padding(text)).read();
  if (bytes.size() < kFront || !has_zero_byte(bytes))
    return bad("is no STL file: it neither begins with 'solid' nor is it binary; check the ending");
  return read_binary(bytes);
}

}  // namespace mortise
