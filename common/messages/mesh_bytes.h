#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "common/math/types.h"

namespace mortise {

/// A mesh as it goes over the wire, little-endian, laid out so that a page can view it without
/// copying:
///   byte 0: u32 magic "MMSH", u32 version 1, u32 points n, u32 triangles m
///   byte 16: f64 x, y, z of n points (part frame, mm); then u32 a, b, c of m triangles
/// (counter-clockwise seen from outside).
inline constexpr std::uint32_t kMeshMagic = 0x48534d4d;
inline constexpr std::uint32_t kMeshVersion = 1;
inline constexpr std::size_t kMeshHeaderBytes = 16;

struct WireMesh {
  std::vector<Vec3> points_mm;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie");
static_assert(sizeof(Vec3) == 24 && sizeof(std::array<std::uint32_t, 3>) == 12);

inline std::vector<std::byte> mesh_to_bytes(
    std::span<const Vec3> points_mm, std::span<const std::array<std::uint32_t, 3>> triangles) {
  const std::array<std::uint32_t, 4> header = {kMeshMagic, kMeshVersion,
                                               static_cast<std::uint32_t>(points_mm.size()),
                                               static_cast<std::uint32_t>(triangles.size())};
  std::vector<std::byte> bytes(kMeshHeaderBytes + points_mm.size_bytes() + triangles.size_bytes());
  std::memcpy(bytes.data(), header.data(), kMeshHeaderBytes);
  const auto behind = std::ranges::copy(std::as_bytes(points_mm), bytes.begin() + kMeshHeaderBytes);
  std::ranges::copy(std::as_bytes(triangles), behind.out);
  return bytes;
}

/// Nothing when the bytes are not such a mesh, or a triangle names a missing point.
inline std::optional<WireMesh> mesh_from_bytes(std::span<const std::byte> bytes) {
  std::array<std::uint32_t, 4> header;
  if (bytes.size() < kMeshHeaderBytes) return std::nullopt;
  std::memcpy(header.data(), bytes.data(), kMeshHeaderBytes);
  const std::uint64_t points = header[2], triangles = header[3];
  if (header[0] != kMeshMagic || header[1] != kMeshVersion ||
      bytes.size() != kMeshHeaderBytes + points * sizeof(Vec3) + triangles * 12) {
    return std::nullopt;
  }
  WireMesh mesh;
  mesh.points_mm.resize(points);
  mesh.triangles.resize(triangles);
  const std::byte* at = bytes.data() + kMeshHeaderBytes;
  if (points > 0) std::memcpy(mesh.points_mm.data()->data(), at, points * sizeof(Vec3));
  if (triangles > 0) {
    std::memcpy(mesh.triangles.data()->data(), at + points * sizeof(Vec3), triangles * 12);
  }
  for (const auto& triangle : mesh.triangles) {
    for (std::uint32_t corner : triangle) {
      if (corner >= points) return std::nullopt;
    }
  }
  return mesh;
}

}  // namespace mortise
