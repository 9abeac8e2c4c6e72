#pragma once
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <filesystem>
#include <set>
#include <string>

namespace mortise {

/// What a mesh may name: regular files beneath its own folder, links followed, for reading. All
/// else is not there for assimp. Each that is opened raises the limit of memory by its size, once.
class FolderFiles final : public Assimp::IOSystem {
 public:
  explicit FolderFiles(const std::filesystem::path& mesh);

  bool Exists(const char* file) const override;
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override;
  void Close(Assimp::IOStream* stream) override { delete stream; }

  /// The first file that is there and may not be read, as the mesh names it; empty: none.
  const std::string& refused() const { return refused_; }

 private:
  /// Empty: it lies elsewhere, or nowhere.
  std::filesystem::path real(const char* file) const;

  std::filesystem::path mesh_, folder_;
  mutable std::string refused_;
  std::set<std::filesystem::path> opened_;
};

}  // namespace mortise
