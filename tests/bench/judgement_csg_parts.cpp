#include "tests/bench/judgement_csg_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

using std::numbers::pi;
using Round = CsgMesher::Round;
using Ring = CsgMesher::Ring;

int draw_facets(Dice& dice) { return static_cast<int>(std::lround(dice.spread(12.0, 96.0))); }

CsgFace plane(const Vec3& n, double c) {
  CsgFace face;
  face.n = n;
  face.c = c;
  return face;
}

/// Material on the axis' side of the line from (r0, z0) to (r1, z1), z1 > z0; hollow: beyond it.
CsgFace round_face(const Round& at, double r0, double z0, double r1, double z1, bool hollow) {
  CsgFace face;
  face.kind = CsgFace::Kind::kMeridian;
  face.axis_x = at.x_mm;
  face.axis_y = at.y_mm;
  const double length = std::hypot(r1 - r0, z1 - z0), sign = hollow ? -1.0 : 1.0;
  face.across = sign * (z1 - z0) / length;
  face.up = r1 == r0 ? 0.0 : sign * (r0 - r1) / length;
  face.c = face.across * r0 + face.up * z0;
  return face;
}

CsgFace cylinder(const Round& at, double r, bool hollow) {
  return round_face(at, r, 0.0, r, 1.0, hollow);
}

/// A convex outline in the plane z = 0, counter-clockwise.
struct Outline {
  std::vector<Vec3> corners;
  Vec3 middle = Vec3::Zero();
  double room_mm = 0.0;  ///< radius of the circle about the middle that is inside
};

Outline with_room(std::vector<Vec3> corners, const Vec3& middle) {
  Outline outline{std::move(corners), middle, 1e300};
  for (std::size_t i = 0; i < outline.corners.size(); ++i) {
    const Vec3 a = outline.corners[i], b = outline.corners[(i + 1) % outline.corners.size()];
    outline.room_mm = std::min(outline.room_mm, (b - a).normalized().cross(middle - a).z());
  }
  return outline;
}

// A rectangle, a regular prism, or a wedge with an edge of 10 to 80 degrees; the middle is that of
// its largest circle.
Outline draw_outline(Dice& dice, double size) {
  const double kind = dice.between(0.0, 1.0);
  if (kind < 0.4) {
    const double x = size * dice.between(0.5, 1.0), y = size * dice.between(0.5, 1.0);
    return with_room({{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}}, Vec3::Zero());
  }
  if (kind < 0.7) {
    std::vector<Vec3> corners;
    const int count = 3 + static_cast<int>(dice.between(0.0, 5.999));
    for (int i = 0; i < count; ++i)
      corners.push_back(shapes::on_circle(size, 2.0 * pi * i / count, 0.0));
    return with_room(corners, Vec3::Zero());
  }
  const double half = 0.5 * dice.spread(10.0, 80.0) * pi / 180.0;
  const double y = 2.0 * size * std::tan(half);
  const double radius = y * 2.0 * size / (y + std::hypot(y, 2.0 * size));
  return with_room({{0, -y, 0}, {2.0 * size, 0, 0}, {0, y, 0}}, Vec3(radius, 0, 0));
}

/// One prism of a plate with what is bored into or stands on it.
struct Block {
  Outline outline;
  std::vector<std::uint32_t> top, bottom;  ///< corners of the mesh
};

/// Builds a plate: cells beside each other, from z = 0 to the height.
class Plate {
 public:
  Plate(CsgPart& part, double height_mm) : part_(part), mesher_(part), height_(height_mm) {}

  void outline(const std::vector<std::uint32_t>& top, const std::vector<std::uint32_t>& bottom);
  std::uint32_t point(const Vec3& xy, double z) { return mesher_.point({xy.x(), xy.y(), z}); }
  enum class What { kNothing, kBore, kCountersink, kBlind, kConeBore, kBoss, kDimple };
  void cell(Dice& dice, const Block& cell, What what, double radius_mm);
  void close();

  std::optional<CsgPlace> hole;

 private:
  using Alternatives = std::vector<std::uint32_t>;  ///< one of these faces is fulfilled
  void bore(const Round& at, double r, double top_r, double sunk, Ring first, const Block& cell);
  void blind(const Round& at, double r, double floor_z, Ring first);
  void boss(Dice& dice, const Round& at, double r, Ring first);
  void dimple(Dice& dice, const Round& at, double r, Ring first);

