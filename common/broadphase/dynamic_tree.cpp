// The only file of the library that names FCL.
#include "common/broadphase/dynamic_tree.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>

#include "common/base/check.h"

namespace mortise {
namespace {

// A fat box is larger than the box by this share of the longest edge, or by so many of the last
// steps of its centre where that is more, up to the larger share. After a long step it is not: the
// part would leave it at once. Wider: rarer queries of the tree, longer lists. The answer does not
// depend on it.
constexpr double kLeastMargin = 0.1, kMostMargin = 0.5, kStepsAhead = 16.0, kLongStep = 0.1;

// More than 100 epsilon sqrt(3), what FCL calls the same box, as a share of the largest coordinate.
constexpr double kFclSameBox = 1e-13;

// FCL takes the box of an object from its geometry; ours comes from the caller. The geometry is a
// placeholder that is never asked.
class BoxObject final : public fcl::CollisionObjectd {
 public:
  BoxObject(const std::shared_ptr<fcl::CollisionGeometryd>& placeholder, std::uint32_t part)
      : fcl::CollisionObjectd(placeholder), part_(part) {}
  // FCL takes a new box for the old one when their corners differ by less than 2.3e-14 of their
  // distance from the origin, and then keeps the old: grown by more than that, the old holds the
  // new.
  void set(const Box& box) {
    const double far = std::max(box.lo.cwiseAbs().maxCoeff(), box.hi.cwiseAbs().maxCoeff());
    const Box grown = box.grown(kFclSameBox * far);
    aabb.min_ = grown.lo;
    aabb.max_ = grown.hi;
  }
  std::uint32_t part() const { return part_; }

 private:
  std::uint32_t part_;
};

bool contains(const Box& outer, const Box& inner) {
  return (outer.lo.array() <= inner.lo.array()).all() &&
         (inner.hi.array() <= outer.hi.array()).all();
}

// Two trees of fat boxes: parts that have stood since they were added, and parts that have moved.
// Who was ever named as moved is watched, and keeps a list of all whose fat boxes meet its own. As
// long as boxes stay within their fat boxes the lists hold, and no tree is asked.
class DynamicTree final : public BroadPhase {
 public:
  void set_box(std::uint32_t part, const Box& box) override {
    MORTISE_CHECK(box.empty() || (box.lo.allFinite() && box.hi.allFinite()),
                  "the box of a part is finite or empty");
    if (part >= entries_.size()) {
      entries_.resize(part + 1);
      boxes_.resize(part + 1);
      is_moved_.resize(part + 1, 0);
    }
    const Box old = boxes_[part];
    boxes_[part] = box;
    if (box.empty()) return;
    Entry& entry = entries_[part];
    if (!entry.object) {
      entry.object = std::make_unique<BoxObject>(placeholder_, part);
      entry.fat = box;
    } else if (contains(entry.fat, box)) {
      return;
    } else {
      entry.stands = false;
      entry.fat = fat_box(old, box);
    }
    if (!entry.stale) stale_.push_back(part);
    entry.stale = true;
  }

  void find_pairs(std::span<const std::uint32_t> moved, std::vector<IndexPair>& pairs) override {
    pairs.clear();
    if (!stale_.empty()) renew_stale();
    for (const std::uint32_t i : moved) {
      MORTISE_CHECK(i < entries_.size(), "a part has a box before it moves");
      is_moved_[i] = 1;
      if (!entries_[i].watched) watch(i);
    }
    for (const std::uint32_t i : moved) {
      const Box box = boxes_[i];
      for (const std::uint32_t j : entries_[i].near) {
        // A pair of two moved parts is met twice; the lower one reports it.
        if (is_moved_[j] && j < i) continue;
        if (box.overlaps(boxes_[j])) pairs.push_back({std::min(i, j), std::max(i, j)});
      }
    }
    for (const std::uint32_t i : moved) is_moved_[i] = 0;
    std::sort(pairs.begin(), pairs.end());
  }

