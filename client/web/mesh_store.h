#pragma once
#include <map>
#include <set>
#include <string>

#include "client/web/feed.h"

namespace mortise::web {

/// Meshes of the scene in the form of the page, by content hash.
class MeshStore {
 public:
  /// Awaits the meshes of these parts and drops all others.
  void expect(const std::vector<PartInfo>& parts) {
    wanted_.clear();
    for (const PartInfo& part : parts) wanted_.insert(part.mesh_hash);
    std::erase_if(meshes_, [&](const auto& row) { return !wanted_.contains(row.first); });
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
