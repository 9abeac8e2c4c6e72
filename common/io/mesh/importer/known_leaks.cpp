// What assimp keeps until the process ends is no leak of ours. In a build with the address
// sanitizer it ended each import with exit code 1.
#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>  // declares it

const char* __lsan_default_suppressions() { return "leak:libassimp"; }
#endif
