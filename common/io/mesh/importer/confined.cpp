#include "common/io/mesh/importer/confined.h"

#include <sys/resource.h>
#include <unistd.h>

namespace mortise {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif

void limit(int what, rlim_t most) {
  const rlimit both{most, most};
  setrlimit(static_cast<__rlimit_resource_t>(what), &both);
}

}  // namespace

void confine_this_process(std::uint64_t bytes, std::uint64_t seconds) {
  if (kLimitsMemory) limit(RLIMIT_AS, bytes);
  limit(RLIMIT_FSIZE, bytes);
  limit(RLIMIT_CPU, seconds + 1);
  limit(RLIMIT_CORE, 0);
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
