#pragma once
#include <map>
#include <set>
#include <string>

#include "client/web/feed.h"

namespace mortise::web {

/// Meshes of the scene in the form of the page, by content hash.
class MeshStore {
 public:
  /// Awaits the meshes of these parts. What is here stays: a part that was removed may come back,
  /// and the server keeps its mesh as long, but sends it once.
  void expect(const std::vector<PartInfo>& parts) {
    wanted_.clear();
    for (const PartInfo& part : parts) wanted_.insert(part.mesh_hash);
  }
  void put(const std::string& hash, const WireMesh& mesh) {
    meshes_[hash] = std::make_shared<const std::string>(page_mesh(mesh));
  }
  MeshAnswer find(const std::string& hash) const {
    const auto found = meshes_.find(hash);
    if (found != meshes_.end()) return {MeshAnswer::State::kHere, found->second};
    using enum MeshAnswer::State;
    return {wanted_.contains(hash) ? kAwaited : kUnknown, nullptr};
  }
  std::size_t size() const { return meshes_.size(); }

 private:
  std::set<std::string> wanted_;
  std::map<std::string, SharedBytes> meshes_;
};

}  // namespace mortise::web
