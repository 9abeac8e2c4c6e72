#include "common/io/mesh/importer/ply_header.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/in_quotes.h"
#include "common/io/mesh/importer/plain_text.h"

namespace mortise {
namespace {

/// More than any file; sums of a few products of these fit into 64 bits.
constexpr std::uint64_t kMost = std::uint64_t{1} << 32U;
/// Of a header; chosen: those of programs have some tens. What has no end by then is refused.
constexpr std::size_t kMostLines = 1000;

const char* const kDamaged = ": it is damaged or was cut off; export it again";

using PlyWords = std::vector<std::string_view>;

void split(std::string_view line, PlyWords& words) {
  words.clear();
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t from = line.find_first_not_of(" \t", at);
    if (from == std::string_view::npos) break;
    at = std::min(line.find_first_of(" \t", from), line.size());
    words.push_back(line.substr(from, at - from));
  }
}

/// Lines end with LF, CR or both.
std::string_view take_line(std::string_view bytes, std::size_t& at) {
  const std::size_t end = std::min(bytes.find_first_of("\r\n", at), bytes.size());
  const std::string_view line = bytes.substr(at, end - at);
  at = std::min(end + (bytes.substr(end, 2) == "\r\n" ? 2 : 1), bytes.size());
  return line;
}

struct NumberType {
  unsigned bytes = 0;  ///< in a binary file; 0: no type
  bool whole = true, negative = true;
};

NumberType type_of(std::string_view name) {
  for (const char* one : {"char", "int8"})
    if (name == one) return {1, true, true};
  for (const char* one : {"uchar", "uint8"})
    if (name == one) return {1, true, false};
  for (const char* two : {"short", "int16"})
    if (name == two) return {2, true, true};
  for (const char* two : {"ushort", "uint16"})
    if (name == two) return {2, true, false};
  for (const char* four : {"int", "int32"})
    if (name == four) return {4, true, true};
  for (const char* four : {"uint", "uint32"})
    if (name == four) return {4, true, false};
  for (const char* four : {"float", "float32"})
    if (name == four) return {4, false, true};
  return {name == "double" || name == "float64" ? 8U : 0U, false, true};
}

struct Property {
  std::string name;
  NumberType type;
  std::optional<NumberType> count;  ///< of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Form { kNone, kText, kLittle, kBig };

class PlyHead {
 public:
  explicit PlyHead(std::string_view bytes) : bytes_(bytes) {}

  std::string wrong() {
    if (next_line() != "ply") return "is no PLY file: it does not begin with 'ply'";
    for (PlyWords words; lines_ + 1 < kMostLines && at_ < bytes_.size();) {
      const std::string_view line = next_line();
      split(line, words);
      if (!words.empty() && words[0] == "end_header") {
        const std::string wrong = wrong_with_vertices();
        return wrong.empty() ? wrong_with_room() : wrong;
      }
      if (!take(words))
        return "line " + std::to_string(lines_) + ": " + in_quotes(line) +
               " is no line of a PLY header; export it again";
    }
    return "its header has no end: the file is damaged or was cut off; export it again";
  }

  Form form() const { return form_; }
  std::string_view text() const { return bytes_.substr(0, at_); }
  std::size_t lines() const { return lines_; }
  const std::vector<Element>& elements() const { return elements_; }

 private:
  std::string_view next_line() {
    ++lines_;
    return take_line(bytes_, at_);
  }

  bool take(const PlyWords& words) {
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return true;
    if (words[0] == "format") return take_format(words);
    if (words[0] == "element") return take_element(words);
    return words[0] == "property" && take_property(words);
  }

  bool take_format(const PlyWords& words) {
    if (words.size() != 3 || form_ != Form::kNone) return false;
    form_ = words[1] == "ascii"                  ? Form::kText
            : words[1] == "binary_little_endian" ? Form::kLittle
            : words[1] == "binary_big_endian"    ? Form::kBig
                                                 : Form::kNone;
    return form_ != Form::kNone;
  }

