#include "common/io/log/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "common/io/log/crc32.h"

namespace mortise {

bool OutputFile::is_being_written(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool is_locked = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return is_locked;
}

Result<std::unique_ptr<OutputFile>> OutputFile::create(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0)
    return fail(Code::kRuntime, file.string() + ": cannot create the log: " +
                                    (errno == EEXIST ? "it exists already, choose another name"
                                                     : std::strerror(errno)));
  (void)::flock(descriptor, LOCK_EX | LOCK_NB);  // for is_being_written(); nobody else has it yet
  return std::unique_ptr<OutputFile>(new OutputFile(descriptor, file.string()));
}

OutputFile::OutputFile(int descriptor, std::string name)
    : descriptor_(descriptor), name_(std::move(name)) {}

OutputFile::~OutputFile() { ::close(descriptor_); }

void OutputFile::set_error(const char* doing) {
  if (!error_)
    error_ =
        fail(Code::kRuntime, name_ + ": cannot " + doing + " the log: " + std::strerror(errno) +
                                 "; what was written stays readable");
}

void OutputFile::write(std::span<const std::byte> bytes, std::span<const std::byte> more) {
  if (error_) return;
  for (auto rest = bytes, then = more; !rest.empty() || !then.empty();) {
    const iovec parts[] = {{const_cast<std::byte*>(rest.data()), rest.size()},
                           {const_cast<std::byte*>(then.data()), then.size()}};
    const ssize_t count = ::writev(descriptor_, parts, 2);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      set_error("write");
      // Best effort: a torn record would be found and left out by the reader as well.
      if (::ftruncate(descriptor_, static_cast<off_t>(offset_.load())) != 0) return;
      return;
    }
    const std::size_t of_rest = std::min(static_cast<std::size_t>(count), rest.size());
    rest = rest.subspan(of_rest);
    then = then.subspan(static_cast<std::size_t>(count) - of_rest);
  }
  for (const auto& part : {bytes, more}) {
    if (part.empty()) continue;  // its CRC would begin a new one
    crc_ = crc32(part, crc_);
    digest_.add(part);
  }
  offset_.fetch_add(bytes.size() + more.size(), std::memory_order_relaxed);
}

Status OutputFile::sync() {
  if (!error_ && ::fdatasync(descriptor_) != 0) set_error("flush");
  if (error_) return *error_;
  return ok();
}

}  // namespace mortise
