// In every test program: one that aborts prints the calls that led there, so that a fault seen once
// on another machine can be looked for. `addr2line -e PROGRAM OFFSET` gives lines where a name is
// missing.
#include <execinfo.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cstring>

namespace {

void write_text(const char* text) {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, std::strlen(text));
}

// Nothing here asks for memory: the heap may be what is broken.
void tell(int signal) {
  std::array<char, 16> name{};
  pthread_getname_np(pthread_self(), name.data(), name.size());
  write_text("ended by a signal in thread ");
  write_text(name.data());
  write_text(", calls, innermost first:\n");
  std::array<void*, 64> calls{};
  backtrace_symbols_fd(calls.data(), backtrace(calls.data(), static_cast<int>(calls.size())),
                       STDERR_FILENO);
  raise(signal);  // its own action is back (SA_RESETHAND)
}

[[maybe_unused]] const bool kTells = [] {
  std::array<void*, 1> loads_its_library{};
  backtrace(loads_its_library.data(), 1);
  struct sigaction action {};
  action.sa_handler = tell;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_DFL) sigaction(signal, &action, nullptr);  // no sanitizer's own
  }
  return true;
}();

}  // namespace
