#pragma once
#include <string>
#include <string_view>

namespace mortise {

/// The text between single quotes, for messages that quote a file: always one line (control
/// characters become '?'), cut to the length that helps to find the place.
inline std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMost = 120;
  std::string text_in(1, '\'');
  for (const char c : text.substr(0, kMost)) {
    const auto code = static_cast<unsigned char>(c);
    text_in.push_back(code < 0x20 || code == 0x7f ? '?' : c);
  }
  if (text.size() > kMost) {
    // Not in the middle of a character.
    while (!text_in.empty() && (static_cast<unsigned char>(text_in.back()) & 0xc0) == 0x80)
      text_in.pop_back();
    if (static_cast<unsigned char>(text_in.back()) >= 0xc0) text_in.pop_back();
    text_in += "...";
  }
  text_in.push_back('\'');
  return text_in;
}

}  // namespace mortise
