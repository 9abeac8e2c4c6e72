#pragma once
#include <optional>
#include <string>
#include <vector>

#include "client/picture/chart.h"
#include "common/session/tick/step.h"
#include "common/session/world/world.h"

namespace mortise {

/// One judged region of a scene at its present poses.
struct RegionQuery {
  const World* world = nullptr;
  PartId a, b;
  const Verdict* verdict = nullptr;
};

using ChartLine = std::vector<Vec2>;

/// A stretch of one face along the cut: the least, the most and the modelled position of its real
/// surface (the declared or recognized surface, or else the mesh). Point by point.
struct DrawnZone {
  ChartLine least, most, modelled;
  bool has_surface = false;
};

/// One part near the deciding point, in the chart.
struct DrawnPart {
  std::string name, face;         ///< "plate", "bore"
  std::vector<ChartLine> fills;   ///< closed outlines of the mesh
  std::vector<ChartLine> meshes;  ///< lines of the mesh
  std::vector<DrawnZone> zones;
  std::optional<Interval> zone_at_point;  ///< h of the least and the most real surface, in order
};

/// The section through the deciding point, across a round face, enlarged. The cut's `up` points
/// away from the axis of the round face; without one along the normal of the region, upwards in the
/// world where possible. At the point one part is above, the other below.
struct DetailView {
  CutPlane plane;
  Chart chart;
  Vec2 point = Vec2::Zero();           ///< where the overlap is deepest, on the mesh of one part
  Interval overlap_h_mm;               ///< between which heights the meshes overlap there
  Interval s_mm, h_mm;                 ///< what the window shows
  DrawnPart parts[2];                  ///< A, B
  int upper = 0;                       ///< which of them lies above
  std::optional<Vec2> witness;         ///< inside both real parts
  bool witness_is_of_verdict = false;  ///< else it is one found in this section
  bool witness_is_declared = false;    ///< it holds however the parts are made
  Vec3 axis_W = Vec3::UnitZ();         ///< along the round face: what a second section may show
};

/// aspect: width over height of the window.
DetailView detail_view(const RegionQuery& query, double aspect);

}  // namespace mortise
