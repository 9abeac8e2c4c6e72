#pragma once
#include <memory>

#include "common/geometry/recognition/recognition.h"

namespace mortise {

/// What recognize_features finds, worked out once in a process for meshes of one content (by
/// Solid::hash) and the same options, when first asked for. Kept for the meshes that were asked for
/// last (kRecognizedTriangles of them); what was forgotten is worked out again, with the same
/// result. Thread safe. Waits for no other thread that is at work on the same mesh, since that may
/// be one of lowest priority: then both work it out.
std::shared_ptr<const Recognition> recognized(const Solid& solid,
                                              const RecognitionOptions& options = {});

/// Triangles of the meshes whose features are kept: several meshes of the largest size that is
/// measured (300k), while a process in which parts come and go for weeks does not grow. A mesh
/// larger than that is kept until the next one is asked for.
inline constexpr std::size_t kRecognizedTriangles = 4'000'000;

}  // namespace mortise
