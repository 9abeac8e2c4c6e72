#include "client/tools/check/mating.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "common/evaluation/tolerance.h"

namespace mortise {
namespace {

struct ThreadSize {
  const char* name;
  double diameter_mm, pitch_mm;
};
// ISO 261 coarse, the small ones that screws for plastics have, and UNC.
constexpr std::array<ThreadSize, 24> kThreads = {{{"M1.6", 1.6, 0.35},
                                                  {"M1.7", 1.7, 0.35},
                                                  {"M2", 2.0, 0.4},
                                                  {"M2.5", 2.5, 0.45},
                                                  {"M2.6", 2.6, 0.45},
                                                  {"M3", 3.0, 0.5},
                                                  {"M3.5", 3.5, 0.6},
                                                  {"M4", 4.0, 0.7},
                                                  {"M5", 5.0, 0.8},
                                                  {"M6", 6.0, 1.0},
                                                  {"M8", 8.0, 1.25},
                                                  {"M10", 10.0, 1.5},
                                                  {"M12", 12.0, 1.75},
                                                  {"M14", 14.0, 2.0},
                                                  {"M16", 16.0, 2.0},
                                                  {"M20", 20.0, 2.5},
                                                  {"M24", 24.0, 3.0},
                                                  {"#4-40 UNC", 2.845, 0.635},
                                                  {"#6-32 UNC", 3.505, 0.794},
                                                  {"#8-32 UNC", 4.166, 0.794},
                                                  {"#10-24 UNC", 4.826, 1.058},
                                                  {"1/4-20 UNC", 6.35, 1.27},
                                                  {"5/16-18 UNC", 7.938, 1.411},
                                                  {"3/8-16 UNC", 9.525, 1.588}}};

constexpr double kOffAxis_mm = 0.05;        // of hole and shaft that belong together
constexpr double kOffAngle = 1.5e-3;        // sine
constexpr double kLeastLength_mm = 0.02;    // along the axis that both share; less is a rim
constexpr double kSameSize_mm = 2e-3;       // of diameters: one nominal size
constexpr double kScrewSize = 0.06;         // a screw is drawn up to this share off its size
constexpr double kInsertLeast_mm = 0.1;     // interference; below it a press fit is possible
constexpr double kInsertLargest_mm = 12.0;  // diameter
constexpr double kMostInterference = 0.35, kMostClearance = 0.2;  // shares that still belong

struct Placed {
  Vec3 point, axis;  // world
  double radius_mm = 0.0, share = 1.0;
  Interval along_mm;  // from point
};

Placed placed(const Part& part, const Feature& feature) {
  Placed p;
  p.point = part.X_WP * feature.surface.point;
  p.axis = part.X_WP.q * feature.surface.axis;
  p.radius_mm = feature.surface.radius_mm;
  const TriangleMesh& mesh = part.solid->mesh();
  double area = 0.0;
  bool first = true;
  for (const std::uint32_t t : feature.triangles) {
    area +=
        0.5 *
        (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).norm();
    for (int k = 0; k < 3; ++k) {
      const double z = (mesh.corner(t, k) - feature.surface.point).dot(feature.surface.axis);
      p.along_mm = first ? Interval{z, z} : hull(p.along_mm, {z, z});
      first = false;
    }
  }
  const double whole = 2.0 * std::numbers::pi * p.radius_mm * p.along_mm.width();
  // Facets are shorter than the round that they stand for.
  if (whole > 0.0) p.share = std::min(1.0, 1.03 * area / whole);
  return p;
}

// The length over which both lie along the axis of the first; negative: none.
double common_length(const Placed& a, const Placed& b) {
  const double shift = (b.point - a.point).dot(a.axis);
  const double sign = a.axis.dot(b.axis) < 0.0 ? -1.0 : 1.0;
  const double x = shift + sign * b.along_mm.lo, y = shift + sign * b.along_mm.hi;
  return std::min(a.along_mm.hi, std::max(x, y)) - std::max(a.along_mm.lo, std::min(x, y));
}

bool on_one_axis(const Placed& a, const Placed& b) {
  if (a.axis.cross(b.axis).norm() > kOffAngle) return false;
  const Vec3 d = b.point - a.point;
  return (d - d.dot(a.axis) * a.axis).norm() <= kOffAxis_mm;
}

// The standard size that a screw is nearest to, when the hole is one of its core.
std::optional<ThreadSize> thread_of(double hole_mm, double shaft_mm) {
  std::optional<ThreadSize> best;
  for (const ThreadSize& thread : kThreads) {
    const double off = std::fabs(shaft_mm - thread.diameter_mm);
    if (off > kScrewSize * thread.diameter_mm) continue;
    if (hole_mm < thread.diameter_mm - 1.3 * thread.pitch_mm - 0.02 ||
        hole_mm > thread.diameter_mm - 0.6 * thread.pitch_mm)
      continue;
    if (!best || off < std::fabs(shaft_mm - best->diameter_mm)) best = thread;
  }
  return best;
}

// Is a size stated of both faces, or a fit of the pair?
bool is_stated(const World& world, const Part& a, const Part& b, const CoaxialPair& pair) {
  const PairRule* rule = world.rule(a.id, b.id);
  if (rule != nullptr && !rule->fit.empty()) return true;
  const auto has_size = [](const Part& part, std::size_t feature) {
    return std::any_of(part.band.faces.begin(), part.band.faces.end(), [&](const auto& face) {
      return face.feature == static_cast<std::int32_t>(feature) && !face.tolerance_source.empty();
    });
  };
  return has_size(a, pair.feature_a) && has_size(b, pair.feature_b);
}

// What names the pair: what is meant to overlap goes before what only touches.
int rank(MatingKind relation) {
  switch (relation) {
    case MatingKind::kThread:
      return 7;
    case MatingKind::kInsert:
      return 6;
    case MatingKind::kPressFit:
      return 5;
    case MatingKind::kFitStated:
      return 4;
    case MatingKind::kFitNotStated:
      return 3;
    case MatingKind::kClearanceHole:
      return 2;
    case MatingKind::kTouching:
      return 1;
    case MatingKind::kUnknown:
      break;
  }
  return 0;
}

std::string pair_text(const CoaxialPair& pair) {
  const std::string hole = "Ø" + size_text(pair.hole_mm), shaft = "Ø" + size_text(pair.shaft_mm);
  return (pair.thread.empty() ? shaft : pair.thread + " (" + shaft + ")") + " in " + hole;
}

std::string text_of(const std::vector<CoaxialPair>& pairs, MatingKind relation) {
  std::map<std::string, int> counts;
  for (const CoaxialPair& pair : pairs)
    if (pair.relation == relation) ++counts[pair_text(pair)];
  std::string text;
  for (const auto& [what, count] : counts)
    text += (text.empty() ? "" : ", ") + what + (count > 1 ? fmt::format(" (×{})", count) : "");
  return text;
}

}  // namespace

std::string_view name_of(MatingKind relation) {
  constexpr std::array<std::string_view, kMatingKindCount> kNames = {
      "unknown",        "touching",      "fit stated",
      "fit not stated", "thread",        "insert or self-tapping",
      "press fit",      "clearance hole"};
  return kNames[static_cast<std::size_t>(relation)];
}

bool is_meant_to_overlap(MatingKind relation) {
  return relation == MatingKind::kThread || relation == MatingKind::kInsert ||
         relation == MatingKind::kPressFit;
}

double CoaxialPair::explained_mm3() const {
  const double ring = shaft_mm * shaft_mm - hole_mm * hole_mm;
  return ring > 0.0 ? 0.25 * std::numbers::pi * ring * length_mm * share : 0.0;
}

SizeRelation relation_of_sizes(double hole_mm, double shaft_mm) {
  if (std::fabs(hole_mm - shaft_mm) <= kSameSize_mm) return {MatingKind::kFitNotStated, ""};
  if (hole_mm > shaft_mm) {
    const bool belongs = hole_mm - shaft_mm <= kMostClearance * shaft_mm + 0.2;
    return {belongs ? MatingKind::kClearanceHole : MatingKind::kUnknown, ""};
  }
  if (const auto thread = thread_of(hole_mm, shaft_mm)) return {MatingKind::kThread, thread->name};
  const double interference = shaft_mm - hole_mm;
  if (interference > kMostInterference * shaft_mm) return {};
  if (interference < kInsertLeast_mm) return {MatingKind::kPressFit, ""};
  if (shaft_mm <= kInsertLargest_mm) return {MatingKind::kInsert, ""};
  return {};
}

Mating MatingFinder::find(const Part& a, const Part& b) const {
  Mating mating;
  for (std::size_t i = 0; i < a.features.size(); ++i) {
    const Surface& of_a = a.features[i].surface;
    if (of_a.kind != SurfaceKind::kCylinder) continue;
    std::optional<Placed> in_a;
    for (std::size_t j = 0; j < b.features.size(); ++j) {
      const Surface& of_b = b.features[j].surface;
      if (of_b.kind != SurfaceKind::kCylinder || of_a.inward == of_b.inward) continue;
      CoaxialPair pair;
      pair.feature_a = i;
      pair.feature_b = j;
      pair.hole_mm = 2.0 * (of_a.inward ? of_a : of_b).radius_mm;
      pair.shaft_mm = 2.0 * (of_a.inward ? of_b : of_a).radius_mm;
      const SizeRelation sizes = relation_of_sizes(pair.hole_mm, pair.shaft_mm);
      if (sizes.relation == MatingKind::kUnknown) continue;
      if (!in_a) in_a = placed(a, a.features[i]);
      const Placed in_b = placed(b, b.features[j]);
      if (!on_one_axis(*in_a, in_b)) continue;
      pair.length_mm = common_length(*in_a, in_b);
      if (pair.length_mm < kLeastLength_mm) continue;
      pair.share = std::min(in_a->share, in_b.share);
      pair.relation = sizes.relation;
      pair.thread = sizes.thread;
      if (!is_meant_to_overlap(pair.relation) && is_stated(world_, a, b, pair))
        pair.relation = MatingKind::kFitStated;
      mating.pairs.push_back(std::move(pair));
    }
  }
  for (const CoaxialPair& pair : mating.pairs) {
    if (is_meant_to_overlap(pair.relation)) mating.explained_mm3 += pair.explained_mm3();
    if (rank(pair.relation) > rank(mating.relation)) mating.relation = pair.relation;
  }
  mating.text = text_of(mating.pairs, mating.relation);
  return mating;
}

}  // namespace mortise
