#include "common/generators/thread.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "common/generators/shape.h"

/// Bolt and nut with a real helical thread of the ISO 68 profile (60 degrees, crest P/8, root P/4),
/// right-handed, cut flat at both ends.
///
/// Heights are whole multiples of pitch / facets: with facets a multiple of 16 all four helical
/// lines of the profile pass through corners of the end faces, so every corner lies exactly on the
/// true surface and the mesh closes without a single cut triangle.
namespace mortise {
namespace {

/// Lines of one ridge from its middle, in sixteenths of the pitch: foot, crest, crest, foot.
constexpr std::array<int, 4> kLines = {-6, -1, 1, 6};
/// Height of the ridge over its pitch: 5/16 P along a flank of 30 degrees.
const double kRidge = 5.0 / 16.0 * std::sqrt(3.0);

struct Thread {
  int facets = 48, turns = 5;
  double pitch_mm = 2.0, root_mm = 7.0, crest_mm = 8.0;  ///< radii
  double z_start_mm = 0.0;
  bool inside = false;  ///< of a nut: the ridge is a groove

  int steps() const { return facets * turns; }
  /// Radius at column i and height q (in pitch / facets).
  double radius_mm(int i, int q) const {
    const int unit = facets / 16;
    int from_middle = ((q - i) % facets + facets) % facets;
    if (from_middle > facets / 2) from_middle -= facets;
    const int off = std::abs(from_middle);
    if (off <= unit) return crest_mm;
    if (off >= 6 * unit) return root_mm;
    return crest_mm + (root_mm - crest_mm) * (off - unit) / (5.0 * unit);
  }
};

class Threader {
 public:
  Threader(Shape& shape, const Thread& thread) : shape_(shape), thread_(thread) {}

  std::uint32_t corner(int i, int q) {
    const int column = (i % thread_.facets + thread_.facets) % thread_.facets;
    const double angle = 2.0 * std::numbers::pi * column / thread_.facets;
    const double r = thread_.radius_mm(column, q);
    return shape_.point({r * std::cos(angle), r * std::sin(angle),
                         thread_.z_start_mm + thread_.pitch_mm * q / thread_.facets});
  }

  Ring end(int q) {
    Ring ring;
    for (int i = 0; i < thread_.facets; ++i) ring.push_back(corner(i, q));
    return ring;
  }

  /// All cells between two neighbouring columns and two neighbouring lines, cut at both ends.
  void walls(int crest_face, int root_face) {
    const int unit = thread_.facets / 16;
    for (int i = 0; i < thread_.facets; ++i)
      for (int turn = -2; turn <= thread_.turns + 1; ++turn)
        for (std::size_t line = 0; line < kLines.size(); ++line) {
          const bool wraps = line + 1 == kLines.size();
          const int lower = turn * thread_.facets + i + kLines[line] * unit;
          const int upper = wraps ? (turn + 1) * thread_.facets + i + kLines[0] * unit
                                  : turn * thread_.facets + i + kLines[line + 1] * unit;
          const int face = line == 1 ? crest_face : wraps ? root_face : Shape::kNoFace;
          cell(i, lower, upper, face);
        }
  }

 private:
  void cell(int i, int lower, int upper, int face) {
    const auto cut = [&](int q) { return std::min(std::max(q, 0), thread_.steps()); };
    if (cut(lower) == cut(upper) && cut(lower + 1) == cut(upper + 1)) return;
    const std::uint32_t a = corner(i, cut(lower)), b = corner(i + 1, cut(lower + 1));
    const std::uint32_t c = corner(i + 1, cut(upper + 1)), d = corner(i, cut(upper));
    thread_.inside ? shape_.quad(d, c, b, a, face) : shape_.quad(a, b, c, d, face);
  }

