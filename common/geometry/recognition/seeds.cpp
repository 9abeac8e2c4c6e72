#include "common/geometry/recognition/seeds.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mortise {
namespace {

// Facets to either side of the seed, longest ribbon first.
constexpr int kReach[] = {8, 3, 1};
// Triangles of a patch, largest first.
constexpr std::size_t kPatch[] = {60, 18};
// A facet of more triangles than this is a plane, not a step of a round.
constexpr std::size_t kLargestFacet = 256;
// Three triangles in a row have five corners: too few for any guess.
constexpr std::size_t kLeastRibbon = 4;
// The far edge of a facet of a round runs nearly along the near one.
constexpr double kOpposite = 0.85;

// Which ribbons and smaller patches lie within each patch.
void tell_parts_of_patches(SeedSets& sets, Marks& in_patch) {
  for (std::size_t i = 0; i < sets.patches.size(); ++i) {
    SeedSet& patch = sets.patches[i];
    in_patch.clear();
    for (const std::uint32_t t : patch.triangles) in_patch.add(t);
    const auto look = [&](const SeedSet& part, std::size_t bit) {
      if (part.triangles.size() < patch.triangles.size() &&
          std::all_of(part.triangles.begin(), part.triangles.end(),
                      [&](std::uint32_t t) { return in_patch.has(t); }))
        patch.holds |= 1U << bit;
    };
    for (std::size_t k = 0; k < sets.ribbons.size(); ++k) look(sets.ribbons[k], k);
    for (std::size_t k = i + 1; k < sets.patches.size(); ++k)
      look(sets.patches[k], SeedSets::kPatchBit + k);
  }
}

}  // namespace

SeedFinder::SeedFinder(const Solid& solid, const Facets& facets, const RegionGrower& grower)
    : mesh_(solid.mesh()), topology_(solid.topology()), facets_(facets), grower_(grower) {
  for (std::uint32_t f = 0; f < facets_.count(); ++f) {
    if (facets_.reliable[f] && facets_.triangles(f).size() <= kLargestFacet) add_crossings_of(f);
    begin_.push_back(crossings_.size());
  }
}

// By falling length.
void SeedFinder::add_crossings_of(std::uint32_t facet) {
  std::vector<Crossing> all;
  for (const std::uint32_t t : facets_.triangles(facet))
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t other = topology_.neighbor[t][k];
      if (!grower_.smooth(t, k)) continue;
      const std::uint32_t g = facets_.of_triangle[other];
      if (g == facet || !facets_.reliable[g]) continue;
      const Vec3 edge = mesh_.corner(t, (k + 1) % 3) - mesh_.corner(t, k);
      const double length = edge.norm();
      if (length > 0.0) all.push_back({g, edge / length, length});
    }
  std::stable_sort(all.begin(), all.end(),
                   [](const Crossing& a, const Crossing& b) { return a.length_mm > b.length_mm; });
  const auto first = static_cast<std::ptrdiff_t>(crossings_.size());
  for (const Crossing& c : all)
    if (std::none_of(crossings_.begin() + first, crossings_.end(),
                     [&](const Crossing& o) { return o.facet == c.facet; }))
      crossings_.push_back(c);
}

bool SeedFinder::bends_smoothly(std::uint32_t facet) const { return !crossings(facet).empty(); }

// The way on from a facet that was entered across an edge of this direction.
const SeedFinder::Crossing* SeedFinder::onward(std::uint32_t facet, const Vec3& along,
                                               std::span<const std::uint32_t> been) const {
  const Crossing* best = nullptr;
  double best_dot = kOpposite;
  for (const Crossing& way : crossings(facet)) {
    const double dot = std::fabs(way.along.dot(along));
    if (dot <= best_dot || std::find(been.begin(), been.end(), way.facet) != been.end()) continue;
    best = &way;
    best_dot = dot;
  }
  return best;
}

std::vector<std::uint32_t> SeedFinder::walk(std::uint32_t seed, Crossing step,
                                            std::uint32_t not_into) const {
  std::vector<std::uint32_t> row;
  row.reserve(2 + kReach[0]);
  row = {seed, not_into};
  for (int i = 0; i < kReach[0]; ++i) {
    row.push_back(step.facet);
    const Crossing* next = onward(step.facet, step.along, row);
    if (next == nullptr) break;
    step = *next;
  }
  row.erase(row.begin(), row.begin() + 2);
  return row;
}

