#include "common/io/program_process.h"

#include <errno.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <system_error>

#include "common/base/result.h"

namespace mortise {
namespace {

// What the system may refuse anywhere, in a thread of a library too. Null: a fault of our own.
const char* what_is_missing() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    return "no memory is left: raise its limit (ulimit -v), or give it less to do";
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again)
      return "no further thread can be started: raise the limits of memory (ulimit -v) and "
             "processes (ulimit -u)";
  } catch (...) {
  }
  return nullptr;
}

std::terminate_handler& handler_before() {
  static std::terminate_handler before = nullptr;
  return before;
}

// Nothing here asks for memory.
[[noreturn]] void end_with_one_line() {
  if (const char* missing = what_is_missing()) {
    std::fprintf(stderr, "%s: %s\n", program_invocation_short_name, missing);
    std::_Exit(kExitRuntime);
  }
  if (handler_before() != nullptr) handler_before()();
  std::abort();
}

// A full disk, or a reader that is gone, is known when the last bytes are written. Destructors of
// static objects are left out: there is nothing left to say.
void end_with_whole_output() {
  errno = 0;
  std::cout.flush();
  const bool is_whole = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
  if (is_whole) return;
  const char* const why = errno != 0 ? std::strerror(errno) : "an earlier write failed";
  std::fprintf(stderr, "%s: stdout cannot be written (%s): what it got is not whole\n",
               program_invocation_short_name, why);
  _exit(kExitRuntime);
}

}  // namespace

void begin_program() {
  static const bool kBegun = [] {
    handler_before() = std::set_terminate(end_with_one_line);
    // A file that may not grow (ulimit -f) is an error of who writes it, with a text; not the end.
    std::signal(SIGXFSZ, SIG_IGN);
    return std::atexit(end_with_whole_output) == 0;
  }();
  (void)kBegun;
}

}  // namespace mortise