  bool take_element(const PlyWords& words) {
    if (words.size() != 3) return false;
    std::uint64_t count = 0;
    const std::string_view number = words[2];
    const auto [end, status] = std::from_chars(number.data(), number.data() + number.size(), count);
    if (status != std::errc{} || end != number.data() + number.size() || count >= kMost)
      return false;
    elements_.push_back({std::string(words[1]), count, {}});
    return true;
  }

  bool take_property(const PlyWords& words) {
    const bool list = words.size() == 5 && words[1] == "list";
    if (elements_.empty() || (!list && words.size() != 3)) return false;
    Property property{std::string(words.back()), type_of(words[list ? 3 : 1]), {}};
    if (list) property.count = type_of(words[2]);
    if (property.type.bytes == 0 ||
        (list && (property.count->bytes == 0 || !property.count->whole)))
      return false;
    elements_.back().properties.push_back(property);
    return true;
  }

  // Assimp takes an axis that no property names for 0 everywhere: the part would be flat.
  std::string wrong_with_vertices() const {
    for (const Element& element : elements_)
      if (element.name == "vertex")
        for (const std::string axis : {"x", "y", "z"})
          if (std::ranges::none_of(element.properties, [&](const Property& property) {
                return property.name == axis && !property.count;
              }))
            return "its vertices have no " + axis + "; export it again";
    return {};
  }

  // A number takes two bytes of text, and a list has its count at least. A row without properties
  // takes no bytes, and assimp as long as its count says.
  std::string wrong_with_room() {
    if (form_ == Form::kNone) return "its header names no format; export it again";
    std::uint64_t needed = 0;
    for (const Element& element : elements_) {
      std::uint64_t of_one = 0;
      for (const Property& property : element.properties)
        of_one += form_ == Form::kText ? 2 : property.count.value_or(property.type).bytes;
      needed += element.count * std::max<std::uint64_t>(of_one, 1);
    }
    const std::uint64_t there = bytes_.size() - at_;
    if (needed <= there + (form_ == Form::kText ? 1 : 0)) return {};  // the last line's end
    return "the header announces " + std::to_string(needed) + " bytes or more, the file has " +
           std::to_string(there) + " behind it" + kDamaged;
  }

  std::string_view bytes_;
  std::size_t at_ = 0, lines_ = 0;
  Form form_ = Form::kNone;
  std::vector<Element> elements_;
};

/// The rows of a text: one line each, but for blank lines and comments, which assimp takes for
/// rows.
class TextRows {
 public:
  TextRows(const PlyHead& head, std::string_view body)
      : head_(head), body_(body), line_(head.lines()) {}

  Result<std::string> read() {
    std::string out;
    out.reserve(body_.size() + 1);
    for (const Element& element : head_.elements())
      for (std::uint64_t row = 0; row < element.count; ++row) {
        if (!next_row())
          return fail(Code::kInvalidInput, "the header announces " + std::to_string(element.count) +
                                               " rows of " + in_quotes(element.name) +
                                               ", the file has " + std::to_string(row) + kDamaged);
        if (const std::string wrong = wrong_with_row(element); !wrong.empty()) return bad(wrong);
        out += text_;
        out += '\n';
      }
    if (next_row()) return bad("more rows than the header announces");
    return out;
  }

 private:
  Error bad(const std::string& what) const {
    return fail(Code::kInvalidInput,
                "line " + std::to_string(line_) + ": " + what + "; export it again");
  }

  bool next_row() {
    while (at_ < body_.size()) {
      ++line_;
      text_ = take_line(body_, at_);
      split(text_, words_);
      if (!words_.empty() && words_[0] != "comment") return true;
    }
    return false;
  }

