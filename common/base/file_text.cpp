#include "common/base/file_text.h"

#include <algorithm>
#include <fstream>

namespace mortise {

namespace fs = std::filesystem;

Result<std::string> file_text(const fs::path& file, std::uint64_t most_bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::is_directory(status))
    return fail(Code::kInvalidInput, file.string() + ": is a folder; name a file");
  if (fs::exists(status) && !fs::is_regular_file(status))
    return fail(Code::kInvalidInput,
                file.string() + ": is a pipe or a device; write it to a file, name that");
  std::ifstream in(file, std::ios::binary);
  const std::uint64_t size = in ? fs::file_size(file, error) : 0;
  if (!in || error)
    return fail(Code::kNotFound, file.string() + ": cannot be read; check the path");
  std::string text(static_cast<std::size_t>(std::min(size, most_bytes)), '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) return fail(Code::kRuntime, file.string() + ": reading broke off; check the disk");
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

}  // namespace mortise
