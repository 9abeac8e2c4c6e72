#include "common/broadphase/brute_force.h"

#include <algorithm>

#include "common/base/check.h"

namespace mortise {
namespace {

class BruteForce final : public BroadPhase {
 public:
  void set_box(std::uint32_t part, const Box& box) override {
    MORTISE_CHECK(box.empty() || (box.lo.allFinite() && box.hi.allFinite()),
                  "the box of a part is finite or empty");
    if (part >= boxes_.size()) boxes_.resize(part + 1);
    boxes_[part] = box;
  }

  void find_pairs(std::span<const std::uint32_t> moved, std::vector<IndexPair>& pairs) override {
    pairs.clear();
    for (const std::uint32_t i : moved) {
      MORTISE_CHECK(i < boxes_.size(), "a part has a box before it moves");
      for (std::uint32_t j = 0; j < boxes_.size(); ++j)
        if (i != j && !boxes_[j].empty() && boxes_[i].overlaps(boxes_[j]))
          pairs.push_back({std::min(i, j), std::max(i, j)});
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  }

 private:
  std::vector<Box> boxes_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_brute_force() { return std::make_unique<BruteForce>(); }

}  // namespace mortise
