#pragma once
#include <string>
#include <string_view>

namespace mortise {

/// What every report page has besides its numbers: looks for screen and paper, light and dark, and
/// the filters of the clash table. Without script all rows are shown.
std::string report_style();
std::string_view report_script();

}  // namespace mortise
