#pragma once
#include "tests/bench/judgement_csg.h"
#include "tests/bench/scenes.h"

/// Random parts of the CSG oracle. Every mesh is closed and has its corners on the true faces.
namespace mortise::bench {

/// A round place of a part that another can be put into or onto: part frame, along z.
struct CsgPlace {
  double x_mm = 0.0, y_mm = 0.0;
  double radius_mm = 0.0;
  double z0_mm = 0.0, z1_mm = 0.0;  ///< from where to where it is open
};

struct CsgDrawn {
  CsgPart part;
  std::optional<CsgPlace> hole;
};

/// Plate, prism or wedge with bores, countersinks, blind holes or bosses; at most three. The first
/// hole is a bore of hole_mm, if that is more than zero.
CsgDrawn draw_plate(Dice& dice, double size_mm, double hole_mm);
/// Stepped shaft with chamfers, with or without a bore and a groove. Radius of its lowest section:
/// shaft_mm, if that is more than zero.
CsgDrawn draw_shaft(Dice& dice, double size_mm, double shaft_mm);
CsgDrawn draw_torus(Dice& dice, double size_mm);
CsgDrawn draw_ball(Dice& dice, double size_mm);

}  // namespace mortise::bench
