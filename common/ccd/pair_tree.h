#pragma once
#include "common/ccd/leaf_pair.h"

// Pairs of nodes of two trees, shared by every traversal of this room.
namespace mortise::ccd {

using Item = CcdScratch::Item;

inline Item root_pair(const Bvh& a, const Bvh& b) { return {0.0, a.root, b.root, -1, -1, 0, 0}; }

inline bool is_leaf_pair(const Item& item) { return item.a < 0 && item.b < 0; }

/// Box of a node, as its parent holds it; of the root: all of the mesh.
inline OneBox box_of(const Bvh& bvh, std::int32_t parent, std::int8_t slot) {
  OneBox box;
  for (int c = 0; c < 3; ++c) {
    if (parent >= 0) {
      box.center[c] = bvh.nodes[parent].local_center[c][slot];
      box.half[c] = bvh.nodes[parent].half[c][slot];
    } else {
      box.center[c] = 0.0F;
      // Five ulp up: the conversion to float and the rounding of centre and half extent.
      box.half[c] = static_cast<float>(0.5 * (bvh.bounds.hi[c] - bvh.bounds.lo[c]) +
                                       8.0 * kUnitRoundoff * bvh.extent_mm) *
                    (1.0F + 3e-7F);
    }
  }
  return box;
}

/// Boxes of a node in axes of its own; null: those of the part.
inline const Bvh::Oriented* oriented_of(const Bvh& bvh, std::int32_t node) {
  return node < 0 || bvh.nodes[node].oriented < 0 ? nullptr
                                                  : &bvh.oriented[bvh.nodes[node].oriented];
}

inline BoxAxes axes_of(const Bvh& bvh, const Bvh::Oriented* boxes) {
  if (boxes == nullptr) return {nullptr, Vec3::Zero(), bvh.radius_mm};
  return {&boxes->axes, boxes->from_origin, boxes->radius_mm};
}

inline OneBox one_box(const Bvh& bvh, const Bvh::Oriented* boxes, std::int32_t parent,
                      std::int8_t slot) {
  if (boxes == nullptr) return box_of(bvh, parent, slot);
  OneBox box;
  for (int c = 0; c < 3; ++c) {
    box.center[c] = boxes->center[c][slot];
    box.half[c] = boxes->half[c][slot];
  }
  return box;
}

inline EightBoxes eight_boxes(const Bvh::Node& node, const Bvh::Oriented* boxes) {
  return boxes == nullptr ? EightBoxes{node.local_center, node.half}
                          : EightBoxes{boxes->center, boxes->half};
}

/// The larger node of a pair is opened.
inline bool opens_a(const Item& item, const Bvh& a, const Bvh& b) {
  return item.b < 0 || (item.a >= 0 && a.nodes[item.a].size >= b.nodes[item.b].size);
}
/// Opens the larger node of a pair and asks the kernel for a value of each child. True: opened A.
template <class KernelA, class KernelB>
bool open(const Item& item, const Bvh& a, const Bvh& b, const BoxFrame& frame, KernelA kernel_a,
          KernelB kernel_b, float* value) {
  const bool open_a = opens_a(item, a, b);
  const Bvh::Node& node = open_a ? a.nodes[item.a] : b.nodes[item.b];
  const EightBoxes eight{node.local_center, node.half};
  if (open_a)
    kernel_a(frame, eight, box_of(b, item.parent_b, item.slot_b), value);
  else
    kernel_b(frame, box_of(a, item.parent_a, item.slot_a), eight, value);
  return open_a;
}

/// The same with the boxes in axes of their own: how many ticks each child is free for.
bool open_oriented(const Item& item, const Bvh& a, const Bvh& b, PairMotion& motion,
                   double target_mm, const BoxKernels& kernels, float* dt);

/// The same of parts that stand still: a kernel for places alone.
template <class KernelA, class KernelB>
bool open_still(const Item& item, const Bvh& a, const Bvh& b, PairMotion& motion, KernelA kernel_a,
                KernelB kernel_b, float* value) {
  const bool open_a = opens_a(item, a, b);
  const Bvh::Oriented* boxes_a = oriented_of(a, open_a ? item.a : item.parent_a);
  const Bvh::Oriented* boxes_b = oriented_of(b, open_a ? item.parent_b : item.b);
  const BoxFrame& frame = motion.still_frame(axes_of(a, boxes_a), axes_of(b, boxes_b));
  if (open_a)
    kernel_a(frame, eight_boxes(a.nodes[item.a], boxes_a),
             one_box(b, boxes_b, item.parent_b, item.slot_b), value);
  else
    kernel_b(frame, one_box(a, boxes_a, item.parent_a, item.slot_a),
             eight_boxes(b.nodes[item.b], boxes_b), value);
  return open_a;
}

/// f(child_item, value) of every child pair after one side was opened.
template <class F>
void each_child(const Item& item, const Bvh& a, const Bvh& b, bool opened_a, const float* value,
                F f) {
  const Bvh::Node& node = opened_a ? a.nodes[item.a] : b.nodes[item.b];
  for (int k = 0; k < node.count; ++k) {
    Item child = item;
    if (opened_a) {
      child.a = node.child[k];
      child.parent_a = item.a;
      child.slot_a = static_cast<std::int8_t>(k);
    } else {
      child.b = node.child[k];
      child.parent_b = item.b;
      child.slot_b = static_cast<std::int8_t>(k);
    }
    f(child, static_cast<double>(value[k]));
  }
}

/// The same as open(), handing every child pair to f(child_item, value).
template <class KernelA, class KernelB, class F>
void open(const Item& item, const Bvh& a, const Bvh& b, const BoxFrame& frame, KernelA kernel_a,
          KernelB kernel_b, F f) {
  alignas(32) float value[Bvh::kWidth];
  const bool open_a = open(item, a, b, frame, kernel_a, kernel_b, static_cast<float*>(value));
  each_child(item, a, b, open_a, static_cast<const float*>(value), f);
}
/// Every leaf pair whose boxes are within limit_mm at motion.state(): f(LeafPair&) -> bool, true to
/// stop. Depth first; uses scratch.heap as a stack.
template <class F>
bool each_leaf_pair_within(PairMotion& motion, const Bvh& a, const Bvh& b, double limit_mm,
                           CcdScratch& scratch, CcdWork& work, F f) {
  const BoxKernels& kernels = best_kernels().box;
  const BoxFrame& frame = motion.frame(0.0);
  scratch.heap.clear();
  scratch.heap.push_back(root_pair(a, b));
  while (!scratch.heap.empty()) {
    const Item item = scratch.heap.back();
    scratch.heap.pop_back();
    if (is_leaf_pair(item)) {
      LeafPair leaves(a, item.a, b, item.b);
      if (f(leaves)) return true;
      continue;
    }
    ++work.box_tests;
    open(item, a, b, frame, kernels.lower_a, kernels.lower_b, [&](const Item& child, double lower) {
      if (lower <= limit_mm) scratch.heap.push_back(child);
    });
  }
  return false;
}

}  // namespace mortise::ccd
