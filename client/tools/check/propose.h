#pragma once
#include <string>

#include "client/tools/check/check.h"

namespace mortise {

/// A scenario of the assembly in which each fit that nobody has stated stands as a comment with its
/// count, to be filled in.
std::string proposal_of(const OpenedScene& opened, const CheckReport& report,
                        const std::string& step);

/// Writes it beside the STEP file, as NAME.mortise.yaml; what is there already is left alone, and
/// that is an error.
Status write_proposal(const OpenedScene& opened, const CheckReport& report,
                      const std::string& step);

}  // namespace mortise
