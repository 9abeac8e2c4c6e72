#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/ids.h"
#include "common/math/pose.h"
#include "common/messages/mesh_bytes.h"
#include "common/messages/verdict.h"

namespace mortise::web {

/// Bytes that many browsers are sent, made once.
using SharedBytes = std::shared_ptr<const std::string>;

/// What a pose frame says of a part.
struct PartState {
  PartId part;
  UserId holder;
  Pose X_WP;
  std::uint32_t classes = 0;  ///< of its open clashes: class_bit()s
};

/// 1 fake, 2 potential, 4 real, 0 none.
constexpr std::uint32_t class_bit(CollisionClass value) {
  return value == CollisionClass::kNone ? 0u : 1u << (static_cast<unsigned>(value) - 1);
}

struct PoseFrame {
  std::uint64_t tick = 0;
  std::vector<PartState> parts;
};

/// The binary frame of protocol.md; positions exact, rotations rounded to f32.
std::string pose_frame(std::uint64_t tick, std::span<const PartState> parts);
/// Nothing when the bytes are not such a frame.
std::optional<PoseFrame> read_pose_frame(std::string_view bytes);

/// A mesh as a page reads it (protocol.md): points rounded to f32.
std::string page_mesh(const WireMesh& mesh);

}  // namespace mortise::web
