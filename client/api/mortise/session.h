#pragma once
/// \file
/// A session in this process: parts that users hold and push, each collision judged.
#include <mortise/judge.h>

namespace mortise::api {

/// A part of a session; 0: none.
struct PartRef {
  std::uint32_t value = 0;                               ///< 1, 2, 3 ... in the order of add()
  explicit operator bool() const { return value != 0; }  ///< is there one?
};

/// Settings of a session.
struct SessionOptions {
  /// What happens at a real contact. stop: the part stops there. slide: it goes on along the
  /// contact. report: it is only told.
  std::string policy = "stop";
  double max_jump_mm = 50.0;  ///< longest shift of one push, > 0
  int threads = 1;            ///< 1 to 256; the answers do not depend on it
};

/// What one push did.
struct Pushed {
  Status status;                 ///< failed: nothing moved
  Pose X_WP = Pose::Identity();  ///< where the part stands now
  std::vector<Clash> clashes;    ///< open ones of the part, the worst first
  std::uint64_t state_hash = 0;  ///< of the whole session: the same pushes give the same
};

/// A session of parts. Made call by call: what fails leaves its reason in status(), and everything
/// after it fails with that reason. One thread at a time; several sessions are independent.
class Session {
 public:
  /// A session without parts. Options out of range are told by the first call that needs them.
  explicit Session(const SessionOptions& options = {});
  Session(Session&&) noexcept;             ///< the other one is empty then
  Session& operator=(Session&&) noexcept;  ///< the other one is empty then
  ~Session();

  /// Adds a part, which may move. `part` may be the result of load(). Names must differ: a second
  /// "pin" becomes "pin_2".
  PartRef add(const Result<Part>& part, const Pose& X_WP = Pose::Identity());
  /// The same for one that stands.
  PartRef add_fixed(const Result<Part>& part, const Pose& X_WP = Pose::Identity());

  /// States a fit, "H7/g6" or "Ø20 H7/g6", or a clearance "±0.05", of two features; an empty
  /// feature: of the whole parts.
  Status fit(PartRef a, const std::string& feature_a, PartRef b, const std::string& feature_b,
             const std::string& code);
  /// States a tolerance of a feature ("±0.02", "H7", "{profile: 0.1}"); an empty feature: of the
  /// whole part.
  Status tolerance(PartRef part, const std::string& feature, const std::string& text);
  /// The pair is never judged.
  Status exclude(PartRef a, PartRef b, const std::string& reason);

  /// Gives a part to a user, who joins with the first call. Only held parts can be pushed.
  Status hold(const std::string& user, PartRef part);
  Status release(PartRef part);  ///< nobody holds it any more
  /// Puts a part somewhere without a motion; what it meets there is judged with the next push.
  Status place(PartRef part, const Pose& X_WP);

  /// Pushes a held part: X_WP becomes dX_W * X_WP (Eq. (1) of Shi et al. 2013), as far as the
  /// policy lets it. The turn is less than half a turn. One tick: microseconds where nothing is
  /// near, some ms a place where parts meet.
  Pushed push(PartRef part, const Pose& dX_W);

  /// Judges all pairs where they stand. Moves nothing.
  Result<Judgement> judge(bool full = false);

  const Status& status() const;                 ///< the first failure
  std::vector<Clash> clashes() const;           ///< all open ones, the worst first
  Pose pose(PartRef part) const;                ///< X_WP; identity of no part
  std::string name(PartRef part) const;         ///< as it is called here; empty of no part
  PartRef find(const std::string& name) const;  ///< none: unknown

  struct Impl;  ///< private

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace mortise::api