  CsgPart& part_;
  CsgMesher mesher_;
  double height_;
  std::vector<std::uint32_t> common_;  // faces of the prism, and holes through it
  std::vector<Alternatives> blind_;
  std::vector<std::vector<std::uint32_t>> bosses_;
  std::uint32_t top_ = 0, bottom_ = 0;
};

void Plate::outline(const std::vector<std::uint32_t>& top,
                    const std::vector<std::uint32_t>& bottom) {
  top_ = part_.add(plane(Vec3::UnitZ(), height_), "top");
  bottom_ = part_.add(plane(-Vec3::UnitZ(), 0.0), "bottom");
  common_ = {top_, bottom_};
  for (std::size_t i = 0; i < top.size(); ++i) {
    const std::size_t j = (i + 1) % top.size();
    const Vec3 a = part_.mesh.points_mm[bottom[i]], b = part_.mesh.points_mm[bottom[j]];
    const Vec3 n = (b - a).cross(Vec3::UnitZ()).normalized();
    // Sides in one plane are one face.
    std::uint32_t side = 0;
    for (const std::uint32_t f : common_)
      if (f > bottom_ && (part_.faces[f].n - n).norm() < 1e-9) side = f;
    if (side == 0) {
      side = part_.add(plane(n, n.dot(a)), "side");
      common_.push_back(side);
    }
    mesher_.triangle(bottom[i], bottom[j], top[j], side);
    mesher_.triangle(bottom[i], top[j], top[i], side);
  }
}

void Plate::bore(const Round& at, double r, double top_r, double sunk, Ring first,
                 const Block& cell) {
  std::vector<CsgMesher::Corner> corners;
  if (sunk > 0.0) {
    common_.push_back(
        part_.add(round_face(at, r, height_ - sunk, top_r, height_, true), "countersink"));
    corners.push_back({r, height_ - sunk, common_.back()});
  }
  if (sunk < height_) {
    common_.push_back(part_.add(cylinder(at, r, true), "bore"));
    corners.push_back({r, 0.0, common_.back()});
  } else {
    corners.back() = {r, 0.0, common_.back()};
  }
  const Ring last = mesher_.chain(at, std::move(first), corners);
  mesher_.cap(cell.bottom, at, &last, true, bottom_);
  if (!hole && sunk < height_) hole = CsgPlace{at.x_mm, at.y_mm, r, 0.0, height_};
}

void Plate::blind(const Round& at, double r, double floor_z, Ring first) {
  const std::uint32_t wall = part_.add(cylinder(at, r, true), "blind");
  const std::uint32_t floor = part_.add(plane(Vec3::UnitZ(), floor_z), "floor");
  mesher_.chain(at, std::move(first), {{r, floor_z, wall}, {0.0, floor_z, floor}});
  blind_.push_back({wall, floor});
  if (!hole) hole = CsgPlace{at.x_mm, at.y_mm, r, floor_z, height_};
}

void Plate::boss(Dice& dice, const Round& at, double r, Ring first) {
  const double z1 = height_ + r * dice.between(0.4, 2.0), chamfer = 0.3 * r;
  const std::uint32_t wall = part_.add(cylinder(at, r, false), "boss");
  const std::uint32_t end = part_.add(plane(Vec3::UnitZ(), z1), "end");
  CsgFace within = plane(-Vec3::UnitZ(), -0.5 * height_);
  within.cut = true;
  std::vector<std::uint32_t> faces = {wall, end, part_.add(within, "cut")};
  std::vector<CsgMesher::Corner> corners = {{r, z1, wall}, {0.0, z1, end}};
  if (dice.between(0.0, 1.0) < 0.6) {
    const double down = chamfer * dice.between(0.5, 1.0);
    faces.push_back(part_.add(round_face(at, r, z1 - down, r - chamfer, z1, false), "chamfer"));
    corners = {{r, z1 - down, wall}, {r - chamfer, z1, faces.back()}, {0.0, z1, end}};
  }
  mesher_.chain(at, std::move(first), corners);
  bosses_.push_back(faces);
}

