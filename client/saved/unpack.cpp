#include "client/saved/unpack.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "client/saved/saved_session.h"
#include "common/base/in_quotes.h"
#include "common/io/mesh/sandbox.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

// One message: what it is, how many bytes follow, and these.
enum class Told : char { kName = 'N', kBytes = 'B', kEnd = 'E', kRefused = 'R', kDone = 'D' };
// What a pipe of Linux takes at once.
constexpr std::size_t kMostOfMessage = 1 << 16;

// Of the process that reads; chosen.
constexpr std::uint64_t kMostMemory_bytes = 1ULL << 31U, kCpu_s = 300;

struct CloseArchive {
  void operator()(zip_t* zip) const { zip_discard(zip); }
};
struct CloseFile {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};

Error not_saved(const fs::path& archive, const std::string& what) {
  return fail(Code::kInvalidInput,
              archive.filename().string() + ": " + what + "; give an archive that Save wrote");
}

// Of what is saved: names of plain letters, in this folder or in that of the meshes.
bool is_saved_name(std::string_view name) {
  if (name == kSavedScenario) return true;
  if (!name.starts_with(kSavedMeshes)) return false;
  const bool part = name.ends_with(kSavedPart);
  if (!part && !name.ends_with(kSavedMesh)) return false;
  name.remove_prefix(kSavedMeshes.size());
  name.remove_suffix(part ? kSavedPart.size() : kSavedMesh.size());
  return !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
    return (c < 0x80 && std::isalnum(c) != 0) || c == '_' || c == '-';
  });
}

/// The reading process.
class Teller {
 public:
  Teller(const fs::path& archive, const SavedLimits& limits, int to)
      : archive_(archive), limits_(limits), to_(to) {}

  void run() {
    int error = 0;
    zip_.reset(zip_open(archive_.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &error));
    if (!zip_) {
      zip_error_t reason;
      zip_error_init_with_code(&reason, error);
      say(Told::kRefused,
          std::string("is no archive that can be read (") + zip_error_strerror(&reason) + ")");
      zip_error_fini(&reason);
      return;
    }
    const zip_int64_t count = zip_get_num_entries(zip_.get(), 0);
    if (count > static_cast<zip_int64_t>(limits_.files))
      return say(Told::kRefused, "holds " + std::to_string(count) + " files, more than " +
                                     std::to_string(limits_.files));
    // All names first, so that they are looked at before anything is written.
    std::vector<zip_uint64_t> files;
    for (zip_int64_t i = 0; i < count; ++i) {
      const auto index = static_cast<zip_uint64_t>(i);
      const char* name = zip_get_name(zip_.get(), index, 0);
      if (name != nullptr && name == kSavedMeshes) continue;  // a folder has no bytes
      say(Told::kName, name != nullptr ? name : "");
      files.push_back(index);
    }
    for (const zip_uint64_t index : files)
      if (!tell(index)) return;
    say(Told::kDone, "");
  }

 private:
  // The length in the archive's own list may be a lie: what comes out is told until it ends.
  bool tell(zip_uint64_t index) {
    const std::unique_ptr<zip_file_t, CloseFile> file(zip_fopen_index(zip_.get(), index, 0));
    const std::string name = zip_get_name(zip_.get(), index, 0);
    if (!file) {
      say(Told::kRefused, name + " cannot be read: " + zip_strerror(zip_.get()));
      return false;
    }
    std::array<char, kMostOfMessage> piece;
    for (;;) {
      const zip_int64_t read = zip_fread(file.get(), piece.data(), piece.size());
      if (read < 0) say(Told::kRefused, name + " is damaged");
      if (read < 0) return false;
      if (read == 0) break;
      say(Told::kBytes, {piece.data(), static_cast<std::size_t>(read)});
    }
    say(Told::kEnd, "");
    return true;
  }

  void say(Told what, std::string_view bytes) {
    bytes = bytes.substr(0, kMostOfMessage);
    const auto size = static_cast<std::uint32_t>(bytes.size());
    std::vector<std::byte> message(1 + sizeof size + bytes.size());
    message[0] = static_cast<std::byte>(what);
    std::memcpy(&message[1], &size, sizeof size);
    std::memcpy(message.data() + 1 + sizeof size, bytes.data(), bytes.size());
    if (!write_all(to_, message)) _exit(1);
  }

  const fs::path& archive_;
  const SavedLimits& limits_;
  int to_;
  std::unique_ptr<zip_t, CloseArchive> zip_;
};

/// The process that writes.
class Taker {
 public:
  Taker(int from, const fs::path& archive, const fs::path& folder, const SavedLimits& limits)
      : from_(from), archive_(archive), folder_(folder), limits_(limits) {}

  Status run() {
    for (;;) {
      if (!hear()) return too_early();
      switch (what_) {
        case Told::kName:
          if (Status named = take_name(); !named) return named;
          break;
        case Told::kBytes:
          if (Status taken = take_bytes(); !taken) return taken;
          break;
        case Told::kEnd:
          if (Status ended = end_file(); !ended) return ended;
          break;
        case Told::kRefused:
          return not_saved(archive_, plain(bytes_));
        case Told::kDone:
          return at_ == names_.size() && at_ > 0 ? ok() : too_early();
        default:
          return too_early();
      }
    }
  }

