#pragma once
#include <string>

#include "client/tools/check/check.h"
#include "common/io/report_json.h"

namespace mortise {

/// The report for people, in the order in which a designer reads it. `verbose`: every contact and
/// every statement of the file, not only their counts.
struct CheckTextStyle {
  bool color = false, verbose = false;
};
std::string check_text(const OpenedScene& opened, const CheckReport& report, CheckTextStyle style);

/// One document (client/schemas); it begins with the counts.
Json check_json(const OpenedScene& opened, const CheckReport& report);

/// "real", "potential", "contact", "fake": the class of a pair, with what touches apart.
std::string class_word(const CheckedPair& pair);

}  // namespace mortise
