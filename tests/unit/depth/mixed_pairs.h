#pragma once
#include <cmath>
#include <vector>

#include "common/geometry/recognition/recognition.h"
#include "tests/unit/depth/drawn_pairs.h"
#include "tests/unit/depth/overlap_case.h"
#include "tests/unit/depth/profile_parts.h"
#include "tests/unit/depth/random_polyhedra.h"

/// Random pairs of all kinds and grades, about where they touch.
namespace mortise::mixed {

using namespace cover_parts;

inline constexpr const char* kGrades[] = {"declared", "exact", "recognized", "estimated",
                                          "chord",    "plain", "nominal"};
inline constexpr int kGradesOf = 7;

/// The band of a part under a grade of knowledge; `declared` is that of its drawing.
inline SurfaceBand band_of(Random& random, int grade, const SolidPtr& solid,
                           const SurfaceBand& declared) {
  if (grade == 0) return declared;
  BandInput input;
  input.solid = solid.get();
  std::vector<Feature> features;
  const double t_mm = below(random, 2) * uniform(random, 0.0, 0.02);
  switch (grade) {
    case 1: {  // the surfaces of the drawing, without tolerances
      SurfaceBand band = declared;
      for (SurfaceBand::Face& face : band.faces) face.tolerance_mm = {};
      const FaceStatement none;
      std::int32_t last = -1;
      for (const SurfaceBand::Face& face : band.faces) last = std::max(last, face.feature);
      const std::vector<FaceStatement> of_feature(static_cast<std::size_t>(last + 1));
      return with_statements(band, *solid, none, of_feature);
    }
    case 2:
      features = recognize_features(*solid).features;
      input.features = features;
      input.of_feature.resize(features.size());
      input.estimate = true;
      input.quantum_mm = below(random, 2) * 2e-6;
      break;
    case 3:
      input.estimate = true;
      break;
    case 4:
      input.chord_error_mm = uniform(random, 0.001, 0.05);
      break;
    case 5:
      break;
    default:
      return nominal_band();
  }
  input.rest = {{-t_mm, t_mm}, "plus minus"};
  return build_band(input);
}

inline OverlapCase drawn_case(Random& random, int grade) {
  DrawnPair pair = any_pair(random);
  OverlapCase c;
  c.a = pair.a.solid;
  c.b = pair.b.solid;
  c.X_WA = pair.X_BA;
  c.band_a = band_of(random, grade, c.a, pair.a.band);
  c.band_b = band_of(random, grade, c.b, pair.b.band);
  return c;
}

/// A coarse peg, tilted and off the middle, of which the mesh may reach into that of the bore while
/// the surfaces keep clear; or two pegs side by side.
inline OverlapCase coarse_case(Random& random, int grade) {
  const double r = uniform(random, 2.0, 20.0), height = uniform(random, 5.0, 25.0);
  const bool beside = below(random, 4) == 0;
  const double tilt = below(random, 2) * uniform(random, 0.0005, 0.02);
  const double off = below(random, 2) * uniform(random, 0.0, 0.05);
  const double bore = r + off + 0.5 * height * std::sin(tilt) +
                      uniform(random, -0.01, below(random, 2) == 0 ? 0.005 : 0.1);
  const auto round = [&](double radius_mm, double from_mm, double to_mm) {
    return shapes::Round{
        radius_mm, from_mm, to_mm, 6 + below(random, 59), 1, uniform(random, 0.0, 1.0)};
  };
  const auto size = [&] {
    const double t = below(random, 2) * uniform(random, 0.0, 0.02);
    return Interval{-t, t};
  };
  OverlapCase c;
  c.a = shapes::solid(beside ? shapes::peg(round(bore, 0.0, height))
                             : shapes::ring(round(bore, 0.0, height), 3.0 * bore));
  c.b = shapes::solid(shapes::peg(round(r, -1.5 * height, 1.5 * height)));
  const double aside = beside ? bore + r + uniform(random, -0.02, 0.03) : off;
  c.X_WB = {rotation_exp(Vec3(0, tilt, 0)), Vec3(aside, 0, 0.5 * height)};
  c.band_a = band_of(random, grade, c.a, shapes::cylinder_band(c.a, bore, !beside, size()));
  c.band_b = band_of(random, grade, c.b, shapes::cylinder_band(c.b, r, false, size()));
  return c;
}

/// A D-shaft, one with two flats, an obround, in a hole like it or beside a plate.
inline OverlapCase profiled_case(Random& random, int grade) {
  const double r = uniform(random, 4.0, 10.0), less = uniform(random, -0.02, 0.05);
  const int kind = below(random, 3), facets = 8 + below(random, 40);
  const auto profile = [&](double by) {
    return kind == 2 ? rounded(r - by, 0.6 * r - by, 0.6 * r - by, facets / 4 + 1)
                     : flattened(r - by, 0.7 * r - by, kind == 1, facets);
  };
  const DrawnPart shaft = profile_part(random, profile(less), false);
  const DrawnPart plate = profile_part(random, profile(0.0), true);
  OverlapCase c;
  c.a = shaft.solid;
  c.b = plate.solid;
  c.X_WA.q = rotation_exp(Vec3(0, 0, below(random, 2) * uniform(random, -0.01, 0.01)) +
                          below(random, 2) * uniform(random, 0.0, 1e-3) * any_direction(random));
  c.X_WA.p =
      Vec3(0, 0, uniform(random, -10.0, 10.0)) + uniform(random, 0.0, 0.04) * any_direction(random);
  c.band_a = band_of(random, grade, c.a, shaft.band);
  c.band_b = band_of(random, grade, c.b, plate.band);
  return c;
}

/// Convex polyhedra, or unions of boxes, about where their largest bodies touch.
inline OverlapCase plane_case(Random& random, int grade, bool boxes) {
  const auto make = [&] {
    return boxes ? polyhedra::random_boxes(random) : polyhedra::random_convex(random);
  };
  const polyhedra::Polyhedron a = make(), b = make();
  OverlapCase c;
  c.a = a.solid;
  c.b = b.solid;
  c.X_WA.q = polyhedra::rotation(random);
  const Vec3 along = polyhedra::direction(random);
  double in = 0.0, out = 20.0;
  for (int k = 0; k < 16; ++k) {
    c.X_WA.p = 0.5 * (in + out) * along;
    (polyhedra::true_margin(a, b, c.X_WA, polyhedra::Body::kLargest) > 0.0 ? in : out) =
        0.5 * (in + out);
  }
  c.X_WA.p += polyhedra::between(random, -0.1, 0.05) * along;
  c.band_a = band_of(random, grade, c.a, a.band);
  c.band_b = band_of(random, grade, c.b, b.band);
  return c;
}

/// The i-th of a series: grades take turns, kinds are drawn.
inline OverlapCase any_case(Random& random, int i) {
  const int grade = i % kGradesOf, kind = below(random, 8);
  return kind == 0   ? profiled_case(random, grade)
         : kind >= 5 ? coarse_case(random, grade)
         : kind <= 2 ? drawn_case(random, grade)
                     : plane_case(random, grade, kind == 3);
}

}  // namespace mortise::mixed
