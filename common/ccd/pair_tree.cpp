#include "common/ccd/pair_tree.h"

namespace mortise::ccd {
namespace {

BoxAxes axes_of(const Bvh& bvh, std::int32_t node) {
  if (node < 0) return {nullptr, Vec3::Zero(), bvh.radius_mm};
  const Bvh::Oriented& boxes = bvh.oriented[node];
  return {boxes.part_axes ? nullptr : &boxes.axes, boxes.from_origin, boxes.radius_mm};
}

OneBox oriented_box(const Bvh& bvh, std::int32_t parent, std::int8_t slot) {
  if (parent < 0) return box_of(bvh, parent, slot);
  OneBox box;
  for (int c = 0; c < 3; ++c) {
    box.center[c] = bvh.oriented[parent].center[c][slot];
    box.half[c] = bvh.oriented[parent].half[c][slot];
  }
  return box;
}

}  // namespace

bool open_oriented(const Item& item, const Bvh& a, const Bvh& b, PairMotion& motion,
                   double target_mm, const BoxKernels& kernels, float* dt) {
  const bool open_a = item.b < 0 || (item.a >= 0 && a.nodes[item.a].size >= b.nodes[item.b].size);
  const std::int32_t node_a = open_a ? item.a : item.parent_a;
  const std::int32_t node_b = open_a ? item.parent_b : item.b;
  const BoxFrame& frame = motion.frame(target_mm, axes_of(a, node_a), axes_of(b, node_b));
  if (open_a)
    kernels.advance_a(frame, {a.oriented[node_a].center, a.oriented[node_a].half},
                      oriented_box(b, item.parent_b, item.slot_b), dt);
  else
    kernels.advance_b(frame, oriented_box(a, item.parent_a, item.slot_a),
                      {b.oriented[node_b].center, b.oriented[node_b].half}, dt);
  return open_a;
}

}  // namespace mortise::ccd
