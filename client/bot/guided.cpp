#include "client/bot/guided.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "client/bot/random.h"
#include "common/math/rotation.h"

namespace mortise {
namespace {

constexpr double kAnswer_s = 0.5;        // an answer takes a tick and a round trip; then ask again
constexpr double kGiveUp_s = 3.0;        // no part, or no constraint, in so long
constexpr double kSettle_s = 0.25;       // until what was sent last is seen
constexpr double kLongestBeat_s = 0.05;  // after a stall of the machine a part must not leap
constexpr double kSpeed_mm_s = 60.0;     // of a hand
constexpr double kAim_mm = 1.0, kAim_rad = 0.035;  // as well as a hand holds a part: 2 degrees
constexpr double kGap_mm = 2.0;                    // before the mouth of the bore
// Of the shorter of both: the last fifth may be a shoulder or a chamfer.
constexpr double kInserted_share = 0.8;
constexpr double kOffAxis_mm = 0.5;  // a part beside its bore is not in it
// No deeper by kProgress_mm for so long: a try has failed. A hand pushes several mm in that time.
constexpr double kStuck_s = 2.0, kProgress_mm = 0.05;
constexpr double kAlike = 0.02;  // radii of a fit differ by less, of the larger
constexpr double kEye = 0.1;     // share of what is seen wrong that a beat puts right

/// A round feature in the world: its middle, axis, and half length.
struct Round {
  Vec3 middle_W, axis_W;
  double half_mm = 0.0;
};

Round round_of(const KnownPart& part, const FeatureInfo& feature) {
  const Pose& X = part.info.X_WP;
  const Vec3 middle_P = feature.point_P + feature.along_mm.middle() * feature.axis_P;
  return {X * middle_P, X.q * feature.axis_P, 0.5 * feature.along_mm.width()};
}

/// Which part goes where, by its features.
struct Fit {
  PartId part, other;
  FeatureInfo shaft, bore;
  double lead_mm = 0.0;  ///< the part reaches so far beyond the shaft's half length, either way
};

bool may_fit(const FeatureInfo& shaft, const FeatureInfo& bore) {
  return shaft.kind == SurfaceKind::kCylinder && bore.kind == SurfaceKind::kCylinder &&
         !shaft.inward && bore.inward && shaft.along_mm.width() > 0.0 &&
         std::abs(shaft.radius_mm - bore.radius_mm) <= kAlike * bore.radius_mm;
}

// How far the part reaches along the axis of its shaft beyond it, by what else is round or flat
// about that axis.
double lead_of(std::span<const FeatureInfo> features, const FeatureInfo& shaft) {
  const double middle_mm = shaft.along_mm.middle();
  double reach_mm = 0.5 * shaft.along_mm.width();
  for (const FeatureInfo& f : features) {
    const double along = f.axis_P.dot(shaft.axis_P);
    if (std::abs(along) < 0.999) continue;
    const double at_mm = (f.point_P - shaft.point_P).dot(shaft.axis_P);
    for (const double end_mm : {f.along_mm.lo, f.along_mm.hi})
      reach_mm = std::max(reach_mm, std::abs(at_mm + along * end_mm - middle_mm));
  }
  return reach_mm - 0.5 * shaft.along_mm.width();
}

class Guided : public Behaviour {
 public:
  explicit Guided(const GuidedSettings& settings) : settings_(settings), random_(settings.seed) {}

  Wish beat(const View& view) override {
    Wish wish;
    if (count_.tries >= settings_.tries || given_up_) {
      wish.done = true;
      return wish;
    }
    if (!fit_ && !choose(view)) return wish;
    const KnownPart *part = view.find(fit_->part), *other = view.find(fit_->other);
    if (part == nullptr || other == nullptr) return wish;
    if (stage_ != Stage::kGrab && !view.holds(fit_->part)) begin(Stage::kGrab, view);
    switch (stage_) {
      case Stage::kGrab:
        grab(view, wish);
        break;
      case Stage::kPutBack:
        if (passed_s(view) >= kSettle_s) aim(view, *part, *other);
        break;
      case Stage::kApproach:
        approach(view, wish);
        break;
      case Stage::kAlign:
        align(view, *part, *other, wish);
        break;
      case Stage::kPush:
        push(view, *part, *other, wish);
        break;
      case Stage::kLetGo:
        wish.release = fit_->part;
        begin(Stage::kGrab, view);
        break;
    }
    return wish;
  }
  const std::vector<std::string>& troubles() const override { return troubles_; }
  const Insertions* insertions() const override { return &count_; }

 private:
  enum class Stage { kGrab, kPutBack, kApproach, kAlign, kPush, kLetGo };

