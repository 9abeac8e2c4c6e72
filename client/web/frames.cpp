#include "client/web/frames.h"

#include <array>
#include <bit>
#include <cstring>

namespace mortise::web {
namespace {

constexpr std::uint32_t kPoseMagic = 0x3146504d;        // "MPF1"
constexpr std::uint32_t kMeshMagicOfPage = 0x3148534d;  // "MSH1"

struct FrameHead {
  std::uint32_t magic, count;
  double tick;
};
struct FrameRow {
  std::uint32_t part, holder;
  double p_mm[3];
  float q_xyzw[4];
  std::uint32_t classes, reserved[3];
};
static_assert(sizeof(FrameHead) == 16 && sizeof(FrameRow) == 64);
static_assert(std::endian::native == std::endian::little, "rows are written as they lie");

template <class T>
void append(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

std::string pose_frame(std::uint64_t tick, std::span<const PartState> parts) {
  std::string out;
  out.reserve(sizeof(FrameHead) + parts.size() * sizeof(FrameRow));
  append(out, FrameHead{kPoseMagic, static_cast<std::uint32_t>(parts.size()),
                        static_cast<double>(tick)});
  for (const PartState& state : parts) {
    const Pose& X = state.X_WP;
    append(out, FrameRow{state.part.value,
                         state.holder.value,
                         {X.p.x(), X.p.y(), X.p.z()},
                         {static_cast<float>(X.q.x()), static_cast<float>(X.q.y()),
                          static_cast<float>(X.q.z()), static_cast<float>(X.q.w())},
                         state.classes,
                         {0, 0, 0}});
  }
  return out;
}

std::optional<PoseFrame> read_pose_frame(std::string_view bytes) {
  FrameHead head;
  if (bytes.size() < sizeof head) return std::nullopt;
  std::memcpy(&head, bytes.data(), sizeof head);
  if (head.magic != kPoseMagic || bytes.size() != sizeof head + head.count * sizeof(FrameRow))
    return std::nullopt;
  PoseFrame frame;
  frame.tick = static_cast<std::uint64_t>(head.tick);
  for (std::size_t k = 0; k < head.count; ++k) {
    FrameRow row;
    std::memcpy(&row, bytes.data() + sizeof head + k * sizeof row, sizeof row);
    PartState state;
    state.part = PartId{row.part};
    state.holder = UserId{row.holder};
    state.X_WP.p = Vec3(row.p_mm[0], row.p_mm[1], row.p_mm[2]);
    state.X_WP.q = Quat(row.q_xyzw[3], row.q_xyzw[0], row.q_xyzw[1], row.q_xyzw[2]);
    state.classes = row.classes;
    frame.parts.push_back(state);
  }
  return frame;
}

std::string page_mesh(const WireMesh& mesh) {
  std::string out;
  out.reserve(16 + mesh.points_mm.size() * 12 + mesh.triangles.size() * 12);
  append(out, std::array<std::uint32_t, 4>{kMeshMagicOfPage,
                                           static_cast<std::uint32_t>(mesh.points_mm.size()),
                                           static_cast<std::uint32_t>(mesh.triangles.size()), 0});
  for (const Vec3& p : mesh.points_mm) {
    append(out, std::array<float, 3>{static_cast<float>(p.x()), static_cast<float>(p.y()),
                                     static_cast<float>(p.z())});
  }
  for (const auto& triangle : mesh.triangles) append(out, triangle);
  return out;
}

}  // namespace mortise::web
