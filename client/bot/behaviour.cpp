#include "client/bot/behaviour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "client/bot/guided.h"
#include "client/bot/people.h"
#include "client/bot/random.h"

namespace mortise {
namespace {

constexpr double kRegrab_s = 0.5;        // an answer takes a tick and a round trip; then ask again
constexpr double kGiveUpAct_s = 5.0;     // a part that stays in other hands so long is left to them
constexpr double kLongestBeat_s = 0.05;  // after a stall of the machine a part must not leap: its
                                         // path goes on from where it was

/// Towards the nearest other part and back again, as one tries whether a part fits.
class InsertPath : public Path {
 public:
  void begin(const View& view, const KnownPart& part) override {
    const Vec3 here = part.info.X_WP * part.info.reference_P;
    double nearest = 0.0;
    way_ = Vec3(0.0, 0.0, -part.info.radius_mm);  // alone in the session: down
    for (const auto& [id, other] : *view.parts) {
      if (id == part.info.part) continue;
      const Vec3 there = other.info.X_WP * other.info.reference_P;
      const double distance = (there - here).norm();
      if (distance > 0.0 && (nearest == 0.0 || distance < nearest)) {
        nearest = distance;
        way_ = there - here;
      }
    }
  }
  Offset at(double held_s) const override {
    const double phase = 2.0 * std::numbers::pi * held_s / kPeriod_s;
    return {way_ * (0.5 - 0.5 * std::cos(phase)), Vec3::Zero()};
  }

 private:
  // There and back: as long as a person takes to try a fit.
  static constexpr double kPeriod_s = 4.0;
  Vec3 way_ = Vec3::Zero();
};

/// A sum of slow or fast swings of random direction, speed and phase; begins at zero.
class SwingPath : public Path {
 public:
  struct Settings {
    double amplitude_radii, amplitude_rad, slowest_hz, fastest_hz;
  };
  SwingPath(std::uint64_t seed, const Settings& settings) : settings_(settings), random_(seed) {}

  void begin(const View&, const KnownPart& part) override {
    radius_mm_ = part.info.radius_mm;
    for (Swing& swing : swings_) {
      swing.direction = random_.in_cube(1.0);
      swing.turn = random_.in_cube(1.0);
      swing.rad_per_s =
          2.0 * std::numbers::pi * random_.uniform(settings_.slowest_hz, settings_.fastest_hz);
      swing.phase = random_.uniform(0.0, 2.0 * std::numbers::pi);
    }
  }
  Offset at(double held_s) const override {
    Offset offset;
    for (const Swing& swing : swings_) {
      const double s = std::sin(swing.phase + swing.rad_per_s * held_s) - std::sin(swing.phase);
      offset.translation_mm +=
          swing.direction * (s * settings_.amplitude_radii * radius_mm_ / kSwings);
      offset.rotation_rad += swing.turn * (s * settings_.amplitude_rad / kSwings);
    }
    return offset;
  }

