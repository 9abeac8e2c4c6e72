#include "common/session/guide/snap_candidates.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "common/messages/names.h"
#include "common/session/guide/guidance.h"
#include "common/session/world/moving_group.h"
#include "common/session/world/standing.h"

namespace mortise {
namespace {

constexpr double kAnyLimit = std::numeric_limits<double>::infinity();

struct Placed {
  const Feature* feature;
  Vec3 point_W, direction_W;
};

bool is_round(const Surface& s) {
  return s.kind == SurfaceKind::kCylinder || s.kind == SurfaceKind::kCone ||
         s.kind == SurfaceKind::kTorus;
}

std::vector<Placed> placed_features(const World& world, const Part& part) {
  std::vector<Placed> placed;
  const auto add = [&](const Feature& feature) {
    if (feature.surface.kind != SurfaceKind::kUnknown)
      placed.push_back({&feature, part.X_WP * feature.surface.point,
                        part.X_WP.q * feature.surface.axis.normalized()});
  };
  for (const Feature& feature : part.features) add(feature);
  const auto shown = world.recognized.find(part.solid->hash());
  if (shown == world.recognized.end() || !shown->second) return placed;
  for (const Feature& feature : *shown->second) {
    const auto same_name = [&](const Feature& own) { return own.name == feature.name; };
    if (std::none_of(part.features.begin(), part.features.end(), same_name)) add(feature);
  }
  return placed;
}

// A round outside goes with a round inside of the same kind and nearly the same size.
bool sizes_agree(const Surface& a, const Surface& b, double share, double& off_mm) {
  if (a.inward == b.inward) return false;
  off_mm = std::abs(a.radius_mm - b.radius_mm);
  if (a.kind == SurfaceKind::kCone) return std::abs(a.half_angle_rad - b.half_angle_rad) <= share;
  if (a.kind == SurfaceKind::kTorus)
    off_mm = std::max(off_mm, std::abs(a.tube_radius_mm - b.tube_radius_mm));
  return off_mm <= share * std::max(a.radius_mm, b.radius_mm);
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Fills in distance, angle and radii of the candidate; false: not alike, or not near.
bool near_and_alike(const Placed& a, const Placed& b, const Vec3& reference_W,
                    const SnapLimits& limits, SnapCandidate& candidate) {
  const Surface &sa = a.feature->surface, &sb = b.feature->surface;
  if (sa.kind != sb.kind) return false;
  const Vec3 gap = a.point_W - b.point_W;
  if (sa.kind == SurfaceKind::kPlane) {
    candidate.constraint.kind = ConstraintKind::kCoplanar;
    candidate.angle_rad = angle_between(a.direction_W, -b.direction_W);
    candidate.distance_mm = std::abs(gap.dot(b.direction_W));
  } else {
    candidate.constraint.kind = ConstraintKind::kCoaxial;
    if (!sizes_agree(sa, sb, limits.radius_share, candidate.radius_off_mm)) return false;
    candidate.distance_mm = gap.norm();
    if (is_round(sa)) {
      const double angle = angle_between(a.direction_W, b.direction_W);
      candidate.angle_rad = std::min(angle, std::acos(-1.0) - angle);
      // The point of the part's axis that is nearest to its middle.
      const Vec3 middle = a.point_W + (reference_W - a.point_W).dot(a.direction_W) * a.direction_W;
      candidate.distance_mm = (middle - b.point_W).cross(b.direction_W).norm();
    }
  }
  return candidate.angle_rad <= limits.angle_rad && candidate.distance_mm <= limits.distance_mm;
}

// The fits in force of one part, each from its end.
class Fits {
 public:
  Fits(const World& world, PartId part) {
    for (Decision& fit : standing_decisions(world)) {
      Details& of = fit.details;
      if (fit.kind != Decision::Kind::kSetTolerance || !of.other_part || of.text.empty()) continue;
      if (of.other_part == part) {
        of.other_part = fit.part;
        std::swap(of.feature, of.other_feature);
      } else if (fit.part != part) {
        continue;
      }
      of_[{of.other_part, of.feature, of.other_feature}] = of.text;
    }
  }
  std::string between(const std::string& feature, const FeatureOf& other) const {
    const auto found = of_.find({other.part, feature, other.feature});
    return found == of_.end() ? "" : found->second;
  }

 private:
  std::map<std::tuple<PartId, std::string, std::string>, std::string> of_;
};

}  // namespace

std::vector<SnapCandidate> snap_candidates(const World& world, PartId part_id,
                                           const SnapLimits& limits) {
  std::vector<SnapCandidate> candidates;
  if (!world.find(part_id)) return candidates;
  const Part& part = *world.find(part_id);
  const MovingGroup group = moving_group_of(world, part_id.value - 1);
  const std::vector<Placed> own = placed_features(world, part);
  const Fits fits(world, part_id);
  const Vec3 reference_W = part.X_WP * part.solid->sphere().center_mm;
  for (const Part& other : world.parts) {
    if (!other.present) continue;
    const auto& ball = other.solid->sphere();
    const double gap_mm = (other.X_WP * ball.center_mm - reference_W).norm() - ball.radius_mm -
                          part.solid->sphere().radius_mm;
    if (gap_mm > limits.distance_mm) continue;
    if (std::binary_search(group.parts.begin(), group.parts.end(), other.id.value - 1)) continue;
    for (const Placed& b : placed_features(world, other))
      for (const Placed& a : own) {
        SnapCandidate candidate;
        if (!near_and_alike(a, b, reference_W, limits, candidate)) continue;
        candidate.constraint.held = {part.id, a.feature->name};
        candidate.constraint.other = {other.id, b.feature->name};
        candidate.constraint.snap = true;
        candidate.fit = fits.between(a.feature->name, candidate.constraint.other);
        candidates.push_back(std::move(candidate));
      }
  }
  // Nearest first: turning by an angle moves the rim of the part.
  const double lever_mm = part.solid->sphere().radius_mm;
  const auto key = [&](const SnapCandidate& c) {
    return std::pair(c.fit.empty(), c.distance_mm + lever_mm * c.angle_rad + c.radius_off_mm);
  };
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](const auto& x, const auto& y) { return key(x) < key(y); });
  if (candidates.size() > limits.most) candidates.resize(limits.most);
  return candidates;
}

