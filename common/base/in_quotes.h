#pragma once
#include <string>
#include <string_view>

namespace mortise {

/// The text between single quotes, for messages that quote a file: always one line of UTF-8 (see
/// one_line()), cut to the length that helps to find the place.
std::string in_quotes(std::string_view text);

}  // namespace mortise
