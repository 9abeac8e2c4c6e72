#pragma once
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace mortise {

/// An STL file in the one form that every reader takes.
struct StrictStl {
  std::string bytes;
  std::string note;  ///< what was left out or is suspicious, one line; often empty
};

/// Text or binary, by what the bytes are and not by the first word: upper case, blanks and marks in
/// front, any line ends, comments, several solids, `end loop`; a binary header that says "solid",
/// colours, bytes behind the last triangle. Refused in one line, with the line or triangle: counts
/// that do not fit the file, facets without three corners, numbers that are not finite. The numbers
/// themselves are passed on as they are written. Linear in the bytes.
Result<StrictStl> strict_stl(std::string_view bytes);

}  // namespace mortise
