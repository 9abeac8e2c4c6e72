#include "client/web/step_reader.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "common/io/scenario/assembly_parts.h"
#include "common/io/scenario/brought_part.h"
#include "common/io/step/step_import.h"

namespace mortise::web {
namespace {

namespace fs = std::filesystem;

/// A folder for one file, gone with this.
class FolderOfOne {
 public:
  FolderOfOne() {
    std::error_code error;
    std::string pattern = (fs::temp_directory_path(error) / "mortise-step-XXXXXX").string();
    if (::mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  ~FolderOfOne() {
    std::error_code error;
    if (!path_.empty()) fs::remove_all(path_, error);
  }
  FolderOfOne(const FolderOfOne&) = delete;
  FolderOfOne& operator=(const FolderOfOne&) = delete;
  const fs::path& path() const { return path_; }  ///< empty: it could not be made

 private:
  fs::path path_;
};

// The page knows the file by the name that its sender gave.
std::string without_path(std::string text, const std::string& path, const std::string& name) {
  for (std::size_t at = text.find(path); at != std::string::npos;
       at = text.find(path, at + name.size()))
    text.replace(at, path.size(), name);
  return text;
}

BroughtAssembly brought(const StepDocument& document) {
  BroughtAssembly assembly;
  for (std::uint32_t i = 0; i < document.parts.size(); ++i)
    assembly.meshes.push_back(brought_bytes(document, i));
  for (const StepInstance& instance : document.instances)
    assembly.places.push_back({part_name_of(instance.path), instance.part, instance.X_WP});
  assembly.notes = document.notes;
  if (std::string unused = told_of_unused(listed_when_brought(document)); !unused.empty())
    assembly.notes.push_back(std::move(unused));
  for (const std::string& path : document.not_solid)
    assembly.notes.push_back(path + " is no solid: left out");
  return assembly;
}

}  // namespace

Result<BroughtAssembly> read_brought_step(const std::string& name,
                                          const std::vector<std::byte>& bytes) try {
  const FolderOfOne folder;
  if (folder.path().empty())
    return fail(Code::kRuntime, name + ": this gateway cannot make a folder to read it in");
  const fs::path path = folder.path() / "assembly.step";
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) return fail(Code::kRuntime, name + ": this gateway has no room to read it");
  const Result<StepAssembly> read = import_step(path);
  if (!read) return fail(read.error().code, without_path(read.error().text, path.string(), name));
  BroughtAssembly assembly = brought(read->document);
  if (assembly.places.empty()) return fail(Code::kInvalidInput, name + ": holds no solid");
  return assembly;
} catch (const std::exception& error) {  // memory
  return fail(Code::kRuntime, name + ": cannot be read: " + error.what());
}

}  // namespace mortise::web
