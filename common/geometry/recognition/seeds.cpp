#include "common/geometry/recognition/seeds.h"

#include <algorithm>
#include <cmath>

namespace mortise {
namespace {

// Facets to either side of the seed, longest ribbon first.
constexpr int kReach[] = {8, 3, 1};
// Triangles of a patch, largest first.
constexpr std::size_t kPatch[] = {60, 18};
// A facet of more triangles than this is a plane, not a step of a round.
constexpr std::size_t kLargestFacet = 256;
// The far edge of a facet of a round runs nearly along the near one.
constexpr double kOpposite = 0.85;

}  // namespace

SeedFinder::SeedFinder(const Solid& solid, const Facets& facets, const RegionGrower& grower)
    : mesh_(solid.mesh()),
      topology_(solid.topology()),
      facets_(facets),
      grower_(grower),
      mark_(mesh_.triangles.size(), 0) {
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
                                               const std::vector<std::uint32_t>& been) const {
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
  std::vector<std::uint32_t> row, been{seed, not_into};
  for (int i = 0; i < kReach[0]; ++i) {
    row.push_back(step.facet);
    been.push_back(step.facet);
    const Crossing* next = onward(step.facet, step.along, been);
    if (next == nullptr) break;
    step = *next;
  }
  return row;
}

void SeedFinder::add_triangles(std::uint32_t facet, std::vector<std::uint32_t>& out) const {
  const auto triangles = facets_.triangles(facet);
  out.insert(out.end(), triangles.begin(), triangles.end());
}

void SeedFinder::add_ribbons(std::uint32_t seed, SeedSets& sets) const {
  constexpr std::size_t kMostDirections = 3;  // across the three edges of a triangle
  std::vector<std::uint32_t> started;
  for (const Crossing& first : crossings(seed)) {
    if (started.size() >= 2 * kMostDirections) break;
    if (std::find(started.begin(), started.end(), first.facet) != started.end()) continue;
    started.push_back(first.facet);
    const Crossing* back = onward(seed, first.along, {seed, first.facet});
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
      std::vector<std::uint32_t> ribbon;
      add_triangles(seed, ribbon);
      for (std::size_t i = 0; i < m; ++i) add_triangles(ahead[i], ribbon);
      for (std::size_t i = 0; i < n; ++i) add_triangles(behind[i], ribbon);
      for (std::size_t i = longest; i < sets.ribbons.size(); ++i)
        sets.ribbons[i].holds |= 1U << sets.ribbons.size();
      sets.ribbons.emplace_back().triangles = std::move(ribbon);
    }
  }
}

void SeedFinder::add_patches(std::uint32_t seed, SeedSets& sets) {
  std::vector<std::uint32_t> patch;
  add_triangles(seed, patch);
  if (patch.size() > kPatch[0]) patch.resize(kPatch[0]);
  ++stamp_;
  for (const std::uint32_t t : patch) mark_[t] = stamp_;
  for (std::size_t next = 0; next < patch.size() && patch.size() < kPatch[0]; ++next)
    for (int k = 0; k < 3; ++k) {
      if (!grower_.smooth(patch[next], k)) continue;
      const std::uint32_t other = topology_.neighbor[patch[next]][k];
      if (mark_[other] == stamp_) continue;
      mark_[other] = stamp_;
      patch.push_back(other);
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
  std::vector<std::uint32_t> cross;
  add_triangles(seed, cross);
  for (const Crossing& way : crossings(seed)) add_triangles(way.facet, cross);
  if (cross.size() >= 4 && cross.size() <= kPatch[0])
    sets.patches.emplace_back().triangles = std::move(cross);
}

// Which ribbons and smaller patches lie within each patch.
void SeedFinder::tell_parts_of_patches(SeedSets& sets) {
  for (std::size_t i = 0; i < sets.patches.size(); ++i) {
    SeedSet& patch = sets.patches[i];
    ++stamp_;
    for (const std::uint32_t t : patch.triangles) mark_[t] = stamp_;
    const auto look = [&](const SeedSet& part, std::size_t bit) {
      if (part.triangles.size() < patch.triangles.size() &&
          std::all_of(part.triangles.begin(), part.triangles.end(),
                      [&](std::uint32_t t) { return mark_[t] == stamp_; }))
        patch.holds |= 1U << bit;
    };
    for (std::size_t k = 0; k < sets.ribbons.size(); ++k) look(sets.ribbons[k], k);
    for (std::size_t k = i + 1; k < sets.patches.size(); ++k)
      look(sets.patches[k], SeedSets::kPatchBit + k);
  }
}

SeedSets SeedFinder::about(std::uint32_t facet) {
  SeedSets sets;
  add_ribbons(facet, sets);
  add_patches(facet, sets);
  tell_parts_of_patches(sets);
  return sets;
}

}  // namespace mortise