  void begin(Stage stage, const View& view) {
    stage_ = stage;
    begun_s_ = view.time_s;
    asked_s_ = -1e9;
  }
  double passed_s(const View& view) const { return view.time_s - begun_s_; }
  bool may_ask(const View& view) {
    if (view.time_s - asked_s_ < kAnswer_s) return false;
    asked_s_ = view.time_s;
    return true;
  }

  // Of each moving part the nearest bore that its shafts fit; of those parts the one of our number.
  bool choose(const View& view) {
    if (begun_s_ < 0.0) begun_s_ = view.time_s;
    std::vector<Fit> fits;
    if (view.features != nullptr)
      for (const auto& [id, part] : *view.parts)
        if (part.info.moving && (!settings_.only || settings_.only == id))
          add_nearest(view, part, fits);
    if (!fits.empty()) {
      fit_ = fits[settings_.first % fits.size()];
      begin(Stage::kGrab, view);
      return true;
    }
    const bool more_to_come = view.features != nullptr && view.features->meshes_waiting() > 0;
    if (passed_s(view) > kGiveUp_s && !more_to_come) {
      troubles_.push_back("no moving part has a shaft that fits a bore of another");
      given_up_ = true;
    }
    return false;
  }
  void add_nearest(const View& view, const KnownPart& part, std::vector<Fit>& fits) const {
    std::optional<Fit> nearest;
    double least_mm = 0.0;
    for (const auto& [id, other] : *view.parts) {
      if (id == part.info.part || (settings_.target && settings_.target != id)) continue;
      for (const FeatureInfo& shaft : view.features->of(part.info.part))
        for (const FeatureInfo& bore : view.features->of(id)) {
          if (!may_fit(shaft, bore)) continue;
          const double away_mm =
              (round_of(part, shaft).middle_W - round_of(other, bore).middle_W).norm();
          if (nearest && away_mm >= least_mm) continue;
          least_mm = away_mm;
          nearest = Fit{part.info.part, id, shaft, bore, 0.0};
        }
    }
    if (!nearest) return;
    nearest->lead_mm = lead_of(view.features->of(part.info.part), nearest->shaft);
    fits.push_back(*nearest);
  }

  void grab(const View& view, Wish& wish) {
    // What the view says may be older than our release.
    if (view.holds(fit_->part) && passed_s(view) >= kSettle_s) {
      wish.asks.push_back({CommandKind::kReset, fit_->part});
      begin(Stage::kPutBack, view);
    } else if (!view.holds(fit_->part) && may_ask(view)) {
      wish.grab = fit_->part;
    }
  }

  // The way to a place before the mouth: back along the axis if need be, then across, turning.
  void aim(const View& view, const KnownPart& part, const KnownPart& other) {
    const Round shaft = round_of(part, fit_->shaft), bore = round_of(other, fit_->bore);
    const Vec3 apart = shaft.middle_W - bore.middle_W;
    out_W_ = apart.dot(bore.axis_W) < 0.0 ? Vec3(-bore.axis_W) : bore.axis_W;
    const Vec3 axis_W = shaft.axis_W.dot(out_W_) < 0.0 ? Vec3(-shaft.axis_W) : shaft.axis_W;
    turn_ = rotation_log(Quat::FromTwoVectors(axis_W, out_W_)) + random_.in_cube(kAim_rad);
    const Vec3 centre_W = part.info.X_WP * part.info.reference_P;
    const Vec3 turned_W = centre_W + rotation_exp(turn_) * (shaft.middle_W - centre_W);
    const double high_mm = bore.half_mm + shaft.half_mm + fit_->lead_mm + kGap_mm;
    const Vec3 way = bore.middle_W + high_mm * out_W_ - turned_W + random_.in_cube(kAim_mm);
    const double up_mm = way.dot(out_W_);
    legs_[0] = std::max(up_mm, 0.0) * out_W_;
    legs_[1] = way - up_mm * out_W_;
    legs_[2] = std::min(up_mm, 0.0) * out_W_;
    leg_ = 0;
    gone_ = 0.0;
    begin(Stage::kApproach, view);
  }

  void approach(const View& view, Wish& wish) {
    if (leg_ == 3) {
      if (passed_s(view) >= kSettle_s) begin(Stage::kAlign, view);
      return;
    }
    const double length_mm = std::max(legs_[leg_].norm(), leg_ == 1 ? 50.0 * turn_.norm() : 0.0);
    const double step_mm = kSpeed_mm_s * 3.0 * std::min(view.beat_s, kLongestBeat_s);
    const double share = length_mm > 0.0 ? std::min(step_mm / length_mm, 1.0 - gone_) : 1.0 - gone_;
    wish.move = fit_->part;
    wish.translation_mm = share * legs_[leg_];
    if (leg_ == 1) wish.rotation_rad = share * turn_;
    gone_ += share;
    if (gone_ < 1.0 - 1e-9) return;
    gone_ = 0.0;
    if (++leg_ == 3) begun_s_ = view.time_s;
  }

