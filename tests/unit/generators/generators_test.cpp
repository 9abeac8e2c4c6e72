#include "common/generators/generators.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/generators/triangulate.h"
#include "common/geometry/topology.h"
#include "tests/support/numbers.h"

namespace mortise {
namespace {

GeneratedPart made(const std::string& kind, const std::map<std::string, double>& parameters = {}) {
  auto part = generate(kind, parameters);
  EXPECT_TRUE(part) << part.error().text;
  return part ? *part : GeneratedPart{};
}

/// Area of a regular n-gon on a circle: what a disc of radius r becomes.
double polygon(double r, int n) { return 0.5 * n * r * r * std::sin(2.0 * kPi / n); }

const Feature& face(const GeneratedPart& part, const std::string& name) {
  for (const Feature& feature : part.features)
    if (feature.name == name) return feature;
  ADD_FAILURE() << "no face " << name;
  static const Feature none;
  return none;
}

double area(const GeneratedPart& part, const Feature& feature) {
  double sum = 0.0;
  for (const std::uint32_t t : feature.triangles)
    sum += 0.5 * (part.mesh.corner(t, 1) - part.mesh.corner(t, 0))
                     .cross(part.mesh.corner(t, 2) - part.mesh.corner(t, 0))
                     .norm();
  return sum;
}

void expect_sound(const GeneratedPart& part, const std::string& what) {
  const Topology topology = build_topology(part.mesh);
  EXPECT_TRUE(topology.closed()) << what << ": " << topology.boundary_edges << " open, "
                                 << topology.non_manifold_edges << " non-manifold, "
                                 << topology.misoriented_edges << " misoriented, volume "
                                 << topology.volume_mm3;
  EXPECT_EQ(topology.components, 1U) << what;
  std::set<std::uint32_t> seen;
  std::set<std::string> names;
  for (const Feature& feature : part.features) {
    EXPECT_TRUE(names.insert(feature.name).second) << what << ": " << feature.name << " twice";
    EXPECT_FALSE(feature.triangles.empty()) << what << ": " << feature.name << " has no triangles";
    EXPECT_NEAR(feature.surface.axis.norm(), 1.0, 1e-15) << what;
    const double size = std::max(feature.surface.radius_mm, bounding_sphere(part.mesh).radius_mm);
    for (const std::uint32_t t : feature.triangles) {
      EXPECT_TRUE(seen.insert(t).second) << what << ": a triangle of two faces";
      const Vec3 &a = part.mesh.corner(t, 0), &b = part.mesh.corner(t, 1),
                 &c = part.mesh.corner(t, 2);
      for (const Vec3& x : {a, b, c})
        EXPECT_LE(std::abs(feature.surface.signed_distance_mm(x)), 1e-12 * size)
            << what << ": " << feature.name;
      const Vec3 normal = (b - a).cross(c - a).normalized();
      EXPECT_GT(normal.dot(feature.surface.outward_normal((a + b + c) / 3.0)), 0.49)
          << what << ": " << feature.name << " is inside out";
    }
  }
}

TEST(Generators, EveryKindIsASolidByDefault) {
  for (const GeneratorInfo& info : generators()) expect_sound(made(info.name), info.name);
}

TEST(Generators, EveryKindIsASolidAtOtherFacetsAndPhases) {
  for (const GeneratorInfo& info : generators()) {
    const auto has = [&](const std::string& name) {
      return std::any_of(info.parameters.begin(), info.parameters.end(),
                         [&](const auto& p) { return p.name == name; });
    };
    for (const int facets : {16, 48, 96})
      for (const double phase : {0.0, 0.1, kPi / 24.0, -2.0}) {
        std::map<std::string, double> parameters;
        if (has("facets")) parameters["facets"] = facets;
        if (has("phase_rad")) parameters["phase_rad"] = phase;
        if (has("bore_phase_rad")) parameters["bore_phase_rad"] = phase;
        expect_sound(made(info.name, parameters),
                     info.name + " " + std::to_string(facets) + " " + std::to_string(phase));
      }
  }
}

TEST(Generators, SameParametersSameMesh) {
  for (const GeneratorInfo& info : generators())
    EXPECT_EQ(mesh_hash(made(info.name).mesh), mesh_hash(made(info.name).mesh)) << info.name;
  EXPECT_EQ(mesh_hash(made("block").mesh), mesh_hash(made("block", {{"x_mm", 20.0}}).mesh));
  EXPECT_NE(mesh_hash(made("block").mesh), mesh_hash(made("block", {{"x_mm", 20.5}}).mesh));
}

TEST(Generators, VolumesAreThoseOfTheFormula) {
  for (const int n : {8, 24, 32, 200}) {
    const double facets = n;
    const auto near = [&](const GeneratedPart& part, double volume) {
      EXPECT_NEAR(signed_volume_mm3(part.mesh), volume, 1e-9 * volume);
    };
    near(made("ring", {{"facets", facets}}), 11.0 * (polygon(17.5, n) - polygon(7.5, n)));
    near(made("plate_with_bore", {{"facets", facets}}), 15.0 * (60 * 40 - polygon(10.0, n)));
    near(made("dowel_plate", {{"facets", facets}}), 15.0 * (60 * 40 - 2 * polygon(3.0, n)));
    near(made("shaft", {{"facets", facets}, {"d2_mm", 30.0}, {"l2_mm", 5.0}, {"d3_mm", 10.0}}),
         60.0 * polygon(10.0, n) + 5.0 * polygon(15.0, n) + 20.0 * polygon(5.0, n));
    const double frustum = 0.5 / 3.0 * (polygon(1.0, n)) * (9.0 + 7.5 + 6.25);
    near(made("dowel", {{"facets", facets}}), 19.0 * polygon(3.0, n) + 2.0 * frustum);
    near(made("housing", {{"facets", facets}}),
         41.0 * 160 * 120 - 30.0 * 132 * 92 - 11.0 * 2 * polygon(17.5, n) -
             18.0 * (4 * polygon(3.3, n) + 2 * polygon(3.0, n)));
    near(made("cover", {{"facets", facets}}),
         11.0 * (160 * 120 - 2 * polygon(17.5, n) - 4 * polygon(3.3, n) - 2 * polygon(3.0, n)));
  }
  EXPECT_NEAR(signed_volume_mm3(made("block").mesh), 8000.0, 1e-9);
  EXPECT_NEAR(signed_volume_mm3(made("slot_block").mesh), 30.0 * (40 * 20 - 12 * 10), 1e-9);
  EXPECT_NEAR(signed_volume_mm3(made("key").mesh), 6.0 * 6.0 * 14.0, 1e-9);
}

TEST(Generators, RoundVolumeIsReachedWithinTheChordError) {
  for (const int n : {16, 64, 256}) {
    const double sagitta = 10.0 * (1.0 - std::cos(kPi / n));
    const double exact = kPi * 100.0 * 60.0;
    const double got = signed_volume_mm3(made("shaft", {{"facets", double(n)}}).mesh);
    EXPECT_LT(got, exact);
    EXPECT_GT(got, exact - 2.0 * kPi * 10.0 * 60.0 * sagitta);
  }
}

TEST(Generators, AreasOfFacesAreWhole) {
  const GeneratedPart shaft =
      made("shaft", {{"key_section", 1.0}, {"chamfer_mm", 1.0}, {"facets", 64.0}});
  expect_sound(shaft, "keyed shaft");
  EXPECT_NEAR(area(shaft, face(shaft, "key_floor")), 14.0 * 6.0, 1e-9);
  const double wall = std::sqrt(100.0 - 9.0) - 6.5;
  EXPECT_NEAR(area(shaft, face(shaft, "key_left")), 14.0 * wall, 1e-9);
  EXPECT_NEAR(area(shaft, face(shaft, "key_right")), 14.0 * wall, 1e-9);
  EXPECT_EQ(face(shaft, "chamfer_upper").triangles.size(), 2U * 66U);
  const GeneratedPart housing = made("housing");
  EXPECT_EQ(face(housing, "seat_in").triangles.size(), 64U);
  EXPECT_NEAR(area(housing, face(housing, "cavity_left")), 30.0 * 92.0, 1e-9);
}

TEST(Generators, KeyedShaftsAndGearsOfManySizes) {
  for (const double width : {2.0, 5.9, 6.0, 9.0})
    for (const int n : {12, 24, 33, 48})
      for (const double phase : {0.0, 0.05, 0.3}) {
        const std::string what = std::to_string(width) + " " + std::to_string(n);
        expect_sound(made("shaft", {{"key_section", 2.0},
                                    {"d2_mm", 30.0},
                                    {"d3_mm", 18.0},
                                    {"key_width_mm", width},
                                    {"key_depth_mm", 4.0},
                                    {"facets", double(n)},
                                    {"phase_rad", phase}}),
                     "shaft " + what);
        expect_sound(made("gear", {{"key_width_mm", width},
                                   {"facets", double(n)},
                                   {"bore_phase_rad", phase},
                                   {"teeth", 17.0 + n}}),
                     "gear " + what);
      }
}

TEST(Generators, GearTeethLieOnTheInvolute) {
  const double base = 20.0 * std::cos(kPi / 9.0);
  const GeneratedPart gear = made("gear");
  int on_flank = 0;
  for (const Vec3& p : gear.mesh.points_mm) {
    const double r = p.head<2>().norm();
    if (r <= base * (1.0 + 1e-12) || r > 22.0 + 1e-9) continue;
    // Middle of tooth 0 is +x; the flank angle falls by inv(alpha) from its value on the pitch
    // circle, a quarter of the pitch less a quarter of the backlash each side.
    const double pitch = 2.0 * kPi / 20.0;
    const double angle = std::abs(std::remainder(std::atan2(p.y(), p.x()), pitch));
    const auto inv = [](double a) { return std::tan(a) - a; };
    const double flank =
        pitch / 4.0 - 0.25 * 0.2 / 20.0 + inv(kPi / 9.0) - inv(std::acos(base / r));
    if (angle < 1e-9) continue;  // middle of the tip
    EXPECT_NEAR(angle, flank, 1e-12);
    ++on_flank;
  }
  EXPECT_EQ(on_flank, 2 * 20 * 2 * 7);  // both ends, all teeth, both flanks, above the base circle
}

TEST(Generators, MeshingGearsDoNotTouch) {
  // Sections only: no corner of one lies inside the other's tooth. Distance 60, m 2, 20 and 40.
  const GeneratedPart a = made("gear"),
                      b = made("gear", {{"teeth", 40.0}, {"phase_rad", kPi / 40}});
  double nearest = 1e9;
  for (const Vec3& p : a.mesh.points_mm)
    for (const Vec3& q : b.mesh.points_mm)
      nearest = std::min(nearest, (p.head<2>() - (q.head<2>() + Vec2(60.0, 0.0))).norm());
  EXPECT_GT(nearest, 0.05);
}

TEST(Generators, ThreadIsRightHandedAndOnItsCylinders) {
  const GeneratedPart bolt = made("bolt"), nut = made("nut");
  EXPECT_NEAR(face(bolt, "crest").surface.radius_mm, 8.0, 0.0);
  EXPECT_NEAR(face(bolt, "root").surface.radius_mm, 8.0 - 2.0 * 0.541265877, 1e-8);
  EXPECT_NEAR(face(nut, "minor").surface.radius_mm, 8.1 - 2.0 * 0.541265877, 1e-8);
  // The middle of the crest climbs with the angle: at 90 degrees a quarter of the pitch.
  double at_0 = 0.0, at_90 = 0.0;
  int n_0 = 0, n_90 = 0;
  for (const std::uint32_t t : face(bolt, "crest").triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec3& p = bolt.mesh.corner(t, k);
      if (p.z() < 15.5 || p.z() > 17.4) continue;
      if (p.x() > 7.999) at_0 += p.z(), ++n_0;
      if (p.y() > 7.999) at_90 += p.z(), ++n_90;
    }
  ASSERT_GT(n_0, 0);
  ASSERT_GT(n_90, 0);
  EXPECT_NEAR(at_90 / n_90 - at_0 / n_0, 0.5, 0.1);
  // Volume of the thread: P turns of (core + ridge), ridge by Pappus with the exact profile.
  const double ridge = 2.0 * 0.541265877;
  const double rf = 8.0 - ridge;
  const double mean2 =
      (0.25 * rf * rf + 0.125 * 64.0 + 2.0 * 0.3125 * (rf * rf + rf * 8.0 + 64.0) / 3.0);
  const double hexagon = 24.0 * 24.0 * std::sqrt(3.0) / 2.0;
  const double exact = hexagon * 10.0 + kPi * 64.0 * 10.0 + kPi * mean2 * 20.0;
  EXPECT_NEAR(signed_volume_mm3(made("bolt", {{"facets", 192.0}}).mesh), exact, 2e-3 * exact);
}

TEST(Generators, WrongWordsAndNumbersAreErrors) {
  const auto says = [](const std::string& kind, const std::map<std::string, double>& parameters,
                       const std::string& words) {
    const auto part = generate(kind, parameters);
    ASSERT_FALSE(part) << kind;
    EXPECT_NE(part.error().text.find(words), std::string::npos) << part.error().text;
    EXPECT_EQ(part.error().text.find('\n'), std::string::npos);
  };
  says("shafts", {}, "known are bearing, block");
  says("block", {{"x", 3.0}}, "known are x_mm, y_mm, z_mm");
  says("ring", {{"facets", 7.5}}, "whole number");
  says("bolt", {{"facets", 50.0}}, "multiple of 16");
  says("ring", {{"bore_mm", 36.0}}, "reaches through");
  says("shaft", {{"d3_mm", 10.0}}, "without a diameter");
  says("shaft", {{"d1_mm", 0.0}}, "no section");
  says("shaft", {{"d2_mm", 20.0}}, "the same diameter");
  says("shaft", {{"key_section", 1.0}, {"key_length_mm", 70.0}}, "inside its section");
  says("shaft", {{"key_section", 4.0}}, "does not exist");
  says("shaft", {{"key_section", 1.0}, {"key_depth_mm", 0.1}}, "shallow");
  says("dowel", {{"chamfer_mm", 3.5}}, "chamfer");
  says("plate_with_bore", {{"bore_mm", 45.0}}, "beyond the plate");
  says("dowel_plate", {{"pitch_mm", 5.0}}, "meet");
  says("slot_block", {{"slot_width_mm", 50.0}}, "wider");
  says("housing", {{"distance_mm", 30.0}}, "seats meet");
  says("cover", {{"length_mm", 100.0}}, "wall");
  says("gear", {{"bore_mm", 36.0}}, "root of the teeth");
  says("gear", {{"backlash_mm", 6.0}}, "point");
  says("nut", {{"across_flats_mm", 15.0}}, "narrower");
  says("screw", {{"head_diameter_mm", 5.0}}, "wider than the shank");
  for (const GeneratorInfo& info : generators())
    for (const auto& parameter : info.parameters) {
      says(info.name, {{parameter.name, parameter.least - 1.0}}, "out of range");
      says(info.name, {{parameter.name, parameter.most + 1.0}}, "out of range");
      says(info.name, {{parameter.name, std::nan("")}}, "out of range");
      EXPECT_GE(parameter.fallback, parameter.least) << info.name << " " << parameter.name;
      EXPECT_LE(parameter.fallback, parameter.most) << info.name << " " << parameter.name;
    }
}

TEST(Triangulate, ManyHolesAndHardOutlines) {
  const auto circle = [](double x, double y, double r, int n, bool turned) {
    Loop loop;
    for (int i = 0; i < n; ++i) {
      const double a = (turned ? -1.0 : 1.0) * 2.0 * kPi * i / n;
      loop.push_back({x + r * std::cos(a), y + r * std::sin(a)});
    }
    return loop;
  };
  std::vector<Loop> holes;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) holes.push_back(circle(10.0 * i, 10.0 * j, 4.9, 16, true));
  const auto plate = triangulate({{-6, -6}, {46, -6}, {46, 46}, {-6, 46}}, holes);
  ASSERT_TRUE(plate) << plate.error().text;
  EXPECT_EQ(plate->size(), 4U + 25U * 16U + 2U * 25U - 2U);
  // A comb, and a star.
  Loop comb = {{0, -1}, {20, -1}, {20, 0}};
  for (int i = 19; i >= 0; --i) comb.push_back({i + 0.5, i % 2 == 0 ? 5.0 : 0.0});
  comb.push_back({0, 0});
  EXPECT_TRUE(triangulate(comb, {}));
  // Planted faults: an outline that crosses itself, a hole that leaves its plate.
  EXPECT_FALSE(triangulate({{0, 0}, {4, 4}, {4, 0}, {0, 3}}, {}));
  EXPECT_FALSE(triangulate({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {circle(4, 2, 1, 8, true)}));
  EXPECT_FALSE(triangulate({{0, 0}, {1, 1}}, {}));
}

}  // namespace
}  // namespace mortise
