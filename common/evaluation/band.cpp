#include "common/evaluation/band.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/base/check.h"
#include "common/base/constants.h"
#include "common/evaluation/deviation.h"
#include "common/evaluation/estimate.h"
#include "common/evaluation/roundness.h"
#include "common/geometry/tips.h"

namespace mortise {
namespace {

// Offsets below this are rounding of the declared numbers, not knowledge: a picometre.
constexpr double kNothing_mm = 1e-9;

// Beyond the rounding of the file, which every face has.
bool says_nothing(const SurfaceBand& band, const SurfaceBand::Face& face) {
  const double nothing_mm = kNothing_mm + band.quantum_mm;
  return std::fabs(face.deviation_mm.lo) <= nothing_mm &&
         std::fabs(face.deviation_mm.hi) <= nothing_mm && face.tolerance_mm == Interval{};
}

// How far a corner is off across any facet of the mesh when each of its coordinates is off by one:
// 1 where all of them face along an axis, at most the root of 3.
double rounding_across(const TriangleMesh& mesh) {
  double most = 1.0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3& a = mesh.corner(t, 0);
    const Vec3 n = (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a);
    if (const double area = n.norm(); area > 0.0) most = std::max(most, n.lpNorm<1>() / area);
  }
  return most;
}

// A corner of the mesh is off by the rounding of its file. A declared surface is known apart from
// the corners; a recognized one was fitted to them.
void add_rounding(SurfaceBand& band, const BandInput& input) {
  if (!(input.quantum_mm > 0.0)) return;
  const double quantum_mm = input.quantum_mm * rounding_across(input.solid->mesh());
  band.quantum_mm = quantum_mm;
  for (SurfaceBand::Face& face : band.faces) {
    if (face.feature >= 0 && input.features[static_cast<std::size_t>(face.feature)].grade ==
                                 DeviationGrade::kDeclaredFeature)
      continue;
    face.deviation_mm = face.deviation_mm + Interval{-quantum_mm, quantum_mm};
    if (face.surface) face.residual_mm += quantum_mm;
  }
}

// Faces without triangles (a part whose features cover it) must not widen the search for near
// pairs.
void summarize(SurfaceBand& band, const Solid& solid) {
  std::vector<bool> used(band.faces.size(), band.face_of_triangle.empty());
  for (const std::uint16_t face : band.face_of_triangle) used[face] = true;
  band.largest_offset_mm = 0.0;
  band.trivial = true;
  for (std::size_t i = 0; i < band.faces.size(); ++i) {
    const SurfaceBand::Face& face = band.faces[i];
    if (!used[i]) continue;
    if (!says_nothing(band, face)) band.trivial = false;
    if (says_nothing(band, face) && band.quantum_mm == 0.0) continue;
    band.largest_offset_mm =
        std::max(band.largest_offset_mm,
                 face.deviation_mm.hi + std::max(0.0, face.unsure_mm.hi) + face.tolerance_mm.hi);
  }
  band.largest_travel_mm = 0.0;
  if (band.trivial || !(band.largest_offset_mm > 0.0)) return;
  for (const Tip& tip : find_tips(solid, band))
    band.largest_travel_mm = std::max(band.largest_travel_mm, tip.travel_mm);
}

void state(SurfaceBand::Face& face, const FaceStatement& statement) {
  face.tolerance_mm = statement.offset_mm;
  face.tolerance_source = statement.source;
  face.position_mm = statement.position.zone_mm;
  face.position_grows = statement.position.condition != MaterialCondition::kRegardless;
  if (!statement.is_size || face.unsure_mm == Interval{}) return;
  face.unsure_mm = {};
  face.grade = DeviationGrade::kRecognizedFeature;
}

SurfaceBand::Face face_of_feature(const Feature& feature, std::size_t index,
                                  const TriangleMesh& mesh) {
  SurfaceBand::Face face;
  face.name = feature.name;
  face.feature = static_cast<std::int32_t>(index);
  face.residual_mm = feature.residual_mm > kNothing_mm ? feature.residual_mm : 0.0;
  if (feature.surface.kind == SurfaceKind::kPlane) {
    face.grade = DeviationGrade::kPlanar;
    face.deviation_mm = {-face.residual_mm, face.residual_mm};
    return face;
  }
  face.grade = feature.grade;
  face.surface = feature.surface;
  bool first = true;
  for (const std::uint32_t t : feature.triangles) {
    const Interval outward = -feature.surface.signed_distance_range_mm(
        mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    face.deviation_mm = first ? outward : hull(face.deviation_mm, outward);
    first = false;
  }
  face.deviation_mm = face.deviation_mm + Interval{-face.residual_mm, face.residual_mm};
  return face;
}

// What of a recognized face may be flat is a face of its own, round by estimate: its real surface
// is between the facets and the surface through their corners. faces[1 + index] keeps what is
// round.
void split_off_doubtful(SurfaceBand& band, const Feature& feature, std::size_t index,
                        const TriangleMesh& mesh) {
  const Roundness roundness = roundness_of(mesh, feature);
  if (roundness.doubtful.empty()) return;
  Feature doubtful = feature;
  doubtful.triangles = roundness.doubtful;
  SurfaceBand::Face face = face_of_feature(doubtful, index, mesh);
  face.grade = DeviationGrade::kEstimated;
  const Interval chord = hull(-face.deviation_mm, Interval{});
  // Beyond the surface, too, where the facets are too few to tell the circle from another curve.
  const double beyond = roundness.is_circle ? 0.0 : kEstimatedDeviationFactor - 1.0;
  face.unsure_mm = {chord.lo - beyond * chord.hi, chord.hi - beyond * chord.lo};
  if (doubtful.triangles.size() == feature.triangles.size()) {
    band.faces[1 + index] = std::move(face);
    return;
  }
  const auto own = static_cast<std::uint16_t>(band.faces.size());
  for (const std::uint32_t t : doubtful.triangles) band.face_of_triangle.set(t, own);
  band.faces.push_back(std::move(face));
}

// The rest of the part by shape: faces[0] keeps what is of unknown shape, the others go behind.
void split_rest_by_shape(SurfaceBand& band, const Solid& solid, double chord_error_mm) {
  const std::vector<FaceShape> shapes = face_shapes(solid, chord_error_mm);
  band.faces[0].deviation_mm = chord_deviation_mm(FaceShape::kUnknown, chord_error_mm);
  band.faces[0].grade = DeviationGrade::kDeclaredChord;
  for (const FaceShape shape : {FaceShape::kConvex, FaceShape::kConcave, FaceShape::kPlanar}) {
    const auto index = static_cast<std::uint16_t>(band.faces.size());
    bool found = false;
    for (std::size_t t = 0; t < shapes.size(); ++t) {
      if (band.face_of_triangle[t] != 0 || shapes[t] != shape) continue;
      band.face_of_triangle.set(t, index);
      found = true;
    }
    if (!found) continue;
    SurfaceBand::Face face;
    face.deviation_mm = chord_deviation_mm(shape, chord_error_mm);
    face.grade =
        shape == FaceShape::kPlanar ? DeviationGrade::kPlanar : DeviationGrade::kDeclaredChord;
    band.faces.push_back(std::move(face));
  }
}

// The rest of the part by estimate: one face a class of offsets. faces[0] stays with what is flat.
// A recognized plane that may bend is of the rest as well: a facet of a curve beside a recognized
// round has no smooth neighbour that is not spoken for.
void split_rest_by_estimate(SurfaceBand& band, const Solid& solid,
                            std::span<const Feature> features, double quantum_mm) {
  constexpr std::size_t kMostFaces = 65000;  // face indices are 16 bit
  const std::vector<Interval> estimates = estimated_deviation_mm(solid, quantum_mm);
  band.faces[0].grade = DeviationGrade::kPlanar;
  std::map<std::pair<double, double>, std::uint16_t> face_of;
  std::vector<bool> may_bend(1 + features.size(), false);
  may_bend[0] = true;
  for (std::size_t i = 0; i < features.size(); ++i)
    may_bend[1 + i] = features[i].origin == FeatureOrigin::kRecognized &&
                      features[i].surface.kind == SurfaceKind::kPlane;
  for (std::size_t t = 0; t < estimates.size(); ++t) {
    if (const std::uint16_t own = band.face_of_triangle[t];
        own >= may_bend.size() || !may_bend[own])
      continue;
    const Interval offset = coarsened(estimates[t]);
    if (offset == Interval{}) continue;
    const auto [known, fresh] =
        face_of.try_emplace({offset.lo, offset.hi}, static_cast<std::uint16_t>(band.faces.size()));
    if (fresh) {
      MORTISE_CHECK(band.faces.size() < kMostFaces, "too many features beside an estimate");
      SurfaceBand::Face face;
      face.deviation_mm = offset;
      face.grade = DeviationGrade::kEstimated;
      band.faces.push_back(std::move(face));
    }
    band.face_of_triangle.set(t, known->second);
  }
}

// Triangles whose deviation somebody measured: a face for each face of the file.
void split_off_freeform(SurfaceBand& band, std::span<const FreeformFace> freeform) {
  for (const FreeformFace& measured : freeform) {
    const auto index = static_cast<std::uint16_t>(band.faces.size());
    for (const std::uint32_t t : measured.triangles) band.face_of_triangle.set(t, index);
    SurfaceBand::Face face;
    face.deviation_mm = measured.deviation_mm;
    face.grade = DeviationGrade::kEstimated;
    band.faces.push_back(std::move(face));
  }
}

std::size_t feature_count(const SurfaceBand& band) {
  std::int32_t last = -1;
  for (const SurfaceBand::Face& face : band.faces) last = std::max(last, face.feature);
  return static_cast<std::size_t>(last + 1);
}

}  // namespace

SurfaceBand build_band(const BandInput& input) {
  MORTISE_CHECK(input.solid != nullptr, "a band belongs to a solid");
  MORTISE_CHECK(input.features.size() + input.freeform.size() < 60000,
                "face indices are 16 bit: fewer features a part");
  SurfaceBand band = nominal_band();
  band.faces[0].grade = DeviationGrade::kNominal;
  const TriangleMesh& mesh = input.solid->mesh();
  const bool chord = input.chord_error_mm.value_or(0.0) > 0.0;
  const bool estimate = input.estimate && !chord;
  if (!input.features.empty() || !input.freeform.empty() || chord || estimate)
    band.face_of_triangle = std::vector<std::uint16_t>(mesh.triangles.size(), 0);
  for (std::size_t i = 0; i < input.features.size(); ++i) {
    const auto face = static_cast<std::uint16_t>(band.faces.size());
    for (const std::uint32_t t : input.features[i].triangles) band.face_of_triangle.set(t, face);
    band.faces.push_back(face_of_feature(input.features[i], i, mesh));
  }
  for (std::size_t i = 0; i < input.features.size(); ++i)
    split_off_doubtful(band, input.features[i], i, mesh);
  split_off_freeform(band, input.freeform);
  if (chord) split_rest_by_shape(band, *input.solid, *input.chord_error_mm);
  if (estimate) split_rest_by_estimate(band, *input.solid, input.features, input.quantum_mm);
  add_rounding(band, input);
  return with_statements(band, *input.solid, input.rest, input.of_feature);
}

SurfaceBand with_statements(const SurfaceBand& band, const Solid& solid, const FaceStatement& rest,
                            std::span<const FaceStatement> of_feature) {
  SurfaceBand stated = band;
  const std::size_t features = feature_count(band);
  MORTISE_CHECK(of_feature.size() == features, "one statement for each feature of the band");
  for (SurfaceBand::Face& face : stated.faces)
    state(face, face.feature >= 0 ? of_feature[static_cast<std::size_t>(face.feature)] : rest);
  summarize(stated, solid);
  MORTISE_CHECK(valid(stated, solid.mesh().triangles.size()),
                "a band has a face for each triangle and brackets with their lower ends first");
  return stated;
}

SurfaceBand grown(const SurfaceBand& band, const Solid& solid, double by_mm) {
  SurfaceBand larger = band;
  for (SurfaceBand::Face& face : larger.faces)
    face.tolerance_mm = face.tolerance_mm + Interval{by_mm, by_mm};
  summarize(larger, solid);
  return larger;
}

}  // namespace mortise
