#include "common/io/mesh/sandbox.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <vector>

namespace mortise {
namespace {

namespace fs = std::filesystem;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// Sanitizers reserve terabytes of address space, read /proc and start threads at the end.
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

/// Program and libraries take a part of the first; a mesh of few bytes may hold triangles without
/// number, since a node names one mesh as often as it likes.
constexpr std::uint64_t kLeastMemory_bytes = 1ULL << 30U;
/// GLB needs 6 bytes a triangle and more for its corners; here one is 72 bytes, three times over
/// while lists grow, and as much again in the reader.
constexpr std::uint64_t kMemoryOfByte = 64;

void limit(int what, rlim_t now, rlim_t most) {
  const rlimit both{std::min(now, most), most};
  setrlimit(static_cast<__rlimit_resource_t>(what), &both);
}

/// Files beneath a folder can be opened for reading, and nothing else.
void keep_to_folder(const fs::path& folder) {
  constexpr std::uint64_t kAll = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1U) - 1;  // what the first version
                                                                           // of Landlock knows
  landlock_ruleset_attr attributes{};
  attributes.handled_access_fs = kAll;
  const long rules = syscall(SYS_landlock_create_ruleset, &attributes, sizeof attributes, 0);
  if (rules < 0) return;  // a kernel without
  landlock_path_beneath_attr beneath{};
  beneath.allowed_access = LANDLOCK_ACCESS_FS_READ_FILE;
  beneath.parent_fd = open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (beneath.parent_fd >= 0)  // else nothing at all can be opened
    syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &beneath, 0);
  syscall(SYS_landlock_restrict_self, rules, 0);
  close(beneath.parent_fd);
  close(static_cast<int>(rules));
}

/// The system calls that remain, as a program for the kernel.
class SystemCalls {
 public:
  SystemCalls() {
    add(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, arch));
    add(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0);
    add(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS);
    add(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr));
  }
  void allow(long call) {
    add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1);
    add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  }
  /// Where none of these bits is set in an argument, counted from 0.
  void allow_without(long call, unsigned argument, std::uint32_t bits) {
    where(call, argument, BPF_JMP | BPF_JSET | BPF_K, bits, 1, 0);
  }
  void allow_with(long call, unsigned argument, std::uint32_t bits) {
    where(call, argument, BPF_JMP | BPF_JSET | BPF_K, bits, 0, 1);
  }
  void allow_equal(long call, unsigned argument, std::uint32_t value) {
    where(call, argument, BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1);
  }
  void refuse(long call, int error) {
    add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1);
    add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | static_cast<std::uint32_t>(error));
  }
  void hold() {
    add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM);
    const sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
  }

 private:
#if defined(__x86_64__)
  static constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
  static constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
#error "name the architecture, as linux/audit.h does"
#endif

  void add(int code, std::uint32_t k, std::uint8_t yes = 0, std::uint8_t no = 0) {
    code_.push_back({static_cast<std::uint16_t>(code), yes, no, k});
  }
  // The low half of an argument: each that is asked here is an int or a word of flags.
  void where(long call, unsigned argument, int test, std::uint32_t k, std::uint8_t yes,
             std::uint8_t no) {
    add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 4);
    add(BPF_LD | BPF_W | BPF_ABS,
        static_cast<std::uint32_t>(offsetof(seccomp_data, args) + 8 * argument));
    add(test, k, yes, no);
    add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM);
  }

  std::vector<sock_filter> code_;
};

/// What a program does that reads open files, computes, and writes to what is open.
// clang-format off
constexpr long kComputes[] = {
    SYS_read, SYS_pread64, SYS_readv, SYS_write, SYS_writev, SYS_lseek, SYS_close, SYS_fstat,
    SYS_newfstatat, SYS_statx, SYS_readlinkat, SYS_faccessat, SYS_faccessat2, SYS_getcwd,
    SYS_fcntl, SYS_dup, SYS_munmap, SYS_mremap, SYS_madvise, SYS_brk, SYS_rt_sigaction,
    SYS_rt_sigprocmask, SYS_rt_sigreturn, SYS_sigaltstack, SYS_futex, SYS_getpid, SYS_gettid,
    SYS_clock_gettime, SYS_clock_nanosleep, SYS_getrandom, SYS_sched_yield, SYS_sched_getaffinity,
    SYS_set_robust_list, SYS_rseq, SYS_uname, SYS_sysinfo, SYS_getrusage, SYS_exit,
    SYS_exit_group};
