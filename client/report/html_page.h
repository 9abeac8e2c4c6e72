#pragma once
#include <string>
#include <string_view>

namespace mortise {

/// What every report page has besides its numbers: looks for screen and paper, light and dark, and
/// boxes that scroll where a table is wider than the window. `title` is text, and the heading.
std::string page_begin(const std::string& title);
std::string page_end();
std::string report_style();

/// The filters of the clash table. Without script all rows are shown.
std::string_view filter_script();

}  // namespace mortise
