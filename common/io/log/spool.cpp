#include "common/io/log/spool.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <vector>

namespace mortise {

Spool::Spool(const std::filesystem::path& folder)
    : descriptor_(
          ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600)) {}

Spool::~Spool() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Spool::append(std::span<const std::byte> bytes) {
  memory_.raw(bytes);
  if (descriptor_ >= 0 && memory_.size() >= kBlockBytes && write_out()) memory_.clear();
}

// Written again from the same place when it did not go through.
bool Spool::write_out() {
  const std::span<const std::byte> all = memory_.bytes();
  for (std::size_t done = 0; done < all.size();) {
    const ssize_t count = ::pwrite(descriptor_, all.data() + done, all.size() - done,
                                   static_cast<off_t>(on_disk_ + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  on_disk_ += all.size();
  return true;
}

bool Spool::read(const std::function<void(std::span<const std::byte>)>& take) const {
  std::vector<std::byte> block(kBlockBytes);
  for (std::uint64_t from = 0; from < on_disk_;) {
    const std::size_t most = std::min<std::uint64_t>(block.size(), on_disk_ - from);
    const ssize_t count = ::pread(descriptor_, block.data(), most, static_cast<off_t>(from));
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) errno = EIO;  // shorter than it was written
    if (count <= 0) return false;
    take(std::span(block).first(static_cast<std::size_t>(count)));
    from += static_cast<std::uint64_t>(count);
  }
  take(memory_.bytes());
  return true;
}

}  // namespace mortise
