#pragma once
#include <optional>
#include <vector>

#include "common/depth/cells/decide.h"
#include "common/depth/pair_frame.h"
#include "common/depth/search/search.h"

namespace mortise {

/// What the sharp offset bodies say of a pair whose faces near each other are plane.
class PlanePair {
 public:
  /// Costs nothing where a part has no plane faces, and little where others are near the overlap.
  explicit PlanePair(const PairFrame& pair);

  /// Whether the least bodies interfere, and whether the largest do, is known.
  bool decided() const { return decided_; }
  /// Both layers are known as brackets: no search is needed for them.
  bool has_brackets() const {
    return decided_ && bracket_mm(Layer::kLower) && bracket_mm(Layer::kUpper);
  }
  /// The bracket of a layer in place of that of a search, with the samples of one on the meshes.
  Bracket told(const Bracket& mesh, Layer layer) const;

  /// Where both signs are known, sets certain, possible and the witness of the regions. That in
  /// which the deepest common point lies has its bracket; the others are no deeper. Adds a region
  /// where only edges or corners meet, and none was found.
  void tell(bool only_certain, std::vector<OverlapRegion>& regions) const;

 private:
  void look(double depth_mm, const SharpDecision* known = nullptr);
  bool certain() const { return decision_.least.margin_mm.lo > pair_.touch_mm; }
  bool possible() const { return decision_.largest.margin_mm.lo > pair_.touch_mm; }
  /// Of the overlap, or of minus the gap; nullopt: deeper than was looked.
  std::optional<Interval> bracket_mm(Layer layer) const;
  OverlapRegion region() const;
  const SharpDepth& depth_of(Layer layer) const {
    return layer == Layer::kLower ? decision_.least : decision_.largest;
  }
  double upper_mm(Layer layer) const;
  double gap_mm() const;
  OverlapRegion& nearest(std::vector<OverlapRegion>& regions, const Vec3& x_W) const;
  void tell_least(OverlapRegion& region) const;
  void tell_largest(OverlapRegion& region) const;
  void name_faces(const SharpDepth& depth, OverlapRegion& region) const;

  const PairFrame& pair_;
  SharpDecision decision_;
  double depth_mm_ = 0.0;
  bool decided_ = false;  // whether the least bodies interfere, and whether the largest do
};

/// True: the meshes, without any offset, overlap by no more than touch and what their corners are
/// off their planes, and all faces near both are plane. False: they do, or that is not known.
bool meshes_do_not_overlap(const PairFrame& pair);

/// True: x is not in both least bodies, for faces around it that are all plane. False: it is, or
/// that is not known.
bool is_outside_of_least_bodies(const PairFrame& pair, const Vec3& x_W);

}  // namespace mortise