  std::string wrong_with_row(const Element& element) {
    std::size_t wanted = 0;
    for (const Property& property : element.properties) {
      std::uint64_t numbers = 1;
      if (property.count && wanted < words_.size()) {
        const std::string_view word = words_[wanted];
        const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), numbers);
        if (status != std::errc{} || end != word.data() + word.size() || numbers > words_.size())
          return "a row of " + in_quotes(element.name) + " has no list of " + in_quotes(word);
        ++wanted;
      }
      for (; numbers > 0; --numbers, ++wanted)
        if (wanted < words_.size() && !is_number(words_[wanted], property.type))
          return in_quotes(words_[wanted]) + " is no " +
                 (property.type.whole ? "whole number of its type" : "number") +
                 (words_[wanted].find(',') == std::string::npos ? "" : " (decimals have a point)");
    }
    return wanted == words_.size()
               ? ""
               : "a row of " + in_quotes(element.name) + " has " + std::to_string(words_.size()) +
                     " numbers, not " + std::to_string(wanted);
  }

  static bool is_number(std::string_view word, const NumberType& type) {
    if (word.starts_with('+')) word.remove_prefix(1);
    const char* const last = word.data() + word.size();
    if (!type.whole) {
      double x = 0.0;
      const auto [end, status] = std::from_chars(word.data(), last, x);
      return status == std::errc{} && end == last;
    }
    std::int64_t x = 0;
    const auto [end, status] = std::from_chars(word.data(), last, x);
    const std::int64_t over = std::int64_t{1} << (8 * type.bytes - (type.negative ? 1 : 0));
    return status == std::errc{} && end == last && x < over && x >= (type.negative ? -over : 0);
  }

  const PlyHead& head_;
  std::string_view body_, text_;
  std::size_t at_ = 0, line_ = 0;
  PlyWords words_;
};

/// The bytes of all rows of a binary file; nothing: there are fewer.
std::optional<std::uint64_t> size_of_rows(const PlyHead& head, std::string_view body) {
  std::uint64_t at = 0;
  const auto take_number = [&](unsigned bytes) {
    std::uint64_t number = 0;
    for (unsigned i = 0; i < bytes && at + bytes <= body.size(); ++i) {
      const std::uint64_t byte = static_cast<unsigned char>(body[at + i]);
      number |= byte << 8 * (head.form() == Form::kLittle ? i : bytes - 1 - i);
    }
    at += bytes;
    return number;
  };
  for (const Element& element : head.elements())
    for (std::uint64_t row = 0; row < element.count; ++row) {
      for (const Property& property : element.properties) {
        const std::uint64_t numbers = property.count ? take_number(property.count->bytes) : 1;
        at += numbers * property.type.bytes;
      }
      if (at > body.size()) return {};
    }
  return at;
}

/// Bytes behind the last row are told; as many as a row needs are one that is not announced.
Result<StrictPly> read_binary(const PlyHead& head, std::string_view body) {
  const auto size = size_of_rows(head, body);
  if (!size)
    return fail(Code::kInvalidInput, "the file ends before the last row that its header announces" +
                                         std::string(kDamaged));
  const std::string_view behind = body.substr(*size);
  const bool padding = std::all_of(behind.begin(), behind.end(), [](char c) { return c == 0; });
  std::uint64_t least = 0;
  if (!head.elements().empty())
    for (const Property& property : head.elements().back().properties)
      least +=
          property.count ? property.count->bytes + 3 * property.type.bytes : property.type.bytes;
  if (!padding && behind.size() >= least)
    return fail(Code::kInvalidInput, "the file has " + std::to_string(behind.size()) +
                                         " bytes behind the rows that its header announces" +
                                         kDamaged);
  StrictPly out;
  out.bytes = head.text();
  out.bytes += body.substr(0, *size);
  if (!behind.empty())
    out.note = std::to_string(behind.size()) + " bytes behind the last row were left out";
  return out;
}

}  // namespace

Result<StrictPly> strict_ply(std::string_view bytes) {
  PlyHead head(bytes);
  if (const std::string wrong = head.wrong(); !wrong.empty())
    return fail(Code::kInvalidInput, wrong);
  const std::string_view body = bytes.substr(head.text().size());
  if (head.form() != Form::kText) return read_binary(head, body);
  Result<std::string> rows = TextRows(head, without_padding(body)).read();
  if (!rows) return rows.error();
  return StrictPly{std::string(head.text()) + *rows, {}};
}

}  // namespace mortise
