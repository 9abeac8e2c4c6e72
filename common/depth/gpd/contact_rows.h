#pragma once
#include <cstdint>
#include <vector>

#include "common/ccd/ccd_scratch.h"
#include "common/depth/gpd/minimax.h"
#include "common/geometry/signed_distance.h"

namespace mortise::gpd {

/// What the contact of two parts asks of a small change of the twist of A: linear rows around a
/// twist. World frame, mm.
class ContactRows {
 public:
  ContactRows(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
              const TwistFrame& frame, CcdScratch& scratch);

  /// No place within reach of the parts, A moved by exp(ξ), may close beyond margin_mm. Places are
  /// those of contact_places(); where too many triangles are near, corners of both parts. Adds to
  /// `work`, in about evaluations of the overlap search.
  std::vector<Row> at(const Vec6& xi, double reach_mm, double margin_mm, std::uint64_t& work);
  /// Does a corner of one part lie in the other, A moved by exp(ξ)? Looks at some, first at the
  /// deepest where the parts stand: a quick no to a motion that does not part them.
  bool meet_at_corners(const Vec6& xi, std::uint64_t& work);

 private:
  /// n · (motion of A at the point) >= margin - gap.
  struct Place {
    Vec3 point_W, normal_W;
    double gap_mm = 0.0;
  };
  /// False: these are not all.
  bool by_triangles(const Pose& X_WA, double reach_mm, std::vector<Place>& places,
                    std::uint64_t& work);
  std::vector<Place> by_corners(const Pose& X_WA, double reach_mm, std::uint64_t& work);
  /// A corner, in the frame of its part, and the triangle of the other part that was nearest last.
  struct Corner {
    Vec3 x;
    std::uint32_t near = Topology::kNone;
  };
  void see_corners(double reach_mm, std::uint64_t& work);
  /// How deep a corner of a part lies in the other one. near: of a corner beside it, or none.
  SurfacePoint corner_at(int part, Corner& corner, const Pose& X_WA,
                         std::uint32_t near = Topology::kNone) const;
  /// Some corners of one part, of those near the box of the other.
  std::vector<Corner> corners_near(int part, double reach_mm) const;

  const Solid* parts_[2];
  Pose X_W_[2];
  const TwistFrame& frame_;
  CcdScratch& scratch_;
  bool crowded_ = false;  ///< too many triangles are near
  double corners_reach_mm_ = -1.0;
  std::vector<Corner> corners_[2];
  std::vector<Corner> deepest_first_[2];
};

}  // namespace mortise::gpd
