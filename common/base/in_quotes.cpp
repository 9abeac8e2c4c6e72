#include "common/base/in_quotes.h"

#include "common/base/plain_text.h"

namespace mortise {

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMost = 120;  // bytes; chosen: a line or two of a terminal
  std::size_t size = text.size();
  if (size > kMost) {
    size = kMost;
    // Not in the middle of a character.
    while (size > kMost - 4 && (static_cast<unsigned char>(text[size]) & 0xc0) == 0x80) --size;
  }
  return "'" + one_line(text.substr(0, size)) + (size < text.size() ? "...'" : "'");
}

}  // namespace mortise
