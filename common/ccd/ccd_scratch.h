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
  /// A node of a tree about the axis of a screw: see ScrewBounds.
  struct ScrewHull {
    static constexpr int kDirections = 8;  ///< a thread has four faces, a nut and its flats more
    enum State : std::uint8_t { kUnknown = 0, kKnown, kRoundAxis };
    double lo[kDirections], hi[kDirections];  ///< along directions of the plane (r, zeta), mm
    double theta_lo, theta_hi;                ///< rad, zeta is counted with the same turns
    double least_r_mm;                        ///< no point is nearer to the axis
    State state = kUnknown;                   ///< kRoundAxis: the axis is too near for an angle
  };
  std::vector<ScrewHull> hulls[2], triangle_hulls[2];
};

}  // namespace mortise
