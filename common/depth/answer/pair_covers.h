#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "common/depth/cells/cover_pair.h"
#include "common/depth/depth.h"
#include "common/depth/search/search.h"

namespace mortise {

/// What the covers of both parts say of their overlap at one pose (README, section 11). Each answer
/// is found when it is asked for first; a few microseconds for parts that are apart or slide.
class PairCovers {
 public:
  /// use: false: as if a part had none. Adds what is spent to `evaluations`.
  PairCovers(const PairFrame& pair, bool use, std::uint64_t& evaluations);

  /// No overlap of kLower or kUpper is deeper. Infinity: nothing is known.
  double most_mm(Layer layer);
  /// No point is in both parts of the layer deeper than touching.
  bool apart(Layer layer);
  /// A point of one surface about where the other part is deepest, asked as any point is; nullopt:
  /// the covers name none that is deeper than touching.
  std::optional<Sample> deepest(Layer layer);
  /// deepest() asked a point that is in both parts, or outside by no more than 0.4 um.
  bool touches(Layer layer) const;
  /// The same by a point of the mesh beside the end of its cell: what holds a part there has a face
  /// of its own, along which the part slides.
  std::optional<Sample> on_mesh(Layer layer);
  /// Where deepest() found no place, but such that touch: from there farther into the other part.
  /// Not the place that holds it.
  std::optional<Sample> farther_in(Layer layer);
  /// The bracket of a layer of a pair with one region, where a point of it is known that is about
  /// as deep as any can be: but for accuracy_mm, or a share of it where the sign is enough.
  std::optional<Bracket> bracket(Layer layer, double accuracy_mm, bool sign_only);
  /// The deepest region, where no search is needed for what the query asks of certain and possible;
  /// nothing of the meshes.
  std::optional<OverlapRegion> region(const OverlapQuery& query);
  /// Gives a witness to the nearest region where none has one, and caps certain and possible. A
  /// witness of parts whose least covers are apart is refused and counted: one of both is wrong.
  void tell(std::vector<OverlapRegion>& regions);

 private:
  bool is_closed(const Interval& bracket, const OverlapQuery& query) const;
  std::optional<OverlapRegion> certain_region();
  std::optional<OverlapRegion> possible_region();
  void give_witness(std::vector<OverlapRegion>& regions);
  /// is_closed: the bracket is that of a closed form, which no bound of cells makes closer.
  void cap(Interval& bracket, Layer layer, bool is_closed);
  const CoverOverlap& overlap_of(Layer layer);
  CoverPair cells_of(Layer layer) const;

  const PairFrame& pair_;
  bool found_;
  std::uint64_t& evaluations_;
  std::optional<bool> apart_[2];            // least, largest
  std::optional<CoverOverlap> overlap_[2];  // the same
  std::optional<double> most_mm_[2];
  std::optional<Sample> deepest_[2];
  std::vector<Sample> touching_[2];
};

}  // namespace mortise
