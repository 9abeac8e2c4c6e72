#pragma once
#include <deque>
#include <functional>
#include <future>
#include <string>
#include <vector>

#include "common/io/log/session_log.h"
#include "common/messages/channel.h"
#include "common/session/tick/statistics.h"
#include "common/session/tick/step.h"
#include "common/session/world/part_shapes.h"
#include "common/session/world/world.h"
#include "server/tick_bytes.h"
#include "server/tick_recorder.h"

namespace mortise {

/// What a server that stands by keeps in step with the one that leads: it computes each tick that
/// it is told of, holds it against the leader's state hash, and logs it as the leader does.
class Follower {
 public:
  /// `log` may be null; all must outlive this.
  Follower(World& world, SessionStatistics& statistics, SessionLogWriter* log, int threads,
           const CheckpointTimes& checkpoints = {});

  /// Are the meshes that ticks may name ready? They are made beside the ticks. Puts them at the
  /// world's disposal.
  bool has_meshes();
  /// Fails (kMismatch) where the two disagree, and (kRuntime) where ticks are missing between.
  Status take(const ToldTick& told);
  const std::vector<SeatRecord>& seats() const { return seats_; }
  std::uint64_t ticks() const { return ticks_; }
  std::int64_t time_ns() const { return time_ns_; }  ///< of the last tick that was told; 0: none
  std::uint64_t last_tick() const { return world_.tick; }
  /// The one that leads has said: go on from here.
  bool handed_over() const { return handed_over_; }

 private:
  void step_once(FollowedTick& tick);
  Status take_mesh(MeshPiece piece);

  World& world_;
  SessionStatistics& statistics_;
  SessionLogWriter* log_;
  TickRecorder recorder_;
  int threads_;
  Scratch scratch_;
  std::vector<SeatRecord> seats_;
  std::uint64_t ticks_ = 0, state_hash_ = 0;
  std::int64_t time_ns_ = 0;
  bool handed_over_ = false;
  struct Mesh {
    double quantum_mm = 0.0;
    std::future<PartShapePtr> shape;
  };
  MeshPiece mesh_;  ///< the pieces of a mesh so far
  std::vector<Mesh> meshes_;
};

/// Waits until the leader has told a tick, and then that all ticks before that one are in its log;
/// what is told meanwhile is kept. False when `stop` said so.
bool await_leader(StandbyChannel& channel, std::deque<ToldTick>& told,
                  const std::function<bool()>& stop);

/// Follows until the leader is gone, or hands over, and all that it told is computed. False when
/// `stop`, asked before each tick, said so. What is told is confirmed as it comes, so that clients
/// never wait for what is computed here; how far that is behind is confirmed with it, and given to
/// `note` in words where Backlog has news. Fails (kRuntime) beyond kMostUntaken_ticks,
/// where this one may no longer be a server, and where the leader counts on another one that stands
/// by: for some seconds, or as it is gone.
Result<bool> follow(StandbyChannel& channel, std::deque<ToldTick> told, Follower& follower,
                    const std::function<bool()>& stop,
                    const std::function<void(const std::string&)>& note);
/// As many as the transport keeps; 18 minutes at 60 Hz.
inline constexpr std::size_t kMostUntaken_ticks = 65536;

}  // namespace mortise
