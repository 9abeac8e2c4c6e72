#include "common/ccd/pair_tree.h"

namespace mortise::ccd {
bool open_oriented(const Item& item, const Bvh& a, const Bvh& b, PairMotion& motion,
                   double target_mm, const BoxKernels& kernels, float* dt) {
  const bool open_a = opens_a(item, a, b);
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
