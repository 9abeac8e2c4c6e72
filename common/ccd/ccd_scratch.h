#pragma once
#include <cstdint>
#include <vector>

namespace mortise {

/// Reused between queries so that a warm query does not allocate. One per thread.
struct CcdScratch {
  struct Item {
    double t;
    std::int32_t a, b, parent_a, parent_b;
    std::int8_t slot_a, slot_b;
  };
  std::vector<Item> heap;
  // first_contact: see PairQueue.
  struct Entry {
    std::uint64_t t_bits, member;
  };
  struct Family {
    Item parent;
    std::int32_t opened;
    float dt[8];
  };
  std::vector<Item> now;
  std::vector<Entry> entries;
  std::vector<Family> families;
};

}  // namespace mortise
