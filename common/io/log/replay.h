#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/io/log/session_log.h"
#include "common/io/scenario/scene_load.h"

namespace mortise {

/// The scene with which a logged session began: scenario and meshes from the log, no other file.
/// Of a log that goes on where another ended, the world stands as at its beginning. `log` must
/// outlive the call only.
Result<LoadedScene> scene_of(const SessionLog& log);
/// The same without what happened before the log's first tick.
Result<LoadedScene> bare_scene_of(const SessionLog& log);

/// The scene as it stood after the last checkpoint of the log that is of use: whole, kept by the
/// reader, of this build; else as at the log's beginning.
struct SceneAtCheckpoint {
  LoadedScene scene;
  std::uint64_t tick = 0;  ///< of the world: later ticks are still to be computed
  bool from_checkpoint = false;
  std::vector<std::string> notes;  ///< which checkpoints were passed over, and why
};
Result<SceneAtCheckpoint> scene_at_last_checkpoint(const SessionLog& log);

/// The first place where a replay and its log disagree.
struct ReplayDifference {
  std::uint64_t tick = 0;
  std::string what;  ///< "state hash: logged ..., computed ...; part shaft is 0.1 mm away"
};

struct ReplayReport {
  std::uint64_t ticks_logged = 0;
  std::uint64_t ticks_compared = 0;  ///< of these
  std::uint64_t idle_ticks = 0;      ///< computed between them: not logged, since nothing went in
  std::uint64_t increments = 0, decisions = 0, events_compared = 0;
  std::uint64_t verified_to_tick = 0;      ///< every tick up to this one agrees
  std::uint64_t checkpoints_compared = 0;  ///< each of the same bytes as the state computed here
  std::optional<ReplayDifference> difference;
  std::string not_verifiable;  ///< why ticks after verified_to_tick could not be compared, or empty
  bool same_build = false;     ///< bit for bit agreement is promised
  bool bit_for_bit = true;     ///< that is how it was compared; else within accuracy
  double largest_pose_off_mm = 0.0;  ///< of a moved part against the log, where that is how
};

/// A tick as it was computed again. `logged` is null for an idle one.
struct ReplayedTick {
  const World& world;  ///< after it
  const StepReport& computed;
  const TickRecord* logged;
};
using OnReplayedTick = std::function<void(const ReplayedTick&)>;

/// How closely a replay is held to its log.
enum class Agreement : std::uint8_t {
  kBitForBit = 0,
  /// For a log of another build: the same refusals, the same events in the same order with the same
  /// classes and brackets of depth that meet, and poses within kOtherBuild_mm.
  kWithinAccuracy = 1,
};
inline constexpr double kOtherBuild_mm = 1e-3;

/// Computes a logged session again in `world`, which stands as scene_of(log) made it, tick by tick,
/// and compares refusals, events, state hashes and, on the build that wrote them, checkpoints.
/// Ticks that the world has behind it already are passed over. Stops at the first difference, and
/// at the first gap: what was lost there cannot be computed. Fails when the log cannot be replayed
/// at all.
Result<ReplayReport> replay(World& world, const SessionLog& log, int threads,
                            const OnReplayedTick& on_tick = {},
                            Agreement agreement = Agreement::kBitForBit);

/// The same without comparing: what the log's decisions and increments come to in a world that is
/// not as it was (another policy, tolerance, mesh). Stops at the first gap, and says so.
struct Recomputation {
  std::uint64_t ticks = 0;    ///< idle ones included
  std::string stopped_early;  ///< why ticks of the log were left out, or empty
};
Result<Recomputation> recompute(World& world, const SessionLog& log, int threads,
                                const OnReplayedTick& on_tick);

/// Replay in a world of its own: bit for bit on the build that wrote the log, else within accuracy.
/// `on_tick` sees every computed tick, idle ones included, and the
/// world after it.
Result<ReplayReport> verify(
    const SessionLog& log, int threads,
    const std::function<void(const World&, const StepReport&)>& on_tick = {});

}  // namespace mortise
