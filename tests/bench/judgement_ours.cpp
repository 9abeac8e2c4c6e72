// Ours, as a session asks it: bands from what is known and stated, then the whole judgement.
#include <algorithm>

#include "common/evaluation/band.h"
#include "tests/bench/judgement_methods.h"
#include "tests/bench/judgement_recognition.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

Part part_of(std::uint32_t id, const JudgedPart& judged, SurfaceBand band) {
  Part part;
  part.id = PartId{id};
  part.name = id == 1 ? "inner" : "outer";
  part.solid = judged.solid;
  part.band = std::move(band);
  part.features = judged.features;
  return part;
}

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
  JudgementQuery query;
  query.a = how.swapped ? &pair.b : &pair.a;
  query.b = how.swapped ? &pair.a : &pair.b;
  query.motion_a = still_motion(how.swapped ? c.X_WB : c.X_WA);
  query.motion_b = still_motion(how.swapped ? c.X_WA : c.X_WB);
  query.refinement = how.refinement;
  query.want_gpd = false;
  query.work_cap = how.work_cap;
  // Trees and topologies belong to the part, not to the question.
  for (const Part* part : {query.a, query.b}) part->solid->bvh(), part->solid->topology();
  CcdScratch scratch;
  const Stopwatch watch;
  const Judgement judgement = judge_pair(query, scratch);
  Word word;
  word.time_s = watch.elapsed_s();
  if (!judgement.verdicts.empty()) word.collision_class = judgement.verdicts[0].collision_class;
  for (const OverlapRegion& region : judgement.overlap.regions) {
    const auto deeper = [](std::optional<Interval>& worst, const Interval& found) {
      worst =
          worst ? Interval{std::max(worst->lo, found.lo), std::max(worst->hi, found.hi)} : found;
    };
    deeper(word.depth_mm, region.delta_mm);
    deeper(word.certain_mm, region.certain_mm);
    deeper(word.possible_mm, region.possible_mm);
    word.capped |= region.capped;
  }
  return word;
}

}  // namespace mortise::bench
