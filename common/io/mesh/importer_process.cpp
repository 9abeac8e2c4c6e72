#include "common/io/mesh/importer_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>

extern char** environ;

namespace mortise {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// Closes a file descriptor at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_;
};

Error system_error(const std::string& what) {
  return fail(Code::kRuntime, what + ": " + std::strerror(errno));
}

/// posix_spawn, not fork: a server with many threads may not run code between fork and exec. The
/// child sees nothing of ours but the memory file for its answer.
Result<pid_t> spawn(const fs::path& program, std::vector<std::string> words, int answer) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, answer, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(&actions, 3);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t all, none;
  sigfillset(&all);
  sigemptyset(&none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  pid_t pid = 0;
  const int error = posix_spawn(&pid, program.c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    return fail(Code::kRuntime, "cannot start the mesh importer " + program.string() + ": " +
                                    std::strerror(error) +
                                    "; build the target mortise-import, or set MORTISE_IMPORTER");
  return pid;
}

/// Waits at most `seconds`; kills what is still running then. Gives the wait status; -1: not known.
struct End {
  bool timed_out = false;
  int status = -1;
};

End wait_for(pid_t pid, double seconds) {
  End end;
  const Descriptor process(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double>(std::clamp(seconds, 0.0, 1e6)));
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) break;
    // Without a pidfd (old kernel) look again every few milliseconds.
    pollfd event{process.get(), POLLIN, 0};
    const int timeout = static_cast<int>(std::min<long long>(left, process ? 60'000 : 5));
    const int ready = poll(&event, process ? 1 : 0, timeout);
    siginfo_t info{};
    const bool look = ready > 0 || !process;
    if (look && (waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
                 info.si_pid == pid)) {
      pid_t reaped;
      while ((reaped = waitpid(pid, &end.status, 0)) < 0 && errno == EINTR) {
      }
      if (reaped < 0) end.status = -1;
      return end;
    }
  }
  end.timed_out = true;
  kill(pid, SIGKILL);
  while (waitpid(pid, &end.status, 0) < 0 && errno == EINTR) {
  }
  return end;
}

std::string megabytes(std::uint64_t bytes) { return std::to_string(bytes >> 20U) + " MB"; }

std::string seconds_text(double seconds) {
  const std::string text = std::to_string(seconds);
  return text.substr(0, text.find('.') + 2) + " s";
}

/// What the end of the process means when it said nothing usable.
std::string reason_of_end(const End& end, const ImportLimits& limits) {
  if (end.timed_out)
    return "reading took longer than " + seconds_text(limits.seconds) +
           " and was ended; simplify the file, or raise the time limit of the import";
  if (end.status == -1) return "the importer's end could not be observed; try again";
  if (WIFSIGNALED(end.status)) {
    const int signal_number = WTERMSIG(end.status);
    if (signal_number == SIGXCPU)
      return "reading took too much processor time and was ended; simplify the file";
    if (signal_number == SIGXFSZ)
      return "its triangles need more than " + megabytes(limits.memory_bytes) +
             "; simplify the file, or raise the memory limit of the import";
    if (signal_number == SIGKILL)
      return "the importer was killed from outside (out of memory?); simplify the file";
    const char* name = sigabbrev_np(signal_number);
    return "the importer crashed on it (SIG" + std::string(name != nullptr ? name : "?") +
           "): the file is damaged or hostile; export it again from CAD";
  }
  return "the importer ended with code " + std::to_string(WEXITSTATUS(end.status)) +
         " and no answer; is MORTISE_IMPORTER a mesh importer?";
}

}  // namespace

fs::path importer_program() {
  if (const char* named = std::getenv("MORTISE_IMPORTER"); named != nullptr && *named != '\0')
    return named;
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).parent_path() / "mortise-import";
}

Result<RawSoup> run_importer(const fs::path& file, const std::string& extension,
                             const ImportLimits& limits) {
  const Descriptor answer(memfd_create("mortise-import", MFD_CLOEXEC));
  if (!answer) return system_error("cannot make a memory file for the mesh importer");
  const fs::path program = importer_program();
  std::error_code ignored;
  const double seconds = std::clamp(limits.seconds, 0.0, 1e6);
  Result<pid_t> pid =
      spawn(program,
            {program.string(), fs::absolute(file, ignored).string(), extension,
             std::to_string(limits.memory_bytes), std::to_string(std::llround(std::ceil(seconds)))},
            answer.get());
  if (!pid) return pid.error();
  const End end = wait_for(*pid, seconds);
  const bool well =
      !end.timed_out && end.status != -1 && WIFEXITED(end.status) && WEXITSTATUS(end.status) == 0;
  if (!well) return fail(Code::kInvalidInput, reason_of_end(end, limits));

  struct stat info {};
  if (fstat(answer.get(), &info) != 0) return system_error("cannot read the importer's answer");
  const auto size = static_cast<std::size_t>(info.st_size);
  if (size == 0) return fail(Code::kRuntime, reason_of_end(end, limits));
  void* bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, answer.get(), 0);
  if (bytes == MAP_FAILED) return system_error("cannot map the importer's answer");
  Result<RawSoup> soup = decode({static_cast<const std::byte*>(bytes), size});
  munmap(bytes, size);
  return soup;
}

}  // namespace mortise
