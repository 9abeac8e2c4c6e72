#include "common/base/result.h"

namespace mortise {

int exit_code_of(Code code) {
  switch (code) {
    case Code::kInvalidInput:
    case Code::kNotFound:
    case Code::kUnsupported:
    case Code::kLimit:
      return kExitBadInput;
    case Code::kMismatch:
      return kExitMismatch;
    case Code::kRuntime:
      break;
  }
  return kExitRuntime;
}

}  // namespace mortise