  bool is_aligned(const View& view) const {
    return view.standing != nullptr &&
           std::any_of(view.standing->begin(), view.standing->end(), [&](const Decision& d) {
             return d.kind == Decision::Kind::kAddConstraint && d.part == fit_->part &&
                    d.user == view.self;
           });
  }

  void align(const View& view, const KnownPart& part, const KnownPart& other, Wish& wish) {
    if (settings_.free_hand || is_aligned(view)) {
      deepest_mm_ = inside_mm(part, other);
      deeper_s_ = view.time_s;
      tremor_ = {};
      begin(Stage::kPush, view);
    } else if (passed_s(view) > kGiveUp_s) {
      ++count_.tries;
      ++count_.not_aligned;
      begin(Stage::kLetGo, view);
    } else if (may_ask(view)) {
      Details details;
      details.constraint = {ConstraintKind::kCoaxial,
                            {fit_->part, fit_->shaft.name},
                            {fit_->other, fit_->bore.name},
                            0.0,
                            true};
      wish.asks.push_back({CommandKind::kSnap, fit_->part, std::move(details)});
    }
  }

  void push(const View& view, const KnownPart& part, const KnownPart& other, Wish& wish) {
    const double inside = inside_mm(part, other);
    const Round shaft = round_of(part, fit_->shaft), bore = round_of(other, fit_->bore);
    if (inside >= kInserted_share * 2.0 * std::min(shaft.half_mm, bore.half_mm)) {
      ++count_.tries;
      ++count_.inserted;
      count_.seconds.push_back(passed_s(view));
      begin(Stage::kLetGo, view);
      return;
    }
    if (inside > deepest_mm_ + kProgress_mm) {
      deepest_mm_ = inside;
      deeper_s_ = view.time_s;
    }
    if (view.time_s - deeper_s_ > kStuck_s) {
      ++count_.tries;
      ++count_.stuck;
      begin(Stage::kLetGo, view);
      return;
    }
    Offset tremor{random_.in_cube(settings_.tremor_mm), random_.in_cube(settings_.tremor_rad)};
    wish.move = fit_->part;
    wish.translation_mm = tremor.translation_mm - tremor_.translation_mm -
                          kSpeed_mm_s * std::min(view.beat_s, kLongestBeat_s) * out_W_;
    wish.rotation_rad = tremor.rotation_rad - tremor_.rotation_rad;
    tremor_ = tremor;
    if (!settings_.free_hand) return;
    const Vec3 apart = bore.middle_W - shaft.middle_W;
    wish.translation_mm += kEye * (apart - apart.dot(out_W_) * out_W_);
    const Vec3 axis_W = shaft.axis_W.dot(out_W_) < 0.0 ? Vec3(-shaft.axis_W) : shaft.axis_W;
    wish.rotation_rad += kEye * axis_W.cross(out_W_);
  }

  // Length of the shaft that lies in the bore, negative: of the gap between them.
  double inside_mm(const KnownPart& part, const KnownPart& other) const {
    const Round shaft = round_of(part, fit_->shaft), bore = round_of(other, fit_->bore);
    const Vec3 apart = shaft.middle_W - bore.middle_W;
    const double along_mm = apart.dot(bore.axis_W);
    const double across_mm = (apart - along_mm * bore.axis_W).norm();
    const double inside = std::min({shaft.half_mm + bore.half_mm - std::abs(along_mm),
                                    2.0 * shaft.half_mm, 2.0 * bore.half_mm});
    return across_mm > kOffAxis_mm ? std::min(inside, 0.0) : inside;
  }

  GuidedSettings settings_;
  Random random_;
  Insertions count_;
  std::vector<std::string> troubles_;
  std::optional<Fit> fit_;
  Stage stage_ = Stage::kGrab;
  bool given_up_ = false;
  double begun_s_ = -1.0, asked_s_ = -1e9;
  Vec3 out_W_ = Vec3::Zero();  ///< unit, from the bore to where the part comes from
  Vec3 turn_ = Vec3::Zero();
  Vec3 legs_[3];
  int leg_ = 0;
  double gone_ = 0.0;  ///< of this leg, 0..1
  Offset tremor_;
  double deepest_mm_ = 0.0, deeper_s_ = 0.0;
};

}  // namespace

std::unique_ptr<Behaviour> make_guided(const GuidedSettings& settings) {
  return std::make_unique<Guided>(settings);
}

}  // namespace mortise
