#include "common/io/mesh/importer/ply_header.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/in_quotes.h"

namespace mortise {
namespace {

/// More than any file; sums of a few products of these fit into 64 bits.
constexpr std::uint64_t kMost = std::uint64_t{1} << 32U;
/// Of a header; chosen: those of programs have some tens. What has no end by then is refused.
constexpr std::size_t kMostLines = 1000;

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t from = line.find_first_not_of(" \t", at);
    if (from == std::string_view::npos) break;
    at = std::min(line.find_first_of(" \t", from), line.size());
    words.push_back(line.substr(from, at - from));
  }
  return words;
}

/// Bytes of a number in a binary file; 0: no type.
std::uint64_t size_of_type(std::string_view type) {
  for (const char* one : {"char", "uchar", "int8", "uint8"})
    if (type == one) return 1;
  for (const char* two : {"short", "ushort", "int16", "uint16"})
    if (type == two) return 2;
  for (const char* four : {"int", "uint", "int32", "uint32", "float", "float32"})
    if (type == four) return 4;
  return type == "double" || type == "float64" ? 8 : 0;
}

class PlyHead {
 public:
  explicit PlyHead(std::string_view bytes) : bytes_(bytes) {}

  std::string wrong() {
    if (next_line() != "ply") return "is no PLY file: it does not begin with 'ply'";
    for (std::size_t number = 2; number < kMostLines && at_ < bytes_.size(); ++number) {
      const std::string_view line = next_line();
      const auto words = words_of(line);
      if (!words.empty() && words[0] == "end_header") return wrong_with_room();
      if (!take(words))
        return "line " + std::to_string(number) + ": " + in_quotes(line) +
               " is no line of a PLY header; export it again";
    }
    return "its header has no end: the file is damaged or was cut off; export it again";
  }

 private:
  // Lines end with LF, CR or both.
  std::string_view next_line() {
    const std::size_t end = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size());
    const std::string_view line = bytes_.substr(at_, end - at_);
    at_ = std::min(end + (bytes_.substr(end, 2) == "\r\n" ? 2 : 1), bytes_.size());
    return line;
  }

  bool take(const std::vector<std::string_view>& words) {
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return true;
    if (words[0] == "format") return take_format(words);
    if (words[0] == "element") return take_element(words);
    return words[0] == "property" && take_property(words);
  }

  bool take_format(const std::vector<std::string_view>& words) {
    text_ = words.size() == 3 && words[1] == "ascii";
    return text_ || (words.size() == 3 &&
                     (words[1] == "binary_little_endian" || words[1] == "binary_big_endian"));
  }

  bool take_element(const std::vector<std::string_view>& words) {
    if (words.size() != 3) return false;
    std::uint64_t count = 0;
    const std::string_view number = words[2];
    const auto [end, status] = std::from_chars(number.data(), number.data() + number.size(), count);
    if (status != std::errc{} || end != number.data() + number.size() || count >= kMost)
      return false;
    close_element();
    count_ = count;
    return true;
  }

  // A number takes two bytes of text, and a list has its count at least.
  bool take_property(const std::vector<std::string_view>& words) {
    const bool list = words.size() == 5 && words[1] == "list";
    const std::uint64_t size = list || words.size() == 3 ? size_of_type(words[list ? 2 : 1]) : 0;
    if (!count_ || size == 0 || (list && size_of_type(words[3]) == 0)) return false;
    of_one_ += text_ ? 2 : size;
    return true;
  }

  // One without properties takes no bytes, and assimp as long as its count says.
  void close_element() {
    if (count_) needed_ += *count_ * std::max<std::uint64_t>(of_one_, 1);
    of_one_ = 0;
  }

  std::string wrong_with_room() {
    close_element();
    const std::uint64_t there = bytes_.size() - at_ + (text_ ? 1 : 0);  // the last line's end
    if (!count_ || needed_ <= there) return {};
    return "the header announces " + std::to_string(needed_) + " bytes or more, the file has " +
           std::to_string(bytes_.size() - at_) +
           " behind it: it is damaged or was cut off; export it again";
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  bool text_ = true;
  std::optional<std::uint64_t> count_;  ///< of the element whose properties come
  std::uint64_t of_one_ = 0, needed_ = 0;
};

}  // namespace

std::string wrong_with_ply(std::string_view bytes) { return PlyHead(bytes).wrong(); }

}  // namespace mortise
