#include "common/io/mesh/confined_child.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
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
#include <sstream>

#include "common/io/mesh/sandbox.h"

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

/// Wall time for processor time: what takes longer waits for something, or the machine does much
/// else.
constexpr double kWallOfCpu = 1.4;

std::uint64_t size_of(const fs::path& file) {
  std::error_code error;
  const std::uint64_t size = fs::file_size(file, error);
  return error ? 0 : size;
}

/// More time for a larger file: what is small and takes much is hostile.
double cpu_limit_s(const ConfinedChild& child) {
  const double asked_s =
      child.cpu.least_s + child.cpu.s_for_MB * 1e-6 * static_cast<double>(size_of(child.file));
  return std::clamp(asked_s, 1.0, std::clamp(child.limits.seconds, 1.0, 1e6));
}

double wall_limit_s(const ConfinedChild& child) {
  return std::clamp(child.limits.seconds, 0.0, kWallOfCpu * cpu_limit_s(child));
}

std::string allowance_word(const ConfinedChild& child) {
  Allowance allowance;
  allowance.memory_bytes = memory_for(size_of(child.file), child.limits.memory_bytes);
  allowance.most_memory_bytes = child.limits.memory_bytes;
  allowance.cpu_s = static_cast<std::uint64_t>(std::ceil(cpu_limit_s(child)));
  allowance.parent = getpid();
  return word_of(allowance);
}

/// posix_spawn, not fork: a server with many threads may not run code between fork and exec. The
/// child sees nothing of ours but the memory files for its questions (-1: none) and its answer. It
/// begins a group of processes, which ends with it.
Result<pid_t> spawn(const ConfinedChild& child, int question, int answer) {
  std::vector<std::string> words{child.program.string()};
  words.insert(words.end(), child.arguments.begin(), child.arguments.end());
  words.push_back(allowance_word(child));
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (question < 0)
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  else
    posix_spawn_file_actions_adddup2(&actions, question, STDIN_FILENO);
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
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  pid_t pid = 0;
  const int error =
      posix_spawn(&pid, child.program.c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    return fail(Code::kRuntime, "cannot start the " + child.called + " " + child.program.string() +
                                    ": " + std::strerror(error) + "; " + child.where_from);
  return pid;
}

/// Waits at most `seconds`; kills what is still running then. Gives the wait status; -1: not known.
struct End {
  bool timed_out = false;
  int status = -1;
  bool well() const {
    return !timed_out && status != -1 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
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
      kill(-pid, SIGKILL);  // helpers that it left
      pid_t reaped;
      while ((reaped = waitpid(pid, &end.status, 0)) < 0 && errno == EINTR) {
      }
      if (reaped < 0) end.status = -1;
      return end;
    }
  }
  end.timed_out = true;
  kill(-pid, SIGKILL);
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
std::string reason_of_end(const End& end, const ConfinedChild& child, double seconds) {
  const ImportLimits& limits = child.limits;
  if (end.timed_out)
    return "reading took longer than " + seconds_text(seconds) +
           " and was ended; simplify the file, or raise the time limit of the import";
  if (end.status == -1) return "the importer's end could not be observed; try again";
  if (WIFSIGNALED(end.status)) {
    const int signal_number = WTERMSIG(end.status);
    if (signal_number == SIGXCPU)
      return "reading took too much processor time and was ended; simplify the file";
    if (signal_number == SIGXFSZ)
      return "what is in it needs more than " + megabytes(limits.memory_bytes) +
             "; simplify the file, or raise the memory limit of the import";
    if (signal_number == SIGKILL)
      return "the importer was killed from outside (out of memory?); simplify the file";
    const char* name = sigabbrev_np(signal_number);
    return "the importer crashed on it (SIG" + std::string(name != nullptr ? name : "?") +
           "): the file is damaged or hostile; export it again from CAD";
  }
  return "the importer ended with code " + std::to_string(WEXITSTATUS(end.status)) +
         " and no answer; is " + child.program.string() + " the " + child.called + "?";
}

}  // namespace

MappedBytes::~MappedBytes() {
  if (bytes_.data() != nullptr) munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

fs::path program_beside(const char* variable, const char* name) {
  if (const char* named = std::getenv(variable); named != nullptr && *named != '\0') return named;
  std::error_code ignored;
  const fs::path beside = fs::read_symlink("/proc/self/exe", ignored).parent_path() / name;
  if (fs::exists(beside, ignored)) return beside;
  // The library within a program of others: where the shell would find it.
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (!folder.empty() && fs::is_regular_file(fs::path(folder) / name, ignored))
      return fs::path(folder) / name;
  return beside;
}

Result<MappedBytes> run_confined(const ConfinedChild& child) {
  const Descriptor answer(memfd_create("mortise-answer", MFD_CLOEXEC));
  const Descriptor question(child.question.empty() ? -1
                                                   : memfd_create("mortise-question", MFD_CLOEXEC));
  if (!answer || (!child.question.empty() && !question))
    return system_error("cannot make a memory file for the " + child.called);
  for (std::size_t done = 0; done < child.question.size();) {
    const ssize_t n = pwrite(question.get(), child.question.data() + done,
                             child.question.size() - done, static_cast<off_t>(done));
    if (n <= 0) return system_error("cannot write to the " + child.called);
    done += static_cast<std::size_t>(n);
  }
  Result<pid_t> pid = spawn(child, question.get(), answer.get());
  if (!pid) return pid.error();
  const double seconds = wall_limit_s(child);
  const End end = wait_for(*pid, seconds);
  if (!end.well()) return fail(Code::kInvalidInput, reason_of_end(end, child, seconds));

  struct stat info {};
  if (fstat(answer.get(), &info) != 0) return system_error("cannot read the importer's answer");
  const auto size = static_cast<std::size_t>(info.st_size);
  if (size == 0) return fail(Code::kRuntime, reason_of_end(end, child, seconds));
  void* bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, answer.get(), 0);
  if (bytes == MAP_FAILED) return system_error("cannot map the importer's answer");
  return MappedBytes({static_cast<const std::byte*>(bytes), size});
}

