#pragma once
#include <string>
#include <string_view>

namespace mortise {

/// The text between single quotes, for messages that show what a file says.
inline std::string quoted(std::string_view text) {
  std::string text_in(1, '\'');
  text_in.append(text);
  text_in.push_back('\'');
  return text_in;
}

}  // namespace mortise