#if defined(__x86_64__)
constexpr long kOfThisMachine[] = {SYS_stat, SYS_lstat, SYS_readlink, SYS_access};
constexpr long kForHelpers[] = {SYS_clone, SYS_wait4, SYS_pipe2, SYS_pipe};
#else
constexpr long kOfThisMachine[] = {SYS_newfstatat};
constexpr long kForHelpers[] = {SYS_clone, SYS_wait4, SYS_pipe2};
#endif
// clang-format on

/// Files are opened for reading; no memory can be run.
void keep_to_computing(bool helpers) {
  constexpr auto kWrites = static_cast<std::uint32_t>(O_WRONLY | O_RDWR | O_CREAT | O_TRUNC);
  SystemCalls calls;
  for (const long call : kComputes) calls.allow(call);
  for (const long call : kOfThisMachine) calls.allow(call);
#if defined(__x86_64__)
  calls.allow_without(SYS_open, 1, kWrites);
#endif
  calls.allow_without(SYS_openat, 2, kWrites);
  calls.allow_without(SYS_mmap, 2, PROT_EXEC);
  calls.allow_without(SYS_mprotect, 2, PROT_EXEC);
  calls.allow_equal(SYS_prlimit64, 0, 0);
  calls.allow_equal(SYS_tgkill, 0, static_cast<std::uint32_t>(getpid()));  // abort()
  calls.refuse(SYS_clone3, ENOSYS);  // its flags cannot be seen; clone() is tried then
  for (const long call : kForHelpers)
    if (helpers) calls.allow(call);
  if (!helpers) calls.allow_with(SYS_clone, 0, CLONE_THREAD);
  calls.hold();
}

}  // namespace

std::uint64_t memory_for(std::uint64_t file_bytes, std::uint64_t most) {
  const std::uint64_t beyond = std::min(file_bytes, most / kMemoryOfByte) * kMemoryOfByte;
  return std::min(kLeastMemory_bytes + beyond, most);
}

std::string word_of(const Allowance& allowance) {
  return std::to_string(allowance.memory_bytes) + ":" +
         std::to_string(allowance.most_memory_bytes) + ":" + std::to_string(allowance.cpu_s) + ":" +
         std::to_string(allowance.parent);
}

std::optional<Allowance> allowance_of(const std::string& word) {
  unsigned long long memory = 0, most = 0, cpu = 0;
  Allowance allowance;
  if (std::sscanf(word.c_str(), "%llu:%llu:%llu:%d", &memory, &most, &cpu, &allowance.parent) != 4)
    return std::nullopt;
  allowance.memory_bytes = memory;
  allowance.most_memory_bytes = most;
  allowance.cpu_s = cpu;
  return allowance;
}

bool enter_sandbox(const Allowance& allowance, const fs::path& file, bool helpers) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != allowance.parent) return false;  // it ended before the line above
  if (!kSanitized) limit(RLIMIT_AS, allowance.memory_bytes, allowance.most_memory_bytes);
  limit(RLIMIT_FSIZE, allowance.most_memory_bytes, allowance.most_memory_bytes);
  limit(RLIMIT_CPU, allowance.cpu_s, allowance.cpu_s + 1);
  limit(RLIMIT_CORE, 0, 0);
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  std::error_code error;
  const fs::path real = fs::canonical(file, error);
  if (error) return false;
  if (kSanitized) return true;
  keep_to_folder(real.parent_path());
  keep_to_computing(helpers);
  return true;
}

void grant_memory_for(std::uint64_t file_bytes) {
  rlimit now{};
  if (kSanitized || getrlimit(RLIMIT_AS, &now) != 0) return;
  now.rlim_cur +=
      std::min(file_bytes, (now.rlim_max - now.rlim_cur) / kMemoryOfByte) * kMemoryOfByte;
  setrlimit(RLIMIT_AS, &now);
}

std::uint64_t granted_memory_bytes() {
  rlimit now{};
  const bool limited = getrlimit(RLIMIT_AS, &now) == 0 && now.rlim_cur != RLIM_INFINITY;
  return limited ? now.rlim_cur : 0;
}

bool write_all(int file, const std::vector<std::byte>& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(file, bytes.data() + done, bytes.size() - done);
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace mortise