namespace {

int milliseconds_to(Clock::time_point deadline) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
  return static_cast<int>(std::clamp<long long>(left.count(), 0, 1'000'000'000));
}

Clock::time_point after(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(
                            std::chrono::duration<double>(std::clamp(seconds, 0.0, 1e6)));
}

/// False: it ended, or the time is over.
bool wait_to(int socket, short event, Clock::time_point deadline) {
  pollfd waited{socket, event, 0};
  int ready;
  while ((ready = poll(&waited, 1, milliseconds_to(deadline))) < 0 && errno == EINTR) {
  }
  return ready > 0;
}

bool receive_all(int socket, void* to, std::size_t count, Clock::time_point deadline) {
  auto* bytes = static_cast<std::byte*>(to);
  for (std::size_t done = 0; done < count;) {
    if (!wait_to(socket, POLLIN, deadline)) return false;
    const ssize_t n = recv(socket, bytes + done, count - done, MSG_DONTWAIT);
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) return false;
    if (n > 0) done += static_cast<std::size_t>(n);
  }
  return true;
}

bool send_all(int socket, std::span<const std::byte> bytes, Clock::time_point deadline) {
  while (!bytes.empty()) {
    if (!wait_to(socket, POLLOUT, deadline)) return false;
    const ssize_t n = send(socket, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (n < 0 && errno != EAGAIN && errno != EINTR) return false;
    if (n > 0) bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace

ConfinedDialogue::ConfinedDialogue(ConfinedDialogue&& other) noexcept
    : child_(std::move(other.child_)),
      pid_(std::exchange(other.pid_, 0)),
      answer_(std::exchange(other.answer_, -1)),
      socket_(std::exchange(other.socket_, -1)),
      said_(std::move(other.said_)),
      said_bytes_(other.said_bytes_) {}

ConfinedDialogue::~ConfinedDialogue() {
  if (pid_ > 0) (void)wait_for(pid_, 0.0);
  if (answer_ >= 0) close(answer_);
  if (socket_ >= 0) close(socket_);
}

Result<ConfinedDialogue> ConfinedDialogue::start(const ConfinedChild& child) {
  ConfinedDialogue dialogue(child);
  if (const Status begun = dialogue.begin(); !begun) return begun.error();
  return dialogue;
}

Status ConfinedDialogue::begin() {
  int ends[2];
  answer_ = memfd_create("mortise-answer", MFD_CLOEXEC);
  if (answer_ < 0 || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return system_error("cannot make a memory file and a socket for the " + child_.called);
  socket_ = ends[0];
  const double seconds = wall_limit_s(child_);
  const Clock::time_point deadline = after(seconds);
  {
    const Descriptor theirs(ends[1]);  // closed here: then the end of the child is seen
    const Result<pid_t> pid = spawn(child_, theirs.get(), answer_);
    if (!pid) return pid.error();
    pid_ = *pid;
  }
  std::uint64_t length = 0;
  if (!receive_all(socket_, &length, sizeof length, deadline))
    return end_of_child(milliseconds_to(deadline) * 1e-3, seconds);
  Result<std::vector<std::byte>> said = answer_from(0, length);
  if (!said) return said.error();
  said_ = std::move(*said);
  said_bytes_ = said_.size();
  return ok();
}

Result<std::vector<std::byte>> ConfinedDialogue::ask(std::span<const std::byte> question,
                                                     double seconds) {
  if (pid_ <= 0) return fail(Code::kRuntime, "the " + child_.called + " answers one question");
  const Clock::time_point deadline = after(seconds);
  if (send_all(socket_, question, deadline)) shutdown(socket_, SHUT_WR);
  const End end = wait_for(std::exchange(pid_, 0), milliseconds_to(deadline) * 1e-3);
  if (!end.well()) return fail(Code::kInvalidInput, reason_of_end(end, child_, seconds));
  struct stat info {};
  if (fstat(answer_, &info) != 0) return system_error("cannot read the importer's answer");
  return answer_from(said_bytes_, static_cast<std::size_t>(info.st_size));
}

// It said nothing, and ended or is ended.
Error ConfinedDialogue::end_of_child(double seconds_left, double seconds) {
  const End end = wait_for(std::exchange(pid_, 0), seconds_left);
  return fail(Code::kInvalidInput, reason_of_end(end, child_, seconds));
}

// A copy: the child still runs, and could write there while it is read.
Result<std::vector<std::byte>> ConfinedDialogue::answer_from(std::size_t begin,
                                                             std::size_t end) const {
  struct stat info {};
  const bool known = fstat(answer_, &info) == 0;
  if (!known || begin > end || end > static_cast<std::size_t>(info.st_size))
    return fail(Code::kRuntime, "the " + child_.called + " answered with less than it said");
  std::vector<std::byte> bytes(end - begin);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n =
        pread(answer_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(begin + done));
    if (n <= 0) return system_error("cannot read the importer's answer");
    done += static_cast<std::size_t>(n);
  }
  return bytes;
}

}  // namespace mortise