// A bowl: the lower part of a ball.
void Plate::dimple(Dice& dice, const Round& at, double r, Ring first) {
  const double above = r * dice.between(0.1, 1.0);
  CsgFace ball;
  ball.kind = CsgFace::Kind::kBall;
  ball.axis_x = at.x_mm;
  ball.axis_y = at.y_mm;
  ball.z = height_ + above;
  ball.radius = std::hypot(r, above);
  ball.hollow = true;
  const std::uint32_t face = part_.add(ball, "bowl");
  const double half = std::atan2(r, above);
  const int rows = std::max(3, static_cast<int>(std::lround(at.facets * half / (2.0 * pi))));
  std::vector<CsgMesher::Corner> corners;
  for (int i = 1; i <= rows; ++i) {
    const double angle = half * (rows - i) / rows;
    corners.push_back({i == rows ? 0.0 : ball.radius * std::sin(angle),
                       ball.z - ball.radius * std::cos(angle), face});
  }
  mesher_.chain(at, std::move(first), corners);
  common_.push_back(face);
}

void Plate::cell(Dice& dice, const Block& cell, What what, double radius_mm) {
  Round at{cell.outline.middle.x(), cell.outline.middle.y(), draw_facets(dice),
           dice.between(0.0, 2.0 * pi)};
  const bool through = what == What::kBore || what == What::kCountersink || what == What::kConeBore;
  if (!through) mesher_.cap(cell.bottom, at, nullptr, true, bottom_);
  if (what == What::kNothing) {
    mesher_.cap(cell.top, at, nullptr, false, top_);
    return;
  }
  if (what == What::kDimple) radius_mm = std::min(radius_mm, 0.8 * height_);
  double first_r = radius_mm, sunk = 0.0;
  if (what == What::kCountersink || what == What::kConeBore) {
    first_r = std::min(0.9 * cell.outline.room_mm, radius_mm * dice.between(1.1, 1.5));
    sunk = what == What::kConeBore ? height_ : height_ * dice.between(0.2, 0.7);
  }
  Ring first = mesher_.ring(at, first_r, height_);
  mesher_.cap(cell.top, at, &first, false, top_);
  if (through) bore(at, radius_mm, first_r, sunk, std::move(first), cell);
  if (what == What::kBlind)
    blind(at, radius_mm, height_ * dice.between(0.25, 0.75), std::move(first));
  if (what == What::kBoss) boss(dice, at, radius_mm, std::move(first));
  if (what == What::kDimple) dimple(dice, at, radius_mm, std::move(first));
}

// One cell of the union for every choice of wall or floor of the blind holes, and each boss.
void Plate::close() {
  part_.cells = {common_};
  for (const Alternatives& one_of : blind_) {
    std::vector<std::vector<std::uint32_t>> more;
    for (const auto& faces : part_.cells)
      for (const std::uint32_t face : one_of) {
        more.push_back(faces);
        more.back().push_back(face);
      }
    part_.cells = more;
  }
  for (const auto& faces : bosses_) part_.cells.push_back(faces);
}

// Rectangles in a row: corners of both long sides.
std::vector<Block> row_of_cells(Dice& dice, Plate& plate, double size, double height, int count) {
  const double y = size * dice.between(0.3, 0.6);
  std::vector<double> xs = {0.0};
  for (int i = 0; i < count; ++i) xs.push_back(xs.back() + size * dice.between(0.6, 1.2));
  std::vector<std::array<std::uint32_t, 2>> low, high;  // at -y, +y; bottom, top
  for (const double x : xs) {
    low.push_back({plate.point({x, -y, 0}, 0.0), plate.point({x, -y, 0}, height)});
    high.push_back({plate.point({x, y, 0}, 0.0), plate.point({x, y, 0}, height)});
  }
  std::vector<std::uint32_t> border[2];
  for (std::size_t k = 0; k < 2; ++k) {
    for (const auto& at : low) border[k].push_back(at[k]);
    for (auto at = high.rbegin(); at != high.rend(); ++at) border[k].push_back((*at)[k]);
  }
  plate.outline(border[1], border[0]);
  std::vector<Block> cells;
  for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
    const Vec3 middle(0.5 * (xs[i] + xs[i + 1]), 0, 0);
    Block cell{
        with_room({{xs[i], -y, 0}, {xs[i + 1], -y, 0}, {xs[i + 1], y, 0}, {xs[i], y, 0}}, middle),
        {low[i][1], low[i + 1][1], high[i + 1][1], high[i][1]},
        {low[i][0], low[i + 1][0], high[i + 1][0], high[i][0]}};
    cells.push_back(cell);
  }
  return cells;
}

Plate::What draw_what(Dice& dice) {
  return static_cast<Plate::What>(static_cast<int>(dice.between(0.0, 6.999)));
}

}  // namespace

