#pragma once
#include "common/depth/depth.h"

/// Private to overlap: which of two parts comes first. A search that ends at its accuracy or its
/// cap ends elsewhere when the parts are exchanged, so they are put into a fixed order.
namespace mortise {

/// True when B comes before A in an order by what the parts are and where: by mesh, band, pose.
/// Cost: the bands are compared where the meshes are the same one.
bool b_comes_first(const OverlapQuery& query);

/// The same question, and the same answer, with the parts exchanged.
OverlapQuery mirrored(const OverlapQuery& query);
OverlapResult mirrored(OverlapResult result);

}  // namespace mortise