namespace {

bool allows(const Constraint& wish, const Constraint& candidate) {
  return (wish.kind == ConstraintKind::kUnknown || wish.kind == candidate.kind) &&
         (!wish.other.part || wish.other.part == candidate.other.part) &&
         (wish.held.feature.empty() || wish.held.feature == candidate.held.feature) &&
         (wish.other.feature.empty() || wish.other.feature == candidate.other.feature);
}

std::string named(const World& world, const FeatureOf& side) {
  return "'" + world.find(side.part)->name + "." + side.feature + "'";
}

std::string chosen_text(const World& world, const SnapCandidate& candidate) {
  char off[64];
  std::snprintf(off, sizeof off, "%.3g mm and %.3g degrees", candidate.distance_mm,
                candidate.angle_rad * 180.0 / std::numbers::pi);
  return named(world, candidate.constraint.held) + " " +
         std::string(name_of(candidate.constraint.kind)) + " with " +
         named(world, candidate.constraint.other) + ", " + off + " away" +
         (candidate.fit.empty() ? "" : "; their fit is " + candidate.fit);
}

// What was asked for, for the sentence that says that it is not there.
std::string wish_text(const World& world, const Constraint& wish) {
  const auto or_any = [](const std::string& name) {
    return name.empty() ? "any" : "'" + name + "'";
  };
  std::string text =
      "no feature to snap '" + world.find(wish.held.part)->name + "' to: looked for " +
      (wish.kind == ConstraintKind::kUnknown ? "any constraint" : std::string(name_of(wish.kind))) +
      " of " + or_any(wish.held.feature) + " with " + or_any(wish.other.feature);
  if (wish.other.part) return text + " of '" + world.find(wish.other.part)->name + "'";
  return text + " of parts near it; bring it nearer or name the other part";
}

}  // namespace

SnapChoice choose_snap(const World& world, UserId user, const Constraint& wish) {
  SnapChoice choice{Refusal::kNothingNear, "", wish};
  const PartId missing = !world.find(wish.held.part) ? wish.held.part : wish.other.part;
  if (!world.find(wish.held.part) || (wish.other.part && !world.find(wish.other.part)))
    return {Refusal::kUnknownPart, "there is no part " + std::to_string(missing.value), wish};
  if (wish.kind == ConstraintKind::kParallelDistance || wish.kind == ConstraintKind::kTangent)
    return {Refusal::kConstraintUnfit,
            "a snap is coaxial or coplanar; set other constraints by their features", wish};
  SnapLimits limits;
  limits.most = std::numeric_limits<std::size_t>::max();
  if (wish.other.part) limits.angle_rad = limits.distance_mm = kAnyLimit;
  const int freedom = guided_state(world, wish.held.part).freedom;
  std::string refused;  // why the nearest was not taken
  for (const SnapCandidate& candidate : snap_candidates(world, wish.held.part, limits)) {
    if (!allows(wish, candidate.constraint)) continue;
    const GuidanceReply reply = check_constraint(world, user, candidate.constraint);
    if (reply.refusal == Refusal::kNone && reply.freedom < freedom)
      return {Refusal::kNone, chosen_text(world, candidate), candidate.constraint};
    if (refused.empty())
      refused = reply.refusal == Refusal::kNone ? "it is kept already" : reply.text;
    if (reply.refusal == Refusal::kUnknownUser || reply.refusal == Refusal::kNotHolder)
      return {reply.refusal, reply.text, wish};
  }
  choice.text = wish_text(world, wish);
  if (!refused.empty()) choice.text += "; of the nearest: " + refused;
  return choice;
}

}  // namespace mortise