CsgDrawn draw_plate(Dice& dice, double size_mm, double hole_mm) {
  CsgDrawn drawn;
  drawn.part.size_mm = size_mm;
  const double height = size_mm * dice.between(0.2, 0.8);
  // A bore that is asked for needs its room.
  const double size = hole_mm > 0.0 ? std::max(size_mm, 4.0 * hole_mm) : size_mm;
  Plate plate(drawn.part, height);
  std::vector<Block> cells;
  if (dice.between(0.0, 1.0) < 0.5) {
    const int count = 1 + static_cast<int>(dice.between(0.0, 2.999));
    cells = row_of_cells(dice, plate, size, height, count);
  } else {
    Block cell{draw_outline(dice, size), {}, {}};
    if (hole_mm > 0.0 && cell.outline.room_mm < 1.3 * hole_mm) {
      const double more = 1.5 * hole_mm / cell.outline.room_mm;
      for (Vec3& p : cell.outline.corners) p *= more;
      cell.outline = with_room(cell.outline.corners, more * cell.outline.middle);
    }
    for (const Vec3& p : cell.outline.corners) {
      cell.bottom.push_back(plate.point(p, 0.0));
      cell.top.push_back(plate.point(p, height));
    }
    plate.outline(cell.top, cell.bottom);
    cells.push_back(cell);
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double room = cells[i].outline.room_mm;
    if (i == 0 && hole_mm > 0.0) {
      const double kind = dice.between(0.0, 1.0);
      plate.cell(dice, cells[i],
                 kind < 0.4   ? Plate::What::kBore
                 : kind < 0.7 ? Plate::What::kCountersink
                              : Plate::What::kBlind,
                 hole_mm);
    } else {
      plate.cell(dice, cells[i], draw_what(dice), room * dice.between(0.2, 0.6));
    }
  }
  plate.close();
  drawn.hole = plate.hole;
  drawn.part.text = "plate of " + std::to_string(cells.size());
  return drawn;
}

namespace {

/// Sections of a shaft from below, and what is cut from them.
struct ShaftPlan {
  struct Section {
    double r_mm, z0_mm, z1_mm;
  };
  std::vector<Section> sections;
  double chamfer_low_mm = 0.0, chamfer_high_mm = 0.0, slope_low = 1.0, slope_high = 1.0;
  double bore_mm = 0.0;
  int groove = -1;  ///< section with a torus cut into it
  double groove_z_mm = 0.0, groove_ring_mm = 0.0, groove_tube_mm = 0.0;
};

ShaftPlan draw_plan(Dice& dice, double size, double shaft_mm) {
  ShaftPlan plan;
  const int count = 1 + static_cast<int>(dice.between(0.0, 2.999));
  double z = 0.0, r = shaft_mm > 0.0 ? shaft_mm : size * dice.between(0.3, 0.6), least = r;
  for (int i = 0; i < count; ++i) {
    const double length = size * dice.between(0.4, 1.0);
    plan.sections.push_back({r, z, z + length});
    z += length;
    least = std::min(least, r);
    r *= dice.between(0.0, 1.0) < 0.5 ? dice.between(0.6, 0.9) : dice.between(1.15, 1.6);
  }
  const auto chamfer = [&](double of_r, double& slope) {
    slope = std::tan(dice.between(10.0, 80.0) * pi / 180.0);  // height over width
    if (dice.between(0.0, 1.0) < 0.4) return 0.0;
    return std::min(0.2 * of_r, 0.3 * 0.4 * size / slope) * dice.between(0.2, 1.0);
  };
  plan.chamfer_low_mm = chamfer(plan.sections.front().r_mm, plan.slope_low);
  plan.chamfer_high_mm = chamfer(plan.sections.back().r_mm, plan.slope_high);
  if (dice.between(0.0, 1.0) < 0.3) plan.bore_mm = least * dice.between(0.2, 0.5);
  if (dice.between(0.0, 1.0) < 0.3) {
    plan.groove = static_cast<int>(dice.between(0.0, count - 1e-9));
    const ShaftPlan::Section& s = plan.sections[static_cast<std::size_t>(plan.groove)];
    plan.groove_tube_mm = std::min(0.1 * s.r_mm, 0.1 * (s.z1_mm - s.z0_mm));
    plan.groove_ring_mm = s.r_mm + plan.groove_tube_mm * dice.between(-0.3, 0.5);
    plan.groove_z_mm = 0.5 * (s.z0_mm + s.z1_mm);
  }
  return plan;
}

/// Faces, cells and mesh of a shaft, by one walk up its outside.
class ShaftMaker {
 public:
  ShaftMaker(CsgPart& part, const ShaftPlan& plan, const Round& at)
      : part_(part), mesher_(part), plan_(plan), at_(at) {}