  Shape& shape_;
  const Thread& thread_;
};

Loop hexagon(double across_flats_mm) {
  return circle({0, 0}, across_flats_mm / std::sqrt(3.0), 6, 0.0);
}

void add_hexagon(Shape& shape, double across_flats_mm, double z0, double z1) {
  const Ring lower = shape.ring(hexagon(across_flats_mm), z0);
  const Ring upper = shape.ring(hexagon(across_flats_mm), z1);
  for (std::size_t i = 0; i < lower.size(); ++i) {
    const double angle = std::numbers::pi / 6.0 + std::numbers::pi / 3.0 * static_cast<double>(i);
    const Vec3 outward(std::cos(angle), std::sin(angle), 0.0);
    const int face =
        shape.plane("flat" + std::to_string(i + 1), 0.5 * across_flats_mm * outward, outward);
    shape.facet(lower, upper, i, face);
  }
}

std::string objection(const Values& values, double widest_mm) {
  if (values.count("facets") % 16 != 0) return "facets must be a multiple of 16";
  if (2.0 * kRidge * values["pitch_mm"] >= values["diameter_mm"])
    return "the pitch is too coarse for the diameter";
  if (0.5 * values["across_flats_mm"] <= widest_mm)
    return "the hexagon is narrower than the thread";
  return {};
}

Result<GeneratedPart> make_bolt(const Values& values) {
  Thread thread;
  thread.facets = values.count("facets");
  thread.turns = values.count("turns");
  thread.pitch_mm = values["pitch_mm"];
  thread.crest_mm = 0.5 * values["diameter_mm"];
  thread.root_mm = thread.crest_mm - kRidge * thread.pitch_mm;
  thread.z_start_mm = values["shank_mm"];
  if (const std::string no = objection(values, thread.crest_mm); !no.empty())
    return impossible("bolt", no);
  Shape shape;
  const double head = values["head_height_mm"];
  const int crest = shape.cylinder("crest", {0, 0, 0}, thread.crest_mm, false);
  const int root = shape.cylinder("root", {0, 0, 0}, thread.root_mm, false);
  const int under = shape.plane("under_head", {0, 0, 0}, Vec3::UnitZ());
  const int top = shape.plane("head_top", {0, 0, -head}, -Vec3::UnitZ());
  const int tip =
      shape.plane("tip", {0, 0, thread.z_start_mm + thread.pitch_mm * thread.turns}, Vec3::UnitZ());
  Threader threader(shape, thread);
  threader.walls(crest, root);
  const Ring start = threader.end(0);
  shape.cap(threader.end(thread.steps()), {}, true, tip);

  // 1. The shank, as wide as the crest; its end is what the thread leaves of the circle.
  Ring neck = start;
  if (thread.z_start_mm > 0.0) {
    const Loop loop = circle({0, 0}, thread.crest_mm, thread.facets, 0.0);
    const int shank = shape.cylinder("shank", {0, 0, 0}, thread.crest_mm, false);
    neck = shape.ring(loop, 0.0);
    const Ring end = shape.ring(loop, thread.z_start_mm);
    shape.strip(neck, end, shank);
    shape.strip(end, start);
  }

  // 2. The head.
  add_hexagon(shape, values["across_flats_mm"], -head, 0.0);
  const Loop outline = hexagon(values["across_flats_mm"]);
  shape.cap(shape.ring(outline, 0.0), {neck}, true, under);
  shape.cap(shape.ring(outline, -head), {}, false, top);
  return std::move(shape).finish();
}

Result<GeneratedPart> make_nut(const Values& values) {
  Thread thread;
  thread.inside = true;
  thread.facets = values.count("facets");
  thread.turns = values.count("turns");
  thread.pitch_mm = values["pitch_mm"];
  thread.crest_mm = 0.5 * values["diameter_mm"] + values["clearance_mm"];
  thread.root_mm = thread.crest_mm - kRidge * thread.pitch_mm;
  if (const std::string no = objection(values, thread.crest_mm); !no.empty())
    return impossible("nut", no);
  Shape shape;
  const double height = thread.pitch_mm * thread.turns;
  const int major = shape.cylinder("major", {0, 0, 0}, thread.crest_mm, true);
  const int minor = shape.cylinder("minor", {0, 0, 0}, thread.root_mm, true);
  const int bottom = shape.plane("bottom", {0, 0, 0}, -Vec3::UnitZ());
  const int top = shape.plane("top", {0, 0, height}, Vec3::UnitZ());
  Threader threader(shape, thread);
  threader.walls(major, minor);
  add_hexagon(shape, values["across_flats_mm"], 0.0, height);
  const Loop outline = hexagon(values["across_flats_mm"]);
  shape.cap(shape.ring(outline, 0.0), {threader.end(0)}, false, bottom);
  shape.cap(shape.ring(outline, height), {threader.end(thread.steps())}, true, top);
  return std::move(shape).finish();
}

}  // namespace

std::vector<Family> thread_families() {
  const GeneratorInfo::Parameter facets = {"facets", "corners a turn, a multiple of 16", 48, 16,
                                           1024};
  return {{{"bolt",
            "hexagon bolt: head below z = 0, shank and right-hand thread above; faces shank, "
            "crest, root, under_head, head_top, tip, flat1..6",
            {length("diameter", "of the thread", 16.0),
             length("pitch", "of the thread", 2.0),
             {"turns", "of the thread", 10, 1, 200},
             length("shank", "length without thread", 10.0, 0.0),
             length("across_flats", "of the head", 24.0),
             length("head_height", "of the head", 10.0),
             facets}},
           make_bolt},
          {{"nut",
            "hexagon nut, z in [0, turns * pitch]; faces minor, major, top, bottom, flat1..6",
            {length("diameter", "of the thread", 16.0),
             length("pitch", "of the thread", 2.0),
             {"turns", "of the thread", 6, 1, 200},
             length("clearance", "by which the thread is larger, of the radius", 0.1, 0.0),
             length("across_flats", "outside", 24.0),
             facets}},
           make_nut}};
}

}  // namespace mortise
