// The only file of the library that names FCL.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>

#include "common/broadphase/broad_phase.h"

namespace mortise {
namespace {

// FCL takes the box of an object from its geometry; ours comes from the caller. The geometry is a
// placeholder that is never asked.
class BoxObject final : public fcl::CollisionObjectd {
 public:
  BoxObject(const std::shared_ptr<fcl::CollisionGeometryd>& placeholder, std::uint32_t part)
      : fcl::CollisionObjectd(placeholder), part_(part) {}
  void set(const Box& box) {
    aabb.min_ = box.lo;
    aabb.max_ = box.hi;
  }
  std::uint32_t part() const { return part_; }

 private:
  std::uint32_t part_;
};

class DynamicTree final : public BroadPhase {
 public:
  DynamicTree() : placeholder_(std::make_shared<fcl::Sphered>(1.0)) {}

  void set_box(std::uint32_t part, const Box& box) override {
    if (part >= objects_.size()) {
      objects_.resize(part + 1);
      boxes_.resize(part + 1);
      is_moved_.resize(part + 1, 0);
    }
    boxes_[part] = box;
    if (box.empty()) return;
    if (!objects_[part]) {
      objects_[part] = std::make_unique<BoxObject>(placeholder_, part);
      objects_[part]->set(box);
      tree_.registerObject(objects_[part].get());
      return;
    }
    objects_[part]->set(box);
    changed_.push_back(objects_[part].get());
  }

  void find_pairs(std::span<const std::uint32_t> moved, std::vector<IndexPair>& pairs) override {
    pairs.clear();
    if (!changed_.empty()) tree_.update(changed_);
    changed_.clear();
    for (const std::uint32_t i : moved) is_moved_[i] = 1;
    for (const std::uint32_t i : moved) {
      if (!objects_[i]) continue;
      Query query{*this, i, pairs};
      tree_.collide(objects_[i].get(), &query, &DynamicTree::visit);
    }
    for (const std::uint32_t i : moved) is_moved_[i] = 0;
    std::sort(pairs.begin(), pairs.end());
  }

 private:
  struct Query {
    const DynamicTree& self;
    std::uint32_t part;
    std::vector<IndexPair>& pairs;
  };

  static bool visit(fcl::CollisionObjectd* x, fcl::CollisionObjectd* y, void* data) {
    const Query& query = *static_cast<Query*>(data);
    const std::uint32_t i = query.part;
    const std::uint32_t other = static_cast<BoxObject*>(x)->part();
    const std::uint32_t j = other == i ? static_cast<BoxObject*>(y)->part() : other;
    if (i == j) return false;
    // A pair of two moved parts is met twice; the lower one reports it.
    if (query.self.is_moved_[j] && j < i) return false;
    // The tree keeps the older, larger box of an object that shrank: ask the exact boxes.
    if (query.self.boxes_[i].overlaps(query.self.boxes_[j]))
      query.pairs.push_back({std::min(i, j), std::max(i, j)});
    return false;  // go on
  }

  std::shared_ptr<fcl::CollisionGeometryd> placeholder_;
  std::vector<std::unique_ptr<BoxObject>> objects_;
  std::vector<Box> boxes_;
  std::vector<char> is_moved_;
  std::vector<fcl::CollisionObjectd*> changed_;
  fcl::DynamicAABBTreeCollisionManagerd tree_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_dynamic_tree() { return std::make_unique<DynamicTree>(); }

}  // namespace mortise