std::vector<std::uint32_t> SeedFinder::triangles_of(std::span<const std::uint32_t> row) const {
  std::size_t count = 0;
  for (const std::uint32_t f : row) count += facets_.triangles(f).size();
  std::vector<std::uint32_t> out;
  out.reserve(count);
  for (const std::uint32_t f : row)
    for (const std::uint32_t t : facets_.triangles(f)) out.push_back(t);
  return out;
}

void SeedFinder::add_ribbons(std::uint32_t seed, SeedSets& sets) const {
  constexpr std::size_t kMostDirections = 3;  // across the three edges of a triangle
  std::vector<std::uint32_t> started;
  for (const Crossing& first : crossings(seed)) {
    if (started.size() >= 2 * kMostDirections) break;
    if (std::find(started.begin(), started.end(), first.facet) != started.end()) continue;
    started.push_back(first.facet);
    const Crossing* back = onward(seed, first.along, std::array{seed, first.facet});
    const auto ahead = walk(seed, first, back ? back->facet : seed);
    std::vector<std::uint32_t> behind;
    if (back) {
      started.push_back(back->facet);
      behind = walk(seed, *back, first.facet);
      std::erase_if(behind, [&](std::uint32_t f) {
        return std::find(ahead.begin(), ahead.end(), f) != ahead.end();
      });
    }
    std::size_t last = 0;
    const std::size_t longest = sets.ribbons.size();
    for (const int reach : kReach) {
      // The end of an arc has neighbours on one side only: then twice as many there.
      const auto most = [&](const auto& other) {
        return other.empty() ? 2 * static_cast<std::size_t>(reach)
                             : static_cast<std::size_t>(reach);
      };
      const std::size_t m = std::min(ahead.size(), most(behind));
      const std::size_t n = std::min(behind.size(), most(ahead));
      if (m + n < 2 || m + n == last) continue;
      last = m + n;
      std::vector<std::uint32_t> row{seed};
      row.insert(row.end(), ahead.begin(), ahead.begin() + static_cast<std::ptrdiff_t>(m));
      row.insert(row.end(), behind.begin(), behind.begin() + static_cast<std::ptrdiff_t>(n));
      std::vector<std::uint32_t> ribbon = triangles_of(row);
      if (ribbon.size() < kLeastRibbon) continue;
      for (std::size_t i = longest; i < sets.ribbons.size(); ++i)
        sets.ribbons[i].holds |= 1U << sets.ribbons.size();
      sets.ribbons.emplace_back().triangles = std::move(ribbon);
    }
  }
}

void SeedFinder::add_patches(std::uint32_t seed, SeedSets& sets, Marks& met) const {
  const auto own = facets_.triangles(seed);
  std::vector<std::uint32_t> patch(own.begin(), own.end());
  patch.reserve(kPatch[0] + 2);
  if (patch.size() > kPatch[0]) patch.resize(kPatch[0]);
  met.clear();
  for (const std::uint32_t t : patch) met.add(t);
  for (std::size_t next = 0; next < patch.size() && patch.size() < kPatch[0]; ++next)
    for (int k = 0; k < 3; ++k) {
      if (!grower_.smooth(patch[next], k)) continue;
      const std::uint32_t other = topology_.neighbor[patch[next]][k];
      if (met.add(other)) patch.push_back(other);
    }
  std::size_t last = 0;
  for (const std::size_t size : kPatch) {
    const std::size_t n = std::min(size, patch.size());
    if (n < 6 || n == last) continue;
    last = n;
    sets.patches.emplace_back().triangles.assign(patch.begin(),
                                                 patch.begin() + static_cast<std::ptrdiff_t>(n));
  }
  // The facet and those beside it: whatever else is near belongs to others.
  std::vector<std::uint32_t> beside{seed};
  for (const Crossing& way : crossings(seed)) beside.push_back(way.facet);
  std::vector<std::uint32_t> cross = triangles_of(beside);
  if (cross.size() >= 4 && cross.size() <= kPatch[0])
    sets.patches.emplace_back().triangles = std::move(cross);
}

SeedSets SeedFinder::about(std::uint32_t facet, Marks& triangles) const {
  SeedSets sets;
  add_ribbons(facet, sets);
  add_patches(facet, sets, triangles);
  tell_parts_of_patches(sets, triangles);
  return sets;
}

}  // namespace mortise
