#include "common/depth/cells/decide.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "common/base/check.h"
#include "common/ccd/distance.h"
#include "common/depth/cells/deepest.h"
#include "common/depth/cells/tight_box.h"

namespace mortise {
namespace {

// Linear programs of a query.
constexpr std::uint64_t kMostProgramsOfQuery = 1000;
// Windows of a query, and how often one is halved: ten times along each axis, to a thousandth.
constexpr std::size_t kMostWindows = 96;
// Where only what is deeper is asked for. Of 90 touching pairs of the bench seven looked deeper:
// three ended within five windows, four took all of kMostWindows for nothing.
constexpr std::size_t kMostDeeperWindows = 16;
constexpr int kMostWindowHalvings = 30;
// How often a window is made tighter at most; again where it got shorter than this share.
constexpr int kTightenings = 4;
constexpr double kWorthTightening = 0.8;
// A window is not halved when it is narrower than this share of the reach.
constexpr double kNarrowWindow = 0.5;
// A wider window is made with room, so that it is wide enough for what it newly contains.
constexpr double kReachShare = 1.01;
// Who is no farther from a part than this share of what it may be grown by stays in the box of it,
// whatever is rounded.
constexpr double kSurelyApart = 0.5;
// The deepest point may be this far outside of the box that holds it: rounding of a linear program.
constexpr double kOutside_mm = 1e-6;

// Where both parts can be.
Box core_of(const SharpQuery& query) {
  const auto grown = [&](const SharpPart& part, const Box& box) {
    return box.grown(part.planes->most_travel.by_mm(query.depth_mm));
  };
  Box of_a;
  const Box& a = query.a.solid->bounds();
  for (int corner = 0; corner < 8; ++corner)
    of_a.add(query.X_BA * Vec3((corner & 1 ? a.hi : a.lo).x(), (corner & 2 ? a.hi : a.lo).y(),
                               (corner & 4 ? a.hi : a.lo).z()));
  of_a = grown(query.a, of_a);
  const Box of_b = grown(query.b, query.b.solid->bounds());
  Box core;
  core.lo = of_a.lo.cwiseMax(of_b.lo);
  core.hi = of_a.hi.cwiseMin(of_b.hi);
  return core;
}

class SharpSearch {
 public:
  SharpSearch(const SharpQuery& query, double reach_mm)
      : query_(query), reach_mm_(reach_mm), core_(core_of(query)), origin_(core_.center()) {}

  SharpDecision run() {
    const auto decided = [&] { return decision_.state == SharpDecision::State::kDecided; };
    if (query_.known != nullptr) {
      decision_.least = query_.known->least;
      decision_.largest = query_.known->largest;
      decision_.least.overlap_mm = decision_.largest.overlap_mm = {};
    }
    for (const auto& [layer, depth] : {std::pair{SharpLayer::kLeast, &decision_.least},
                                       std::pair{SharpLayer::kLargest, &decision_.largest}}) {
      if (decided() && !(query_.known != nullptr && depth->has_point)) find_margin(layer, *depth);
      if (decided() && depth->margin_mm.lo > 0.0) find_overlap(layer, *depth);
    }
    return decision_;
  }

  /// With kTooSharp: what the window that was too small would have needed.
  double needed_reach_mm() const { return needed_reach_mm_; }

 private:
  void find_margin(SharpLayer layer, SharpDepth& depth) {
    depth.margin_mm = search({layer, SharpMeasure::kMargin, query_.depth_mm}, -kInfinity);
    depth.has_point = point_.has_value();
    if (!point_) return;
    depth.point_B = *point_;
    depth.facing = facing_;
    depth.face_a = deciding_[0];
    depth.face_b = deciding_[1];
  }
  // A point with both depths above zero has more than the margin.
  void find_overlap(SharpLayer layer, SharpDepth& depth) {
    depth.overlap_mm = search({layer, SharpMeasure::kSum, query_.depth_mm}, depth.margin_mm.lo);
  }

  Interval search(const DeepestPoint& deepest, double best) {
    best_ = best;
    upper_ = -kInfinity;
    point_.reset();
    if (!core_.empty()) search_core(deepest, core_, 0);
    return {best_, std::max({best_, upper_, deepest.nothing_mm()})};
  }

