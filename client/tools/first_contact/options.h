#pragma once
#include <cstdint>
#include <string>

#include "common/base/constants.h"

namespace mortise {

struct FirstContactOptions {
  std::string moving, fixed, motions, out;
  double unit_mm = 1.0;
  double accuracy_mm = kAccuracyDefault_mm;
  std::uint64_t work_cap = kCcdWorkCap;
  bool json = false;  ///< one document on stdout
};

struct FirstContactCommandLine {
  FirstContactOptions options;
  int exit_code = -1;  ///< >= 0: stop with it
};

FirstContactCommandLine read_first_contact_command_line(int argc, char** argv);

}  // namespace mortise
