#include "common/depth/body_index.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "common/base/check.h"

namespace mortise {
namespace {

// Parts with their bands of which an index is held; the one that was not asked for longest goes.
// A large assembly has some hundreds of kinds: one that is not held is made anew in each tick.
constexpr std::size_t kMostHeld = 1024;

bool same_surface(const Surface& a, const Surface& b) {
  return a.kind == b.kind && a.inward == b.inward && a.point == b.point && a.axis == b.axis &&
         a.radius_mm == b.radius_mm && a.tube_radius_mm == b.tube_radius_mm &&
         a.half_angle_rad == b.half_angle_rad;
}

bool same(const Interval& a, const Interval& b) { return a.lo == b.lo && a.hi == b.hi; }

// Names and sources of a face say nothing of where its surface lies.
bool same_face(const SurfaceBand::Face& a, const SurfaceBand::Face& b) {
  if (a.surface.has_value() != b.surface.has_value()) return false;
  if (a.surface && !same_surface(*a.surface, *b.surface)) return false;
  return a.residual_mm == b.residual_mm && a.grade == b.grade && same(a.unsure_mm, b.unsure_mm) &&
         same(a.deviation_mm, b.deviation_mm) && same(a.tolerance_mm, b.tolerance_mm);
}

// Solids and bands come and go, and new ones may stand where old ones did: what an index was made
// of is compared, not where it was.
struct Shelf {
  struct Held {
    const Solid* solid = nullptr;
    std::string hash;  // of the mesh
    std::vector<SurfaceBand::Face> faces;
    FaceOfTriangle face_of_triangle;
    std::shared_ptr<BodyIndex> index;
    std::uint64_t asked = 0;

    bool is_of(const Solid& s, const SurfaceBand& band) const {
      return solid == &s && hash == s.hash() &&
             std::equal(faces.begin(), faces.end(), band.faces.begin(), band.faces.end(),
                        same_face) &&
             face_of_triangle == band.face_of_triangle;
    }
  };
  std::vector<Held> held;
  std::uint64_t asked = 0;
  bool lays_out = false;  ///< it makes for others, and takes nothing that is laid out
};

// One shelf a thread: nothing is shared, and no answer depends on what it holds.
thread_local Shelf shelf;

// What one thread has made for another.
struct LaidOut {
  std::mutex mutex;
  std::vector<Shelf::Held> indices;
};

// Never destroyed: a thread may still lay out while the program ends.
LaidOut& laid_out() {
  static auto* const all = new LaidOut;
  return *all;
}

std::shared_ptr<BodyIndex> take_laid_out(const Solid& solid, const SurfaceBand& band) {
  if (shelf.lays_out) return nullptr;
  LaidOut& all = laid_out();
  const std::lock_guard lock(all.mutex);
  for (auto it = all.indices.begin(); it != all.indices.end(); ++it) {
    if (!it->is_of(solid, band)) continue;
    std::shared_ptr<BodyIndex> index = std::move(it->index);
    all.indices.erase(it);
    return index;
  }
  return nullptr;
}

}  // namespace

void lay_out_index(const Solid& solid, const SurfaceBand& band) {
  shelf.lays_out = true;
  const auto mine = std::ranges::find_if(
      shelf.held, [&](const Shelf::Held& held) { return held.is_of(solid, band); });
  if (mine == shelf.held.end()) return;
  LaidOut& all = laid_out();
  const std::lock_guard lock(all.mutex);
  if (all.indices.size() >= kMostHeld) all.indices.erase(all.indices.begin());
  all.indices.push_back(std::move(*mine));
  shelf.held.erase(mine);
}

std::shared_ptr<BodyIndex> body_index(const Solid& solid, const SurfaceBand& band) {
  ++shelf.asked;
  for (Shelf::Held& held : shelf.held)
    if (held.is_of(solid, band)) {
      held.asked = shelf.asked;
      return held.index;
    }
  if (shelf.held.size() >= kMostHeld)
    shelf.held.erase(std::min_element(
        shelf.held.begin(), shelf.held.end(),
        [](const Shelf::Held& a, const Shelf::Held& b) { return a.asked < b.asked; }));
  std::shared_ptr<BodyIndex> index = take_laid_out(solid, band);
  if (!index) {
    // Who laid one out has looked: each triangle is asked.
    MORTISE_CHECK(valid(band, solid.mesh().triangles.size()),
                  "a band has a face for every triangle of its part");
    index = std::make_shared<BodyIndex>();
  }
  shelf.held.push_back(
      {&solid, solid.hash(), band.faces, band.face_of_triangle, std::move(index), shelf.asked});
  return shelf.held.back().index;
}

}  // namespace mortise