  void search_core(const DeepestPoint& deepest, const Box& wide, int level) {
    if (decision_.state != SharpDecision::State::kDecided) return;
    Window* window = window_of(wide);
    if (window == nullptr) return;
    const Box& core = window->core;
    WindowPair* windows = &*window->pair;
    const bool narrow =
        (core.hi - core.lo).maxCoeff() < kNarrowWindow * reach_mm_ || level >= kMostWindowHalvings;
    bool crowded = false;
    for (const SharpWindow& part : windows->part)
      crowded |= part.state() == SharpWindow::State::kCrowded;
    if (crowded && narrow) return give_up(SharpDecision::State::kTooMuch);
    if (crowded) return search_halves(deepest, core, level, core.center());
    for (const SharpWindow& part : windows->part)
      if (part.faces().empty() && !part.solid_inside()) return;
    DeepestPoint::Found found = find(deepest, *windows, false);
    if (found.bound <= best_ || (!found.closed && found.bound <= deepest.nothing_mm())) return;
    if (found.closed && deepest.in_least(*windows, found.at)) {
      upper_ = std::max(upper_, found.bound);
      return take(deepest, *windows, found);
    }
    if (!narrow)
      return search_halves(deepest, core, level, found.closed ? place(found.at) : core.center());
    // Ambiguous here: the largest of the bodies bound it from above, the least from below.
    upper_ = std::max(upper_, found.bound);
    found = find(deepest, *windows, true);
    if (found.closed && deepest.in_least(*windows, found.at)) take(deepest, *windows, found);
  }

  DeepestPoint::Found find(const DeepestPoint& deepest, WindowPair& windows, bool least_bodies) {
    const DeepestPoint::Found found = deepest.find(windows, least_bodies, best_);
    decision_.programs += found.programs;
    if (decision_.programs > kMostProgramsOfQuery) give_up(SharpDecision::State::kTooMuch);
    return found;
  }

  void give_up(SharpDecision::State state) { decision_.state = state; }

  // The half with the point first.
  void search_halves(const DeepestPoint& deepest, const Box& core, int level, const Vec3& point) {
    int k = 0;
    (core.hi - core.lo).maxCoeff(&k);
    Box halves[2] = {core, core};
    halves[0].hi[k] = halves[1].lo[k] = core.center()[k];
    const int first = point[k] > core.center()[k] ? 1 : 0;
    search_core(deepest, halves[first], level + 1);
    search_core(deepest, halves[1 - first], level + 1);
  }

  // The part of a box where both bodies may have points, and what they look like from there.
  struct Window {
    Box core;
    std::optional<WindowPair> pair;  // none: one of them has no points
  };

  // Null: no common point is there; or given up, since there are too many windows, or it cannot be
  // judged.
  Window* window_of(const Box& wide) {
    const std::array<double, 6> key = {wide.lo.x(), wide.lo.y(), wide.lo.z(),
                                       wide.hi.x(), wide.hi.y(), wide.hi.z()};
    const auto [place, fresh] = windows_.try_emplace(key);
    Window& window = place->second;
    if (!fresh) return window.pair ? &window : nullptr;
    if (windows_.size() > (query_.known != nullptr ? kMostDeeperWindows : kMostWindows)) {
      give_up(SharpDecision::State::kTooMuch);
      return nullptr;
    }
    window.core = tightened(wide);
    if (window.core.empty()) return nullptr;
    window.pair.emplace(query_, reach_mm_, window.core, origin_);
    for (const SharpWindow& part : window.pair->part) {
      if (part.state() == SharpWindow::State::kNotPlane) give_up(SharpDecision::State::kNotPlane);
      if (part.state() != SharpWindow::State::kTooSharp) continue;
      give_up(SharpDecision::State::kTooSharp);
      needed_reach_mm_ = std::max(needed_reach_mm_, part.needed_reach_mm());
    }
    return decision_.state == SharpDecision::State::kDecided ? &window : nullptr;
  }

  Box tightened(Box core) const {
    for (int i = 0; i < kTightenings && !core.empty(); ++i) {
      const double length = (core.hi - core.lo).sum();
      core = tight_box(query_.a, query_.X_BA, core, query_.depth_mm);
      if (!core.empty()) core = tight_box(query_.b, Pose(), core, query_.depth_mm);
      if (core.empty() || (core.hi - core.lo).sum() > kWorthTightening * length) break;
    }
    return core;
  }

  void take(const DeepestPoint& deepest, const WindowPair& windows,
            const DeepestPoint::Found& found) {
    const LinearProgram::Optimum& at = found.at;
    if (deepest.proven_mm(at) <= best_) return;
    facing_ = found.facing;
    best_ = deepest.proven_mm(at);
    point_ = place(at);
    for (int part = 0; part < 2; ++part)
      if (found.deciding[part] >= 0)
        deciding_[part] =
            windows.part[part].faces()[static_cast<std::size_t>(found.deciding[part])];
  }

  Vec3 place(const LinearProgram::Optimum& at) const {
    return origin_ + Vec3(at.y[0], at.y[1], at.y[2]);
  }

