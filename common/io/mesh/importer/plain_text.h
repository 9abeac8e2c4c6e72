#pragma once
#include <string_view>

namespace mortise {

/// A text without the mark of UTF-8 in front.
inline std::string_view without_mark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

/// A text without the zero bytes and Ctrl-Z that some programs fill its last block with.
inline std::string_view without_padding(std::string_view text) {
  return text.substr(0, text.find_last_not_of(std::string_view("\0\x1a", 2)) + 1);
}

}  // namespace mortise