 private:
  Error too_early() const { return not_saved(archive_, "its reading ended before all was read"); }
  // Of a stranger: one line.
  static std::string plain(const std::string& text) {
    std::string line = text.substr(0, 300);
    std::ranges::replace_if(
        line, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    return line;
  }

  bool read(void* to, std::size_t size) {
    auto* at = static_cast<char*>(to);
    while (size > 0) {
      const ssize_t got = ::read(from_, at, size);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      at += got;
      size -= static_cast<std::size_t>(got);
    }
    return true;
  }

  bool hear() {
    std::uint32_t size = 0;
    if (!read(&what_, 1) || !read(&size, sizeof size) || size > kMostOfMessage) return false;
    bytes_.resize(size);
    return read(bytes_.data(), size);
  }

  Status take_name() {
    if (began_) return too_early();
    if (names_.size() >= limits_.files)
      return not_saved(archive_, "holds more files than " + std::to_string(limits_.files));
    if (!is_saved_name(bytes_))
      return not_saved(archive_, "holds " + in_quotes(bytes_) + ", which no saved session has");
    if (!known_.insert(bytes_).second) return not_saved(archive_, "holds " + bytes_ + " twice");
    names_.push_back(bytes_);
    return ok();
  }

  Status begin() {
    began_ = true;
    if (!known_.contains(std::string(kSavedScenario)))
      return not_saved(archive_, "holds no scenario.yaml");
    std::error_code error;
    fs::create_directories(folder_ / kSavedMeshes, error);
    if (!error) return ok();
    return fail(Code::kRuntime, folder_.string() + " cannot be made: " + error.message());
  }

  Status open_file() {
    if (!began_)
      if (Status begun = begin(); !begun) return begun;
    if (at_ >= names_.size()) return too_early();
    if (!out_.is_open()) out_.open(folder_ / names_[at_], std::ios::binary);
    return ok();
  }

  Status take_bytes() {
    if (Status opened = open_file(); !opened) return opened;
    taken_ += bytes_.size();
    if (taken_ > limits_.bytes)
      return not_saved(archive_,
                       "unpacks to more than " + std::to_string(limits_.bytes) + " bytes");
    of_file_ += bytes_.size();
    if (names_[at_] == kSavedScenario && of_file_ > limits_.scenario_bytes)
      return not_saved(archive_, names_[at_] + " has more than " +
                                     std::to_string(limits_.scenario_bytes) + " bytes");
    out_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    return out_ ? ok() : not_written();
  }

  Status end_file() {
    if (Status opened = open_file(); !opened) return opened;
    const bool whole = static_cast<bool>(out_.flush());
    out_.close();
    if (!whole) return not_written();
    ++at_;
    of_file_ = 0;
    return ok();
  }

  Status not_written() const {
    return fail(Code::kRuntime, (folder_ / names_[at_]).string() + " could not be written");
  }

  const int from_;
  const fs::path& archive_;
  const fs::path& folder_;
  const SavedLimits& limits_;
  Told what_ = Told::kDone;
  std::string bytes_;
  std::set<std::string> known_;
  std::vector<std::string> names_;
  std::size_t at_ = 0;  // the file that is written
  std::ofstream out_;
  std::uint64_t taken_ = 0, of_file_ = 0;
  bool began_ = false;
};

/// Runs tell_unpacked() in a process of its own; its words come out of `from`.
struct ReadingProcess {
  int from = -1;
  pid_t pid = -1;

  ReadingProcess(const fs::path& archive, const SavedLimits& limits) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    std::error_code error;
    const std::uint64_t size = fs::file_size(archive, error);
    Allowance allowance{memory_for(error ? 0 : size, kMostMemory_bytes), kMostMemory_bytes, kCpu_s,
                        static_cast<int>(getpid())};
    pid = fork();
    if (pid == 0) {
      close(ends[0]);
      if (!enter_sandbox(allowance, archive)) _exit(1);
      tell_unpacked(archive, limits, ends[1]);
      _exit(0);
    }
    close(ends[1]);
    from = ends[0];
  }
  ReadingProcess(const ReadingProcess&) = delete;
  ReadingProcess& operator=(const ReadingProcess&) = delete;
  ~ReadingProcess() {
    if (from >= 0) close(from);
    if (pid <= 0) return;
    kill(pid, SIGKILL);  // it has said all that is taken
    while (waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
};

}  // namespace

void tell_unpacked(const fs::path& archive, const SavedLimits& limits, int to) {
  Teller(archive, limits, to).run();
}

Status take_unpacked(int unpacked, const fs::path& archive, const fs::path& folder,
                     const SavedLimits& limits) {
  std::error_code error;
  const bool was_there = fs::exists(folder, error);
  Status done = Taker(unpacked, archive, folder, limits).run();
  if (done) return done;
  fs::remove_all(was_there ? folder / kSavedMeshes : folder, error);
  fs::remove(folder / kSavedScenario, error);
  return done;
}

Status unpack(const fs::path& archive, const fs::path& folder, const SavedLimits& limits) {
  if (Status free = is_free(folder); !free) return free;
  // A pipe would be waited for without end.
  if (std::error_code error; !fs::is_regular_file(archive, error))
    return not_saved(archive, "is no archive that can be read (no regular file)");
  const ReadingProcess reading(archive, limits);
  if (reading.pid <= 0)
    return fail(Code::kRuntime, std::string("no process can be started to read the archive: ") +
                                    std::strerror(errno));
  return take_unpacked(reading.from, archive, folder, limits);
}

}  // namespace mortise
