#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/io/log/session_log_read.h"
#include "common/io/scenario/scene_load.h"

namespace mortise {

/// The scene with which a logged session began: scenario and meshes from the log, no other file.
/// For a log that continues another one the world is that of its beginning. `log` must outlive the
/// call only.
Result<LoadedScene> scene_of(const SessionLog& log);
/// The same without what happened before the first tick of the log.
Result<LoadedScene> bare_scene_of(const SessionLog& log);

/// The scene after the last usable checkpoint of the log (whole, kept by the reader, of this
/// build), or else at the log's beginning.
struct SceneAtCheckpoint {
  LoadedScene scene;
  std::uint64_t tick = 0;  ///< of the world: later ticks are still to be computed
  bool from_checkpoint = false;
  std::vector<std::string> notes;  ///< which checkpoints were skipped, and why
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
  std::uint64_t idle_ticks = 0;      ///< computed between them; without input and so not logged
  std::uint64_t increments = 0, decisions = 0, events_compared = 0;
  std::uint64_t verified_to_tick = 0;      ///< every tick up to this one agrees
  std::uint64_t checkpoints_compared = 0;  ///< equal byte by byte to the state computed here
  std::optional<ReplayDifference> difference;
  std::string not_verifiable;  ///< why ticks after verified_to_tick could not be compared, or empty
  bool same_build = false;     ///< bit for bit agreement is promised
  bool bit_for_bit = true;     ///< how it was compared; false: within accuracy
  double largest_pose_off_mm = 0.0;  ///< of a moved part from the log, when within accuracy
  bool stopped = false;              ///< before its end, because it was asked to
};

/// A tick as it was computed again. `logged` is null for an idle one.
struct ReplayedTick {
  const World& world;  ///< after it
  const StepReport& computed;
  const TickRecord* logged;
};
using OnReplayedTick = std::function<void(const ReplayedTick&)>;

/// How closely a replay must agree with its log.
enum class Agreement : std::uint8_t {
  kBitForBit = 0,
  /// For a log of another build: the same refusals, the same events in the same order with the same
  /// classes and brackets of depth that meet, and poses within kOtherBuild_mm.
  kWithinAccuracy = 1,
};
/// As much as a part may be pressed deeper without being held (kDeepeningSlack_mm): what a replay
/// may differ by without another answer. Below the tolerances of ISO 286 from IT3 on.
inline constexpr double kOtherBuild_mm = 1e-3;
/// As closely as this build can promise: bit for bit for a log that it wrote itself.
Agreement agreement_to_ask(const SessionLog& log);

/// Computes a logged session again tick by tick in `world`, as scene_of(log) made it, and compares
/// refusals, events, state hashes and, on the build that wrote them, checkpoints. Ticks that the
/// world has already computed are skipped. Stops at the first difference and at the first gap,
/// because ticks after a gap cannot be computed, and where `stop`, asked after each tick, says so:
/// a log may name ticks without number. Fails when the log cannot be replayed at all.
Result<ReplayReport> replay(World& world, const SessionLog& log, int threads,
                            const OnReplayedTick& on_tick = {},
                            Agreement agreement = Agreement::kBitForBit,
                            const std::function<bool()>& stop = {});

/// The same without comparing: applies the log's decisions and increments to a changed world
/// (another policy, tolerance, mesh). Stops at the first gap and reports that.
struct Recomputation {
  std::uint64_t ticks = 0;    ///< idle ones included
  std::string stopped_early;  ///< why ticks of the log were left out, or empty
};
Result<Recomputation> recompute(World& world, const SessionLog& log, int threads,
                                const OnReplayedTick& on_tick);

/// Replay in a world of its own, as agreement_to_ask() says.
/// `on_tick` sees every computed tick, idle ones included, and the
/// world after it.
Result<ReplayReport> verify(
    const SessionLog& log, int threads,
    const std::function<void(const World&, const StepReport&)>& on_tick = {});

}  // namespace mortise
