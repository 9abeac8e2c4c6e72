#pragma once
/// \file
/// Questions about two parts: how far apart, when they touch, whether their collision is real. No
/// function keeps state: any number of threads may ask at once.
#include <limits>

#include <mortise/geometry.h>

namespace mortise::api {

/// kFake: no admissible pair of real parts interferes. kReal: every pair does. kPotential: the
/// rest. kNone: nothing to report. After Shi et al. 2013, see common/evaluation.
enum class CollisionClass : std::uint8_t { kNone = 0, kFake = 1, kPotential = 2, kReal = 3 };

/// "none", "fake", "potential", "real".
std::string name_of(CollisionClass value);

/// A motion that takes a pair apart: the part turns about a point and shifts, both at constant
/// speed.
struct WayOut {
  std::string part;                    ///< that moves; the other one stays
  Vec3 translation_mm = Vec3::Zero();  ///< in W
  Vec3 rotation_rad = Vec3::Zero();    ///< rotation vector in W
  Vec3 about_W_mm = Vec3::Zero();      ///< the point of the part about which it turns
  std::string way;      ///< "along the normal", "along the axis", "turned and shifted" ...
  std::string path;     ///< "not asked", "free", "goes deeper" or "blocked"
  std::string blocker;  ///< of "blocked": the part that is met first
};

/// The judged collision of one place of two parts. Lengths in mm, world frame.
struct Clash {
  std::uint32_t id = 0;  ///< in a session: the same as long as the clash lasts; else 0
  std::string part_a;    ///< name of A
  std::string part_b;    ///< name of B
  CollisionClass collision_class = CollisionClass::kNone;  ///< the judgement
  /// Overlap of the meshes; negative: apart. real: lo > real_above_mm; fake: hi <= fake_up_to_mm.
  /// The bracket is refined only until the class is decided (JudgeOptions::full: to 1e-4 mm).
  Interval depth_mm;
  Interval way_out_mm;         ///< generalized penetration depth; hi infinite: no way was found
  double fake_up_to_mm = 0.0;  ///< threshold below which no admissible pair interferes
  double real_above_mm = 0.0;  ///< threshold above which every admissible pair does
  double margin_mm = 0.0;      ///< of the depth to the nearest threshold, >= 0
  std::optional<double> probability;  ///< P(interference), where the surfaces are known
  Vec3 point_W = Vec3::Zero();        ///< the deciding place
  Vec3 normal_W = Vec3::Zero();       ///< unit, from B to A
  double area_mm2 = 0.0;              ///< of the place
  std::optional<Vec3> witness_W;      ///< of a real one: a point inside both real parts
  std::optional<WayOut> way_out;      ///< none: not found
  std::string face_a;                 ///< feature of A that meets B; empty: none
  std::string face_b;                 ///< feature of B that meets A; empty: none
  std::string grade;                  ///< where the knowledge of the mesh error comes from
  std::string explanation;            ///< one sentence
};

/// How a pair is judged.
struct JudgeOptions {
  std::string fit = {};          ///< of hole and shaft, "H7/g6" or "Ø20 H7/g6"; empty: none
  Pose X_WA = Pose::Identity();  ///< where A stands
  Pose X_WB = Pose::Identity();  ///< where B stands
  bool full = false;             ///< refine every bracket to 1e-4 mm
  int threads = 1;               ///< 1 to 256; the answer does not depend on it
};

/// The places where parts meet or may meet.
struct Judgement {
  std::vector<Clash> clashes;      ///< pair by pair, the worst place of each first
  std::vector<std::string> notes;  ///< pairs that could not be examined, and why
  /// The document of `mortise judge --json` (schema: judge).
  std::string json;
  CollisionClass worst() const;  ///< of all places; kNone: nothing meets
};

/// Judges two parts where they stand, as `mortise judge A B` does, with the same bits. Fails on a
/// pose that is no finite rigid motion, a fit that is not known, and options out of range. Costs
/// recognition of both meshes (0.1 ms a triangle) and some ms a place.
Result<Judgement> judge(const Part& a, const Part& b, const JudgeOptions& options = {});

/// The nearest points of two parts.
struct Distance {
  double distance_mm = 0.0;       ///< of the meshes; 0: they touch or cross
  bool within_limit = true;       ///< false: farther than the limit, which is distance_mm then
  Vec3 point_a_W = Vec3::Zero();  ///< on A
  Vec3 point_b_W = Vec3::Zero();  ///< on B
};

/// Distance of two meshes, exact to rounding. A part wholly inside another one is as far as its
/// surface is. `limit_mm`: nothing beyond is of interest, which is faster. Fails on poses that are
/// none and on a negative limit. First call of a part builds its tree, O(m log m); then
/// microseconds.
Result<Distance> distance(const Part& a, const Part& b, const Pose& X_WA = Pose::Identity(),
                          const Pose& X_WB = Pose::Identity(),
                          double limit_mm = std::numeric_limits<double>::infinity());

/// The path of a part during t in [0, 1].
struct Motion {
  /// kLinear: the reference point moves straight, the part turns about it at constant speed.
  /// kScrew: the part turns about and slides along one axis.
  enum class Path : std::uint8_t { kLinear, kScrew };
  Pose X_W0 = Pose::Identity();          ///< start
  Pose X_W1 = Pose::Identity();          ///< end; less than half a turn from the start
  Path path = Path::kLinear;             ///< between them
  std::optional<Vec3> reference_P = {};  ///< none: the centre of the part's bounding sphere
};

/// How first contact is asked.
struct ContactOptions {
  Pose X_WB = Pose::Identity();  ///< where B stands still
  double accuracy_mm = 1e-6;     ///< distance that counts as contact, >= 0
  double separation_mm = 0.0;    ///< first time within this distance; 0: first touch
};

/// When two parts first touch. 0 <= t_clear <= t_contact <= 1.
struct FirstContact {
  /// kFree: no contact for any t. kContact: none before t_clear, and at t_contact within the
  /// accuracy. kUndecided: none before t_clear, nothing is said beyond (work limit).
  enum class State : std::uint8_t {
    kUndecided,
    kFree,
    kContact,
    kTouchingAtStart,
    kOverlappingAtStart
  };
  State state = State::kUndecided;  ///< the answer
  double t_clear = 0.0;             ///< proven clear up to here
  double t_contact = 1.0;           ///< of contact
  double distance_mm = 0.0;         ///< of the meshes at t_contact; free: a lower bound
  Vec3 point_a_W = Vec3::Zero();    ///< place on A
  Vec3 point_b_W = Vec3::Zero();    ///< place on B
};

/// "undecided", "free", "contact", "touching_at_start", "overlapping_at_start".
std::string name_of(FirstContact::State value);

/// First contact of A, which moves, with B, which stands. Never a miss, never late. Fails on poses
/// that are none, turns of half a turn or more, and options out of range. Some 10 µs to ms.
Result<FirstContact> first_contact(const Part& a, const Part& b, const Motion& motion,
                                   const ContactOptions& options = {});

}  // namespace mortise::api
