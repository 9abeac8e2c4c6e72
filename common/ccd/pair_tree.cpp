#include "common/ccd/pair_tree.h"

namespace mortise::ccd {
namespace {

const Bvh::Oriented* oriented_of(const Bvh& bvh, std::int32_t node) {
  return node < 0 || bvh.nodes[node].oriented < 0 ? nullptr
                                                  : &bvh.oriented[bvh.nodes[node].oriented];
}

BoxAxes axes_of(const Bvh& bvh, const Bvh::Oriented* boxes) {
  if (boxes == nullptr) return {nullptr, Vec3::Zero(), bvh.radius_mm};
  return {&boxes->axes, boxes->from_origin, boxes->radius_mm};
}

OneBox one_box(const Bvh& bvh, const Bvh::Oriented* boxes, std::int32_t parent, std::int8_t slot) {
  if (boxes == nullptr) return box_of(bvh, parent, slot);
  OneBox box;
  for (int c = 0; c < 3; ++c) {
    box.center[c] = boxes->center[c][slot];
    box.half[c] = boxes->half[c][slot];
  }
  return box;
}

EightBoxes eight_boxes(const Bvh::Node& node, const Bvh::Oriented* boxes) {
  return boxes == nullptr ? EightBoxes{node.local_center, node.half}
                          : EightBoxes{boxes->center, boxes->half};
}

}  // namespace

bool open_oriented(const Item& item, const Bvh& a, const Bvh& b, PairMotion& motion,
                   double target_mm, const BoxKernels& kernels, float* dt) {
  const bool open_a = item.b < 0 || (item.a >= 0 && a.nodes[item.a].size >= b.nodes[item.b].size);
  const Bvh::Oriented* boxes_a = oriented_of(a, open_a ? item.a : item.parent_a);
  const Bvh::Oriented* boxes_b = oriented_of(b, open_a ? item.parent_b : item.b);
  const BoxFrame& frame = motion.frame(target_mm, axes_of(a, boxes_a), axes_of(b, boxes_b));
  if (open_a)
    kernels.advance_a(frame, eight_boxes(a.nodes[item.a], boxes_a),
                      one_box(b, boxes_b, item.parent_b, item.slot_b), dt);
  else
    kernels.advance_b(frame, one_box(a, boxes_a, item.parent_a, item.slot_a),
                      eight_boxes(b.nodes[item.b], boxes_b), dt);
  return open_a;
}

}  // namespace mortise::ccd