 private:
  // Three swings of unlike periods: their sum does not repeat within a test.
  static constexpr int kSwings = 3;
  struct Swing {
    Vec3 direction = Vec3::Zero(), turn = Vec3::Zero();
    double rad_per_s = 0.0, phase = 0.0;
  };
  Settings settings_;
  mutable Random random_;
  std::array<Swing, kSwings> swings_;
  double radius_mm_ = 0.0;
};

// Wandering crosses half the neighbourhood in seconds; shaking is a hand that trembles.
constexpr SwingPath::Settings kWander{1.5, 0.8, 0.05, 0.2};
constexpr SwingPath::Settings kShake{0.05, 0.05, 3.0, 8.0};

/// The increment from one offset to the next. Rotation vectors about a fixed start are not simply
/// subtracted; for the small steps of a beat the difference is what a device would send.
void move_by(Wish& wish, PartId part, const Offset& from, const Offset& to) {
  wish.move = part;
  wish.translation_mm = to.translation_mm - from.translation_mm;
  wish.rotation_rad = to.rotation_rad - from.rotation_rad;
}

}  // namespace

const std::vector<std::string>& Behaviour::troubles() const {
  static const std::vector<std::string> kNone;
  return kNone;
}

Carrier::Carrier(const Settings& settings, std::unique_ptr<Path> path)
    : settings_(settings), path_(std::move(path)) {}

PartId Carrier::choose(const View& view) const {
  if (settings_.only) return settings_.only;
  std::vector<PartId> moving;
  for (const auto& [id, part] : *view.parts) {
    if (part.info.moving) moving.push_back(id);
  }
  if (moving.empty()) return PartId{};
  return moving[(settings_.first + (settings_.stubborn ? 0 : attempt_)) % moving.size()];
}

Wish Carrier::beat(const View& view) {
  Wish wish;
  if (holding_ && !view.holds(part_)) holding_ = false;  // lease over, or released
  if (!holding_ && part_ && view.holds(part_)) {
    holding_ = true;
    held_s_ = 0.0;
    path_->begin(view, *view.find(part_));
    last_ = path_->at(0.0);
    return wish;
  }
  if (!holding_) {
    if (view.time_s - asked_s_ < std::max(settings_.pause_s, kRegrab_s)) return wish;
    if (part_) ++attempt_;
    part_ = choose(view);
    asked_s_ = view.time_s;
    wish.grab = part_;
    return wish;
  }
  held_s_ += std::min(view.beat_s, kLongestBeat_s);
  if (held_s_ >= settings_.hold_s) {
    wish.release = part_;
    holding_ = false;
    part_ = PartId{};
    asked_s_ = view.time_s;
    return wish;
  }
  const Offset next = path_->at(held_s_);
  move_by(wish, part_, last_, next);
  last_ = next;
  return wish;
}

Script::Script(const Play& play, const std::string& user) {
  for (const Play::Act& act : play.acts) {
    if (act.user == user) acts_.push_back(act);
  }
}

Offset Script::offset_at(const Play::Act& act, double held_s) const {
  Offset offset;
  for (const Play::Step& step : act.steps) {
    const double share = std::clamp(held_s / step.seconds, 0.0, 1.0);
    offset.translation_mm += step.by_mm * share;
    offset.rotation_rad += step.rotate_rad * share;
    held_s -= step.seconds;
    if (held_s <= 0.0) break;
  }
  return offset;
}

Wish Script::beat(const View& view) {
  Wish wish;
  if (act_ >= acts_.size()) {
    wish.done = true;
    return wish;
  }
  const Play::Act& act = acts_[act_];
  if (view.time_s < act.at_s) return wish;
  const auto next_act = [&] {
    ++act_;
    holding_ = false;
    first_asked_s_ = -1.0;
    asked_s_ = -1e9;
  };
  PartId part;
  for (const auto& [id, known] : *view.parts) {
    if (known.info.name == act.part) part = id;
  }
  if (!part) {
    troubles_.push_back("no part '" + act.part + "' in the session");
    next_act();
    return wish;
  }
  // Each act asks anew: what the view says may be older than the release of the act before.
  if (!view.holds(part) || first_asked_s_ < 0.0) {
    if (first_asked_s_ < 0.0) first_asked_s_ = view.time_s;
    if (view.time_s - first_asked_s_ > kGiveUpAct_s) {
      troubles_.push_back("'" + act.part + "' was not given to " + act.user);
      next_act();
    } else if (view.time_s - asked_s_ >= kRegrab_s) {
      asked_s_ = view.time_s;
      wish.grab = part;
    }
    return wish;
  }
  if (!holding_) {
    holding_ = true;
    held_s_ = 0.0;
    last_ = Offset{};
  }
  double whole_s = 0.0;
  for (const Play::Step& step : act.steps) whole_s += step.seconds;
  held_s_ += std::min(view.beat_s, kLongestBeat_s);
  const Offset next = offset_at(act, held_s_);
  move_by(wish, part, last_, next);
  last_ = next;
  if (held_s_ >= whole_s) {
    if (act.release) wish.release = part;
    next_act();
  }
  return wish;
}

namespace {

/// One after another insert, wander and shake, each for a while: with more users than parts every
/// part goes from hand to hand.
std::unique_ptr<Behaviour> mixed(const BehaviourSpec& spec, std::uint64_t seed,
                                 Carrier::Settings settings) {
  Random random(seed);
  settings.hold_s = random.uniform(1.0, 3.0);
  if (spec.index % 3 == 0) {
    return std::make_unique<Carrier>(settings, std::make_unique<InsertPath>());
  }
  return std::make_unique<Carrier>(
      settings, std::make_unique<SwingPath>(seed, spec.index % 3 == 1 ? kWander : kShake));
}

}  // namespace

const std::vector<std::string>& behaviour_names() {
  static const std::vector<std::string> kNames{"insert", "wander", "shake", "fight",  "share",
                                               "revise", "review", "mixed", "guided", "script"};
  return kNames;
}

std::unique_ptr<Behaviour> make_behaviour(const BehaviourSpec& spec) {
  // Users of one bot differ by index, bots by seed.
  const std::uint64_t seed = spec.seed * 0x9e3779b97f4a7c15ULL + spec.index;
  Carrier::Settings settings;
  settings.first = spec.index;
  settings.only = spec.part;
  if (spec.kind == "script") return std::make_unique<Script>(*spec.play, spec.user);
  if (spec.kind == "insert") {
    return std::make_unique<Carrier>(settings, std::make_unique<InsertPath>());
  }
  if (spec.kind == "share") {
    return make_share({spec.part, 0.5, spec.index % 2 == 1},
                      std::make_unique<SwingPath>(seed, kWander));
  }
  if (spec.kind == "revise") {
    return make_revise(spec.index, spec.part, std::make_unique<SwingPath>(seed, kWander));
  }
  if (spec.kind == "review") {
    return make_reviewer(std::make_unique<Carrier>(settings, std::make_unique<InsertPath>()));
  }
  if (spec.kind == "guided") {
    GuidedSettings guided = spec.guided;
    guided.first = spec.index;
    guided.only = spec.part;
    guided.seed = seed;
    return make_guided(guided);
  }
  if (spec.kind == "shake") {
    return std::make_unique<Carrier>(settings, std::make_unique<SwingPath>(seed, kShake));
  }
  if (spec.kind == "mixed") return mixed(spec, seed, settings);
  if (spec.kind == "fight") {
    Random random(seed);
    settings.hold_s = random.uniform(0.5, 1.5);
    settings.first = 0;  // all want the same part
    settings.stubborn = true;
  }
  return std::make_unique<Carrier>(settings, std::make_unique<SwingPath>(seed, kWander));
}

}  // namespace mortise
