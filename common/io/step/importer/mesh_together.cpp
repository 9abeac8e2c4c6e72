#include "common/io/step/importer/mesh_together.h"

#include <TopExp_Explorer.hxx>
#include <TopoDS_TShape.hxx>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <unordered_map>

#include "common/base/union_find.h"

namespace mortise {
namespace {

// The memory of the importer is limited, and each thread needs its own.
constexpr unsigned kMostThreads = 8;

// Numbers of shapes that hang together by what they share.
std::vector<std::vector<std::size_t>> groups_of(const std::vector<TopoDS_Shape>& solids) {
  UnionFind together(solids.size());
  std::unordered_map<const void*, std::uint32_t> owner;
  for (std::uint32_t i = 0; i < solids.size(); ++i)
    for (const TopAbs_ShapeEnum kind : {TopAbs_FACE, TopAbs_EDGE})
      for (TopExp_Explorer x(solids[i], kind); x.More(); x.Next()) {
        const auto [known, fresh] = owner.try_emplace(x.Current().TShape().get(), i);
        if (!fresh) together.join(known->second, i);
      }
  std::vector<std::vector<std::size_t>> of_root(solids.size()), groups;
  for (std::uint32_t i = 0; i < solids.size(); ++i) of_root[together.leader_of(i)].push_back(i);
  for (auto& group : of_root)
    if (!group.empty()) groups.push_back(std::move(group));
  return groups;
}

class Meshing {
 public:
  Meshing(const std::vector<TopoDS_Shape>& solids, const MeshOptions& options)
      : solids_(solids), options_(options), groups_(groups_of(solids)), parts_(solids.size()) {}

  std::vector<StepPart> run() {
    const std::size_t count =
        std::min<std::size_t>({groups_.size(), std::max(1U, std::thread::hardware_concurrency()),
                               std::size_t{kMostThreads}});
    std::vector<std::thread> others;
    for (std::size_t i = 1; i < count; ++i) others.emplace_back([this] { work(); });
    work();
    for (std::thread& other : others) other.join();
    if (failure_) std::rethrow_exception(failure_);
    if (triangles_ > kMostStepTriangles) parts_.clear();
    return std::move(parts_);
  }

 private:
  void work() try {
    for (std::size_t i; (i = next_++) < groups_.size();)
      for (const std::size_t part : groups_[i]) {
        if (triangles_ > kMostStepTriangles) return;
        parts_[part] = mesh_part(solids_[part], options_);
        triangles_ += parts_[part].mesh.triangles.size();
      }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
    next_ = groups_.size();
  }

  const std::vector<TopoDS_Shape>& solids_;
  const MeshOptions& options_;
  std::vector<std::vector<std::size_t>> groups_;
  std::vector<StepPart> parts_;
  std::atomic<std::size_t> next_ = 0, triangles_ = 0;
  std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace

std::vector<StepPart> mesh_together(const std::vector<TopoDS_Shape>& solids,
                                    const MeshOptions& options) {
  return Meshing(solids, options).run();
}

}  // namespace mortise
