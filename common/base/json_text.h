#pragma once
#include <string>

namespace mortise {

/// A JSON document (of nlohmann) as text. A text in it that is not UTF-8, as the name of a file may
/// be, is shown with U+FFFD: no name may end a program.
template <class Json>
std::string json_text(const Json& document, int indent = 2) {
  return document.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace mortise
