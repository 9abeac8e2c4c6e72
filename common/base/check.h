#pragma once
#include <cstdio>
#include <cstdlib>

/// Checks a promise of our own code, not of its input: prints the place and aborts. Stays on in
/// release builds.
#define MORTISE_CHECK(condition, what)                                                             \
  do {                                                                                             \
    if (!(condition)) [[unlikely]] {                                                               \
      std::fprintf(stderr, "%s:%d: check failed: %s: %s\n", __FILE__, __LINE__, #condition, what); \
      std::abort();                                                                                \
    }                                                                                              \
  } while (false)