  void make() {
    const auto& sections = plan_.sections;
    if (plan_.bore_mm > 0.0)
      everywhere_.push_back(part_.add(cylinder(at_, plan_.bore_mm, true), "bore"));
    const std::uint32_t low = part_.add(plane(-Vec3::UnitZ(), 0.0), "low");
    std::vector<std::vector<std::uint32_t>> cells(sections.size());
    cells[0].push_back(low);
    const double first_r = sections[0].r_mm - plan_.chamfer_low_mm;
    first_ = mesher_.ring(at_, first_r, 0.0);
    if (plan_.chamfer_low_mm > 0.0) {
      const double top = plan_.chamfer_low_mm * plan_.slope_low;
      cells[0].push_back(
          part_.add(round_face(at_, first_r, 0.0, sections[0].r_mm, top, false), "chamfer"));
      corners_.push_back({sections[0].r_mm, top, cells[0].back()});
    }
    for (std::size_t i = 0; i < sections.size(); ++i) section(i, cells);
    finish(low);
    for (auto& faces : cells) {
      faces.insert(faces.end(), everywhere_.begin(), everywhere_.end());
      part_.cells.push_back(faces);
    }
  }

 private:
  void section(std::size_t i, std::vector<std::vector<std::uint32_t>>& cells) {
    const ShaftPlan::Section& s = plan_.sections[i];
    const bool last = i + 1 == plan_.sections.size();
    const std::uint32_t wall = part_.add(cylinder(at_, s.r_mm, false), "wall");
    cells[i].push_back(wall);
    if (plan_.groove == static_cast<int>(i)) groove(s, wall);
    const double chamfer = last ? plan_.chamfer_high_mm : 0.0;
    const double end_r = s.r_mm - chamfer;
    corners_.push_back({s.r_mm, s.z1_mm - chamfer * plan_.slope_high, wall});
    if (chamfer > 0.0) {
      cells[i].push_back(part_.add(
          round_face(at_, s.r_mm, s.z1_mm - chamfer * plan_.slope_high, end_r, s.z1_mm, false),
          "chamfer"));
      corners_.push_back({end_r, s.z1_mm, cells[i].back()});
    }
    // The thicker of two sections ends with a face; the thinner one goes on inside of it.
    const bool up = last || plan_.sections[i + 1].r_mm < s.r_mm;
    const std::uint32_t end =
        part_.add(plane(up ? Vec3(Vec3::UnitZ()) : Vec3(-Vec3::UnitZ()), up ? s.z1_mm : -s.z1_mm),
                  "shoulder");
    if (last) {
      cells[i].push_back(end);
      high_ = end;
      return;
    }
    const ShaftPlan::Section& next = plan_.sections[i + 1];
    corners_.push_back({next.r_mm, s.z1_mm, end});
    cells[up ? i : i + 1].push_back(end);
    const double inside = up ? 0.5 * (s.z0_mm + s.z1_mm) : 0.5 * (next.z0_mm + next.z1_mm);
    CsgFace cut = plane(up ? Vec3(-Vec3::UnitZ()) : Vec3(Vec3::UnitZ()), up ? -inside : inside);
    cut.cut = true;
    cells[up ? i + 1 : i].push_back(part_.add(cut, "cut"));
  }
  void groove(const ShaftPlan::Section& s, std::uint32_t wall) {
    CsgFace torus;
    torus.kind = CsgFace::Kind::kTorus;
    torus.ring = plan_.groove_ring_mm;
    torus.radius = plan_.groove_tube_mm;
    torus.z = plan_.groove_z_mm;
    torus.hollow = true;
    everywhere_.push_back(part_.add(torus, "groove"));
    const double out = s.r_mm - torus.ring;
    const double half = std::acos(-out / torus.radius);  // from the way to the axis, to the rim
    const int rows = std::max(4, static_cast<int>(std::lround(at_.facets * half / (2.0 * pi))));
    for (int j = 0; j <= 2 * rows; ++j) {
      const double angle = half * (j - rows) / rows;
      const bool rim = j == 0 || j == 2 * rows;
      corners_.push_back({rim ? s.r_mm : torus.ring - torus.radius * std::cos(angle),
                          torus.z + torus.radius * std::sin(angle),
                          j == 0 ? wall : everywhere_.back()});
    }
  }
  void finish(std::uint32_t low) {
    const double z1 = plan_.sections.back().z1_mm;
    if (plan_.bore_mm == 0.0) {
      corners_.push_back({0.0, z1, high_});
      mesher_.between({mesher_.point({0, 0, 0})}, first_, low);
      mesher_.chain(at_, first_, corners_);
      return;
    }
    corners_.push_back({plan_.bore_mm, z1, high_});
    corners_.push_back({plan_.bore_mm, 0.0, everywhere_.front()});
    const Ring last = mesher_.chain(at_, first_, corners_);
    mesher_.between(last, first_, low);
  }

