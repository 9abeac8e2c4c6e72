#pragma once
#include <string>
#include <vector>

#include "client/tools/check/check.h"
#include "common/base/result.h"

namespace mortise {

/// What is asked of a check, by a command line or a function call.
struct CheckCommand {
  std::vector<std::string> files;  ///< one assembly or scenario, or meshes
  std::string unit, fit;           ///< of meshes
  std::string fail_on, baseline;
  std::string csv, html, junit, sqlite, bcf, session;  ///< files to write; empty: none
  std::vector<std::string> bought, fixed;
  std::string general;
  bool json = false, verbose = false, propose = false;
  CheckOptions check;
};

/// Do the wishes go together, and with the kind of the files? `files` is not empty.
Status coherent(const CheckCommand& command);

}  // namespace mortise
