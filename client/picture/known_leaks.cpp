// Fontconfig, which finds the letters of a picture, keeps what it read until the process ends: no
// leak of ours. Compiled into each program that draws, and into the tests.
#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>  // declares it

const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }
#endif