 private:
  enum class Home : std::uint8_t { kNone, kStanding, kRoaming };
  struct Entry {
    Box fat;
    std::unique_ptr<BoxObject> object;  ///< null: its box was never other than empty
    /// Whose fat boxes meet this one; of the watched all, of the others the watched ones.
    std::vector<std::uint32_t> near;
    Home home = Home::kNone;
    bool stands = true;  ///< within the box with which it was added
    bool stale = false;  ///< tree and lists do not know the fat box yet
    bool watched = false;
  };
  struct Query {
    DynamicTree& self;
    std::uint32_t part;
  };

  static Box fat_box(const Box& old, const Box& box) {
    const double longest = (box.hi - box.lo).maxCoeff();
    const double step = old.empty() ? 0.0 : (box.center() - old.center()).cwiseAbs().maxCoeff();
    if (step > kLongStep * longest) return box;
    return box.grown(std::clamp(kStepsAhead * step, kLeastMargin * longest, kMostMargin * longest));
  }

  // 1. Tell the trees. 2. Make the lists of the changed parts anew, when anybody has lists.
  void renew_stale() {
    std::vector<fcl::CollisionObjectd*>& added = changed_[0];
    std::vector<fcl::CollisionObjectd*>& roamed = changed_[1];
    added.clear();
    roamed.clear();
    for (const std::uint32_t i : stale_) {
      Entry& entry = entries_[i];
      fcl::CollisionObjectd* object = entry.object.get();
      entry.object->set(entry.fat);
      entry.stale = false;
      if (entry.home == Home::kRoaming) {
        roamed.push_back(object);
      } else if (entry.stands) {
        added.push_back(object);
        entry.home = Home::kStanding;
      } else {
        if (entry.home == Home::kStanding) standing_.unregisterObject(object);
        roaming_.registerObject(object);
        entry.home = Home::kRoaming;
      }
    }
    // All at once gives a better tree than one by one.
    if (standing_.empty())
      standing_.registerObjects(added);
    else
      for (fcl::CollisionObjectd* object : added) standing_.registerObject(object);
    standing_.setup();
    roaming_.setup();
    if (!roamed.empty()) roaming_.update(roamed);
    if (watched_count_ > 0)
      for (const std::uint32_t i : stale_) renew_list(i);
    stale_.clear();
  }

  void watch(std::uint32_t part) {
    entries_[part].watched = true;
    ++watched_count_;
    if (entries_[part].object) renew_list(part);
  }

  void renew_list(std::uint32_t i) {
    Entry& entry = entries_[i];
    for (const std::uint32_t j : entry.near) {
      std::vector<std::uint32_t>& near = entries_[j].near;
      *std::find(near.begin(), near.end(), i) = near.back();
      near.pop_back();
    }
    entry.near.clear();
    Query query{*this, i};
    standing_.collide(entry.object.get(), &query, &DynamicTree::visit);
    roaming_.collide(entry.object.get(), &query, &DynamicTree::visit);
  }

  static bool visit(fcl::CollisionObjectd* x, fcl::CollisionObjectd* y, void* data) {
    const Query& query = *static_cast<Query*>(data);
    const std::uint32_t i = query.part;
    const std::uint32_t other = static_cast<BoxObject*>(x)->part();
    const std::uint32_t j = other == i ? static_cast<BoxObject*>(y)->part() : other;
    Entry& a = query.self.entries_[i];
    Entry& b = query.self.entries_[j];
    if (i == j || !(a.watched || b.watched)) return false;
    // FCL keeps the older, larger box of an object that shrank: ask our own.
    if (a.fat.overlaps(b.fat)) {
      a.near.push_back(j);
      b.near.push_back(i);
    }
    return false;  // go on
  }

  std::shared_ptr<fcl::CollisionGeometryd> placeholder_ = std::make_shared<fcl::Sphered>(1.0);
  std::vector<Entry> entries_;
  std::vector<Box> boxes_;  ///< exact, apart from the entries: read for every neighbour
  std::vector<char> is_moved_;
  std::vector<std::uint32_t> stale_;
  std::size_t watched_count_ = 0;
  std::vector<fcl::CollisionObjectd*> changed_[2];  // memory of renew_stale
  fcl::DynamicAABBTreeCollisionManagerd standing_, roaming_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_dynamic_tree() { return std::make_unique<DynamicTree>(); }

}  // namespace mortise