  CsgPart& part_;
  CsgMesher mesher_;
  const ShaftPlan& plan_;
  Round at_;
  Ring first_;
  std::vector<CsgMesher::Corner> corners_;
  std::vector<std::uint32_t> everywhere_;  // bore and groove
  std::uint32_t high_ = 0;
};

}  // namespace

CsgDrawn draw_shaft(Dice& dice, double size_mm, double shaft_mm) {
  CsgDrawn drawn;
  drawn.part.size_mm = size_mm;
  const ShaftPlan plan = draw_plan(dice, size_mm, shaft_mm);
  ShaftMaker(drawn.part, plan, {0.0, 0.0, draw_facets(dice), dice.between(0.0, 2.0 * pi)}).make();
  if (plan.bore_mm > 0.0)
    drawn.hole = CsgPlace{0.0, 0.0, plan.bore_mm, 0.0, plan.sections.back().z1_mm};
  drawn.part.text = "shaft of " + std::to_string(plan.sections.size());
  if (plan.bore_mm > 0.0) drawn.part.text += ", bored";
  if (plan.groove >= 0) drawn.part.text += ", grooved";
  return drawn;
}

CsgDrawn draw_torus(Dice& dice, double size_mm) {
  CsgDrawn drawn;
  drawn.part.size_mm = size_mm;
  CsgFace torus;
  torus.kind = CsgFace::Kind::kTorus;
  torus.ring = size_mm * dice.between(0.5, 0.8);
  torus.radius = torus.ring * dice.between(0.1, 0.5);
  const std::uint32_t face = drawn.part.add(torus, "torus");
  drawn.part.cells = {{face}};
  CsgMesher mesher(drawn.part);
  const Round at{0.0, 0.0, draw_facets(dice), dice.between(0.0, 2.0 * pi)};
  const int rows = std::max(12, at.facets / 2);
  const double phase = dice.between(0.0, 2.0 * pi);
  std::vector<Ring> rings;
  for (int i = 0; i < rows; ++i) {
    const double angle = phase + 2.0 * pi * i / rows;
    rings.push_back(mesher.ring(at, torus.ring + torus.radius * std::cos(angle),
                                torus.radius * std::sin(angle)));
  }
  for (std::size_t i = 0; i < rings.size(); ++i)
    mesher.between(rings[i], rings[(i + 1) % rings.size()], face);
  drawn.hole = CsgPlace{0.0, 0.0, torus.ring - torus.radius, -torus.radius, torus.radius};
  drawn.part.text = "torus ring";
  return drawn;
}

CsgDrawn draw_ball(Dice& dice, double size_mm) {
  CsgDrawn drawn;
  drawn.part.size_mm = size_mm;
  CsgFace ball;
  ball.kind = CsgFace::Kind::kBall;
  ball.radius = size_mm * dice.between(0.3, 0.6);
  const std::uint32_t face = drawn.part.add(ball, "ball");
  drawn.part.cells = {{face}};
  CsgMesher mesher(drawn.part);
  const Round at{0.0, 0.0, draw_facets(dice), dice.between(0.0, 2.0 * pi)};
  const int rows = std::max(6, at.facets / 2);
  std::vector<CsgMesher::Corner> corners;
  for (int i = 1; i <= rows; ++i) {
    const double angle = pi * i / rows;
    corners.push_back(
        {i == rows ? 0.0 : ball.radius * std::sin(angle), -ball.radius * std::cos(angle), face});
  }
  mesher.chain(at, mesher.ring(at, 0.0, -ball.radius), corners);
  drawn.part.text = "ball";
  return drawn;
}

}  // namespace mortise::bench
