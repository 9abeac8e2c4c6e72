#include "common/io/log/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace mortise {

InputFile::InputFile(const std::filesystem::path& file)
    // Not to wait for a writer, where it is a pipe; nothing else on a regular file.
    : descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  struct stat info {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &info) != 0) return;
  if (!S_ISREG(info.st_mode)) {
    errno = EINVAL;
    return;
  }
  size_ = static_cast<std::uint64_t>(info.st_size);
  open_ = true;
}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::span<const std::byte> InputFile::read(std::uint64_t offset, std::uint64_t length,
                                           std::vector<std::byte>& buffer) const {
  const std::uint64_t there = offset < size_ ? std::min(length, size_ - offset) : 0;
  if (buffer.size() < there) buffer.resize(static_cast<std::size_t>(there));
  std::size_t done = 0;
  while (done < there) {
    const ssize_t count =
        ::pread(descriptor_, buffer.data() + done, static_cast<std::size_t>(there) - done,
                static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes_read_ += done;
  return std::span<const std::byte>(buffer).first(done);
}

}  // namespace mortise
