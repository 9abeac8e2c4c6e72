#pragma once
#include <algorithm>
#include <bit>
#include <limits>

#include "common/ccd/pair_tree.h"

namespace mortise::ccd {

/// Pairs of nodes by the time up to which they are proven free, earliest first. The children of a
/// pair stay together; only the earliest of them waits in the heap. Of equal times the one that
/// came first in the order of the trees: the order is total, the same on every machine.
class PairQueue {
 public:
  using Family = CcdScratch::Family;
  using Entry = CcdScratch::Entry;

  PairQueue(const Bvh& a, const Bvh& b, CcdScratch& scratch)
      : a_(a), b_(b), now_(scratch.now), heap_(scratch.entries), families_(scratch.families) {
    clear();
  }

  void clear() {
    now_.clear();
    heap_.clear();
    families_.clear();
    last_ = kNone;
  }

  bool empty() const { return now_.empty() && heap_.empty(); }

  /// Time of the next pair; `t_now` of the pair that is looked at.
  double next_time(double t_now) const {
    return !now_.empty() ? t_now : heap_.empty() ? 1.0 : time_of(heap_.front());
  }

  /// Of the time that is looked at: it is next.
  void push_now(const Item& item) { now_.push_back(item); }

  /// The pair that was popped last, once more.
  void push_again(const Item& item) {
    if (last_ == kNone) {
      last_ = families_.size();
      families_.push_back({item, kItself, {}});
    }
    families_[last_].parent = item;
    push_entry(item.t, last_, 0);
  }

  /// The children of `item` after one side was opened; child k is free for dt[k] ticks more.
  void push_children(const Item& item, bool opened_a, const float* dt) {
    families_.push_back({item, opened_a ? kOpenedA : kOpenedB, {}});
    Family& family = families_.back();
    const Bvh::Node& node = opened_a ? a_.nodes[item.a] : b_.nodes[item.b];
    for (int k = 0; k < node.count; ++k) {
      family.dt[k] = dt[k];
      if (dt[k] > 0.0F) continue;
      push_now(child(family, k));
      family.dt[k] = kTaken;
    }
    for (int k = node.count; k < Bvh::kWidth; ++k) family.dt[k] = kTaken;
    if (!push_earliest(families_.size() - 1)) families_.pop_back();
  }

  Item pop() {
    last_ = kNone;
    if (!now_.empty()) {
      const Item item = now_.back();
      now_.pop_back();
      return item;
    }
    std::pop_heap(heap_.begin(), heap_.end(), Later{});
    const Entry entry = heap_.back();
    heap_.pop_back();
    Family& family = families_[entry.member / Bvh::kWidth];
    if (family.opened == kItself) {
      last_ = entry.member / Bvh::kWidth;
      return family.parent;
    }
    const auto slot = static_cast<int>(entry.member % Bvh::kWidth);
    Item item = child(family, slot);
    item.t = time_of(entry);
    family.dt[slot] = kTaken;
    push_earliest(entry.member / Bvh::kWidth);
    return item;
  }

 private:
  static constexpr std::int32_t kItself = 0, kOpenedA = 1, kOpenedB = 2;
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  static constexpr float kTaken = std::numeric_limits<float>::infinity();

  // Times are not negative, so their bits are in the same order; as one integer with the member
  // they are compared without a branch.
  struct Later {
    bool operator()(const Entry& x, const Entry& y) const {
      __extension__ typedef unsigned __int128 Key;
      return (static_cast<Key>(x.t_bits) << 64 | x.member) >
             (static_cast<Key>(y.t_bits) << 64 | y.member);
    }
  };

  static double time_of(const Entry& entry) { return std::bit_cast<double>(entry.t_bits); }

  void push_entry(double t, std::size_t family, std::size_t slot) {
    heap_.push_back({std::bit_cast<std::uint64_t>(t), family * Bvh::kWidth + slot});
    std::push_heap(heap_.begin(), heap_.end(), Later{});
  }

  bool push_earliest(std::size_t index) {
    const Family& family = families_[index];
    float best = family.dt[0];
    std::size_t slot = 0;
    for (std::size_t k = 1; k < Bvh::kWidth; ++k)
      if (family.dt[k] < best) {
        best = family.dt[k];
        slot = k;
      }
    const double t = family.parent.t + static_cast<double>(best);
    if (!(t < 1.0)) return false;
    push_entry(t, index, slot);
    return true;
  }

  Item child(const Family& family, int k) const {
    Item item = family.parent;
    if (family.opened == kOpenedA) {
      item.parent_a = item.a;
      item.slot_a = static_cast<std::int8_t>(k);
      item.a = a_.nodes[item.a].child[k];
    } else {
      item.parent_b = item.b;
      item.slot_b = static_cast<std::int8_t>(k);
      item.b = b_.nodes[item.b].child[k];
    }
    return item;
  }

  const Bvh& a_;
  const Bvh& b_;
  std::vector<Item>& now_;
  std::vector<Entry>& heap_;
  std::vector<Family>& families_;
  std::size_t last_ = kNone;  // family of a pair that was put back before
};

}  // namespace mortise::ccd
