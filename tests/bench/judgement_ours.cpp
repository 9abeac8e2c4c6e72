// Ours, as a session asks it: bands from what is known and stated, then the whole judgement.
#include "common/evaluation/band.h"
#include "tests/bench/judgement_methods.h"
#include "tests/bench/judgement_recognition.h"

namespace mortise::bench {
namespace {

SurfaceBand declared_band(const JudgedPart& part, const Interval& offset_mm, std::size_t stated) {
  BandInput input;
  input.solid = part.solid.get();
  if (stated == 0) {
    input.rest = {offset_mm, "zone"};
    return build_band(input);
  }
  input.features = part.features;
  input.of_feature.resize(part.features.size());
  for (std::size_t i = 0; i < stated; ++i) input.of_feature[i] = {offset_mm, "zone"};
  return build_band(input);
}

SurfaceBand chord_band(const JudgedPart& part, const Interval& offset_mm) {
  BandInput input;
  input.solid = part.solid.get();
  // A designer rounds up what the tessellator was told; here it is told to the last digit.
  const double chord = chord_error_mm(part);
  if (chord > 0.0) input.chord_error_mm = chord * (1.0 + 1e-9);
  input.rest = {offset_mm, "zone"};
  return build_band(input);
}

SurfaceBand estimated_band(const JudgedPart& part, const Interval& offset_mm) {
  BandInput input;
  input.solid = part.solid.get();
  input.estimate = true;
  input.rest = {offset_mm, "zone"};
  return build_band(input);
}

// A statement of size counts from the surface that was found.
Interval from_found(const Interval& offset_mm, const Surface& truth, const Surface& found) {
  if (truth.kind != SurfaceKind::kCylinder && truth.kind != SurfaceKind::kSphere) return offset_mm;
  const double shift = (truth.radius_mm - found.radius_mm) * (truth.inward ? -1.0 : 1.0);
  return {offset_mm.lo + shift, offset_mm.hi + shift};
}

std::optional<SurfaceBand> recognized_band(const JudgedPart& part, const Interval& offset_mm,
                                           std::size_t stated) {
  const Recognition recognition = recognize_features(*part.solid);
  BandInput input;
  input.solid = part.solid.get();
  input.features = recognition.features;
  input.of_feature.resize(recognition.features.size());
  for (std::size_t i = 0; i < stated; ++i) {
    const auto found = find_feature(recognition, part.solid->mesh(), part.features[i]);
    if (!found) return std::nullopt;
    input.of_feature[*found] = {
        from_found(offset_mm, part.features[i].surface, recognition.features[*found].surface),
        "zone"};
  }
  return build_band(input);
}

}  // namespace

const char* name_of(Grade grade) {
  switch (grade) {
    case Grade::kDeclared:
      return "declared feature";
    case Grade::kRecognized:
      return "recognized feature";
    case Grade::kChord:
      return "declared chord error";
    case Grade::kEstimated:
      return "estimated";
  }
  return "";
}

bool applies(Grade grade, const JudgedCase& c) {
  if (grade == Grade::kDeclared) return true;
  return c.facets() > 0;
}

bool speaks_of_whole(Grade grade, const JudgedCase& c) {
  return grade == Grade::kChord || grade == Grade::kEstimated || c.stated_a == 0;
}

std::optional<KnownPair> with_grade(const JudgedCase& c, Grade grade) {
  KnownPair pair;
  switch (grade) {
    case Grade::kDeclared:
      pair.a = part_of(1, c.a, declared_band(c.a, c.offset_a_mm, c.stated_a));
      pair.b = part_of(2, c.b, declared_band(c.b, c.offset_b_mm, c.stated_b));
      break;
    case Grade::kChord:
      pair.a = part_of(1, c.a, chord_band(c.a, c.offset_a_mm));
      pair.b = part_of(2, c.b, chord_band(c.b, c.offset_b_mm));
      break;
    case Grade::kRecognized: {
      auto band_a = recognized_band(c.a, c.offset_a_mm, c.stated_a);
      auto band_b = recognized_band(c.b, c.offset_b_mm, c.stated_b);
      if (!band_a || !band_b) return std::nullopt;
      pair.a = part_of(1, c.a, std::move(*band_a));
      pair.b = part_of(2, c.b, std::move(*band_b));
      break;
    }
    case Grade::kEstimated:
      pair.a = part_of(1, c.a, estimated_band(c.a, c.offset_a_mm));
      pair.b = part_of(2, c.b, estimated_band(c.b, c.offset_b_mm));
      break;
  }
  return pair;
}

Word ask_ours(const JudgedCase& c, const KnownPair& pair, const AskOurs& how) {
  return ask_ours(pair, c.X_WA, c.X_WB, how);
}

}  // namespace mortise::bench
