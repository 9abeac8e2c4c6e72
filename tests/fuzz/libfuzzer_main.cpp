// Entry of libFuzzer; the target is named at compile time.
#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)mortise::test::MORTISE_FUZZ_TARGET({data, size});
  return 0;
}
