#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "client/client.h"
#include "common/io/scenario/play_file.h"

namespace mortise {

/// What a designer sees when it is time for the next increment.
struct View {
  double time_s = 0.0;  ///< since the acts began
  double beat_s = 0.0;  ///< since the last beat: the time that an increment covers
  UserId self;
  const std::map<PartId, KnownPart>* parts = nullptr;
  const std::map<ClashId, ClashEvent>* clashes = nullptr;  ///< that are open; may be null
  const std::vector<Decision>* standing = nullptr;         ///< open requests; may be null
  const KnownFeatures* features = nullptr;                 ///< may be null

  const KnownPart* find(PartId part) const {
    const auto at = parts->find(part);
    return at == parts->end() ? nullptr : &at->second;
  }
  bool holds(PartId part) const {
    const KnownPart* known = find(part);
    return known != nullptr && self && known->info.holder == self;
  }
};

/// What a designer does at one beat. Every field may be empty.
struct Wish {
  PartId grab, release;
  PartId move;  ///< the part of the increment
  Vec3 translation_mm = Vec3::Zero(), rotation_rad = Vec3::Zero();
  bool done = false;  ///< nothing more will come
  /// Other commands, after the grab and the increment, before the release.
  struct Ask {
    CommandKind kind = CommandKind::kUnknown;
    PartId part;
    Details details = {};
  };
  std::vector<Ask> asks;
};

/// Attempts to put a shaft into a bore.
struct Insertions {
  std::uint64_t tries = 0, inserted = 0;
  std::uint64_t not_aligned = 0;  ///< no constraint was set
  std::uint64_t stuck = 0;        ///< it went no further
  std::vector<double> seconds;    ///< of those inserted, from the first push
};

/// Settings of the behaviour `guided`.
struct GuidedSettings {
  std::size_t first = 0;  ///< number of the moving part, of those that fit somewhere
  PartId only, target;    ///< the part; the part with the bore. None: which fit, the nearest
  std::uint64_t seed = 1;
  std::uint64_t tries = 10;
  double tremor_mm = 0.2, tremor_rad = 0.5 * 3.14159265358979323846 / 180.0;  ///< largest, each way
  bool free_hand = false;  ///< without a constraint, by eye
};

/// A designer without hands. The same seed and view give the same wishes.
class Behaviour {
 public:
  virtual ~Behaviour() = default;
  virtual Wish beat(const View& view) = 0;
  /// What failed, in words.
  virtual const std::vector<std::string>& troubles() const;
  /// The outcome of attempts to insert a part; null for other behaviours.
  virtual const Insertions* insertions() const { return nullptr; }
};

/// How a part is moved while it is held: the offset from where it was grabbed, as a function of the
/// time since then. Pure.
struct Offset {
  Vec3 translation_mm = Vec3::Zero(), rotation_rad = Vec3::Zero();
};
class Path {
 public:
  virtual ~Path() = default;
  /// Called once for each grab, with the part and all others at that time.
  virtual void begin(const View& view, const KnownPart& part) = 0;
  virtual Offset at(double held_s) const = 0;
};

/// Grabs a part (beginning with number `first` of the moving ones, going on to the next when it is
/// refused), leads it along a path for `hold_s`, releases it and begins again. A part that is
/// pushed back stays where the server leaves it; the next increments continue from there.
class Carrier : public Behaviour {
 public:
  struct Settings {
    std::size_t first = 0;
    PartId only;            ///< this part and no other
    bool stubborn = false;  ///< asks for the same part again, however often it is refused
    double hold_s = 1e9;
    double pause_s = 0.3;  ///< between two attempts to grab
  };
  Carrier(const Settings& settings, std::unique_ptr<Path> path);
  Wish beat(const View& view) override;

 private:
  PartId choose(const View& view) const;

  Settings settings_;
  std::unique_ptr<Path> path_;
  PartId part_;
  std::size_t attempt_ = 0;
  double asked_s_ = -1e9, held_s_ = 0.0;
  bool holding_ = false;
  Offset last_;
};

/// Plays the acts of one user.
class Script : public Behaviour {
 public:
  Script(const Play& play, const std::string& user);
  Wish beat(const View& view) override;
  const std::vector<std::string>& troubles() const override { return troubles_; }

 private:
  Offset offset_at(const Play::Act& act, double held_s) const;

  std::vector<Play::Act> acts_;
  std::size_t act_ = 0;
  double asked_s_ = -1e9, first_asked_s_ = -1.0, held_s_ = 0.0;
  bool holding_ = false;
  Offset last_;
  std::vector<std::string> troubles_;
};

struct BehaviourSpec {
  std::string kind;  ///< one of behaviour_names()
  std::string user;
  std::size_t index = 0;  ///< of the user in the bot
  std::uint64_t seed = 1;
  PartId part;                 ///< none: by index
  const Play* play = nullptr;  ///< of script
  GuidedSettings guided = {};  ///< of guided; first, only and seed are those above
};
const std::vector<std::string>& behaviour_names();
std::unique_ptr<Behaviour> make_behaviour(const BehaviourSpec& spec);

}  // namespace mortise