  const SharpQuery& query_;
  double reach_mm_, needed_reach_mm_ = 0.0;
  Box core_;  // where common points are looked for, frame of B
  Vec3 origin_;
  std::map<std::array<double, 6>, Window> windows_;
  double best_ = -kInfinity, upper_ = -kInfinity;
  std::optional<Vec3> point_;
  double facing_ = 1.0;
  std::uint32_t deciding_[2] = {0, 0};
  SharpDecision decision_;
};

bool has_unknown_travel(const SharpPart& part, double depth_mm) {
  const PlaneFaces& planes = *part.planes;
  return std::any_of(
      planes.sharp_points.begin(), planes.sharp_points.end(),
      [&](std::uint32_t point) { return std::isinf(planes.travel_of[point].by_mm(depth_mm)); });
}

// A window of a part with a corner whose travel is not known is never wide enough. Where no window
// is found empty, as one with this point never is, that need not be tried.
bool is_surely_too_sharp(const SharpQuery& query) {
  if (!has_unknown_travel(query.a, query.depth_mm) && !has_unknown_travel(query.b, query.depth_mm))
    return false;
  const auto reach_mm = [&](const SharpPart& part) {
    return part.planes->most_travel.by_mm(query.depth_mm);
  };
  const double apart_mm = kSurelyApart * (reach_mm(query.a) + reach_mm(query.b));
  CcdScratch scratch;
  const DistanceResult nearest =
      distance(*query.a.solid, query.X_BA, *query.b.solid, Pose(), scratch, apart_mm);
  const double least_mm = kSurelyApart * std::min(reach_mm(query.a), reach_mm(query.b));
  return nearest.within_limit && 0.5 * nearest.distance_mm <= least_mm;
}

void check(const SharpQuery& query) {
  for (const SharpPart& part : {query.a, query.b})
    MORTISE_CHECK(part.solid != nullptr && part.planes != nullptr,
                  "each part has a solid and its plane faces");
  MORTISE_CHECK(valid(query.X_BA), "a pose must be finite and its quaternion unit");
  MORTISE_CHECK(query.depth_mm >= 0.0 && query.depth_mm <= kLargestCoordinate_mm,
                "a depth must be a length");
  MORTISE_CHECK(query.known == nullptr || query.known->state == SharpDecision::State::kDecided,
                "what is known of a pair is decided");
}

void check(const SharpQuery& query, const SharpDepth& depth) {
  MORTISE_CHECK(depth.margin_mm.ordered() && depth.overlap_mm.ordered(),
                "a bracket has its lower end first");
  MORTISE_CHECK(0.0 < depth.facing && depth.facing <= 1.0, "a share that faces is up to one");
  if (!depth.has_point) return;
  MORTISE_CHECK(core_of(query).grown(kOutside_mm).overlaps({depth.point_B, depth.point_B}),
                "the deepest point lies where both bodies can be");
  MORTISE_CHECK(
      depth.face_a < query.a.planes->faces.size() && depth.face_b < query.b.planes->faces.size(),
      "the deciding faces are those of the parts");
}

// What SharpDecision promises.
void check(const SharpQuery& query, const SharpDecision& decision) {
  if (decision.state != SharpDecision::State::kDecided) return;
  check(query, decision.least);
  check(query, decision.largest);
  MORTISE_CHECK(decision.least.margin_mm.lo <= decision.largest.margin_mm.hi,
                "the least bodies lie within the largest");
}

}  // namespace

// A wider window is tried where an edge or tip asks for it.
SharpDecision decide(const SharpQuery& query) {
  check(query);
  if (query.ask_ahead && is_surely_too_sharp(query)) {
    SharpDecision undecided;
    undecided.state = SharpDecision::State::kTooSharp;
    return undecided;
  }
  double face_mm = query.depth_mm;
  for (const SharpPart& part : {query.a, query.b})
    for (const PlaneFace& face : part.planes->faces)
      face_mm = std::max(face_mm, query.depth_mm + std::max(std::fabs(face.offset_mm.lo),
                                                            std::fabs(face.offset_mm.hi)));
  double reach_mm = kReachShare * PlaneFaces::kUsualTravel * face_mm;
  std::uint64_t programs = 0;
  for (;;) {
    SharpSearch search(query, reach_mm);
    SharpDecision result = search.run();
    result.programs += programs;
    const double needed_mm = search.needed_reach_mm();
    if (result.state != SharpDecision::State::kTooSharp ||
        needed_mm > PlaneFaces::kMostTravel * face_mm) {
      check(query, result);
      return result;
    }
    programs = result.programs;
    reach_mm = kReachShare * needed_mm;
  }
}

}  // namespace mortise
