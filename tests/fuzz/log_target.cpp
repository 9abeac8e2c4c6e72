#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include "common/base/check.h"
#include "common/io/log/session_log.h"
#include "common/io/log/session_log_read.h"
#include "tests/fuzz/targets.h"

namespace mortise::test {

bool fuzz_log(std::span<const std::uint8_t> input) {
  const int file = memfd_create("log", 0);
  MORTISE_CHECK(file >= 0, "a memory file");
  const bool written =
      write(file, input.data(), input.size()) == static_cast<ssize_t>(input.size());
  const auto log = read_session_log("/proc/self/fd/" + std::to_string(file));
  close(file);
  MORTISE_CHECK(written, "the whole input");
  if (!log) {
    MORTISE_CHECK(!log.error().text.empty() && log.error().text.find('\n') == std::string::npos,
                  "one line of error");
    return false;
  }
  std::uint64_t before = 0;
  for (const TickRecord& tick : log->ticks) {
    MORTISE_CHECK(tick.tick > before, "ticks rise");
    before = tick.tick;
  }
  for (const LogGap& gap : log->gaps) MORTISE_CHECK(!gap.reason.empty(), "a gap says why");
  for (const auto& [hash, mesh] : log->meshes)
    MORTISE_CHECK(valid(mesh) && mesh_hash(mesh) == hash, "a mesh is the one that its name says");
  return true;
}

}  // namespace mortise::test
