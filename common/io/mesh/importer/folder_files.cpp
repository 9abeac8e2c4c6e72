#include "common/io/mesh/importer/folder_files.h"

#include <assimp/DefaultIOStream.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <string_view>

#include "common/io/mesh/sandbox.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

/// Closes the file with itself.
struct OpenFile final : Assimp::DefaultIOStream {
  OpenFile(std::FILE* file, const std::string& name) : DefaultIOStream(file, name) {}
};

bool is_beneath(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first ==
         folder.end();
}

/// glTF names files by URIs, where a blank is %20; assimp passes them on as they are.
std::string without_percents(std::string_view uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const std::string_view digits = uri.substr(i + 1, 2);
    unsigned char byte = 0;
    const auto [end, status] =
        std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
    const bool coded = uri[i] == '%' && digits.size() == 2 && status == std::errc{} &&
                       end == digits.data() + 2 && byte != 0;
    out += coded ? static_cast<char>(byte) : uri[i];
    if (coded) i += 2;
  }
  return out;
}

}  // namespace

FolderFiles::FolderFiles(const fs::path& mesh) {
  std::error_code error;
  mesh_ = fs::canonical(mesh, error);
  folder_ = mesh_.parent_path();
  opened_.insert(mesh_);  // its size is counted already
}

fs::path FolderFiles::real(const char* file) const {
  std::error_code error;
  fs::path path = fs::canonical(file, error);
  if (error) path = fs::canonical(without_percents(file), error);
  if (error) return {};
  if (is_beneath(path, folder_)) return path;
  if (refused_.empty()) refused_ = file;
  return {};
}

bool FolderFiles::Exists(const char* file) const { return !real(file).empty(); }

Assimp::IOStream* FolderFiles::Open(const char* file, const char* mode) {
  const fs::path path = real(file);
  if (path.empty() || mode[0] != 'r' || std::string(mode).find('+') != std::string::npos)
    return nullptr;
  // No link any more, and a pipe is not waited for.
  const int fd = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  struct stat info {};
  if (fd < 0) return nullptr;
  std::FILE* stream = fstat(fd, &info) == 0 && S_ISREG(info.st_mode) ? fdopen(fd, "rb") : nullptr;
  if (stream == nullptr) {
    close(fd);
    return nullptr;
  }
  if (opened_.insert(path).second) grant_memory_for(static_cast<std::uint64_t>(info.st_size));
  return new OpenFile(stream, path.string());
}

}  // namespace mortise
