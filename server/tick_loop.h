#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/io/log/session_log.h"
#include "common/messages/channel.h"
#include "common/session/tick/statistics.h"
#include "common/session/tick/step.h"
#include "common/session/world/world.h"
#include "server/clock.h"
#include "server/inbox.h"
#include "server/metrics.h"
#include "server/tick_publisher.h"
#include "server/tick_recorder.h"

namespace mortise {

struct TickLoopOptions : PublishOptions {
  int threads = 1;
  InboxLimits inbox;
  double pulse_s = 1.0;
  CheckpointTimes checkpoints;
};

/// The beat of a session: at a fixed rate drain the channel, apply decisions, step, record,
/// publish. Everything that the session knows changes here, on one thread. Does not log;
/// `after_tick` may.
class TickLoop {
 public:
  /// All references must outlive the loop; `log` may be null.
  TickLoop(World& world, ServerChannel& channel, Clock& clock, SessionLogWriter* log,
           const TickLoopOptions& options);

  /// Goes on with a session of before, whose ticks `statistics` tells. `departures` were applied to
  /// the world already; they are logged with the first tick. Called before open().
  void resume(SessionStatistics statistics, std::vector<Decision> departures);

  /// Goes on where another server was when it was gone: like resume(), and nobody departs.
  void adopt(SessionStatistics statistics, const std::vector<SeatRecord>& seats);

  /// Another server leads the session now: this one must end.
  bool superseded() const { return superseded_; }
  /// Its address, as far as it is known.
  const std::string& superseded_by() const { return superseded_by_; }

  /// Publishes the meshes, once per distinct hash, and the first snapshot.
  void open();

  /// One tick, now. It is recorded at the latest with the next one or close().
  void tick();

  /// Ticks at world.tick_rate_hz with absolute deadlines until `stop` says so (asked before each
  /// tick). A tick that runs past the next deadline counts as an overload; the deadlines that it
  /// ran past wholly are passed over and counted, so that lateness never piles up.
  void run(const std::function<bool()>& stop, const std::function<void()>& after_tick);

  /// The server ends soon: who is not in the session yet is put off, and clients are told.
  void begin_drain();
  /// The last tick: the log gets a checkpoint of its end. With `hands_over` the one that stands by
  /// is told to go on from here.
  void last_tick(bool hands_over);

  /// A last snapshot for those who stay, and that nothing comes after it.
  void close();

  const World& world() const { return world_; }
  const SessionStatistics& statistics() const { return statistics_; }
  const TickMetrics& metrics() const { return metrics_; }
  const Inbox& inbox() const { return inbox_; }
  /// Of the last tick, until run() goes on to the next; tick and state hash remain.
  const StepReport& last_report() const { return report_; }
  const Intake& last_intake() const { return intake_; }
  SessionPulse pulse() const;
  const SessionLogWriter* log() const { return log_; }  ///< null: none is written
  std::uint64_t log_dropped_ticks() const { return log_ != nullptr ? log_->dropped_ticks() : 0; }
  double seconds() const { return static_cast<double>(now_ns_ - opened_ns_) * 1e-9; }

 private:
  void begin_record(std::int64_t step_ns);
  void hand_over_record() { recorder_.hand_over(intake_.decisions, intake_.increments, report_); }
  void tell_follower();
  void measure_delay();
  void note_unexamined();

  World& world_;
  ServerChannel& channel_;
  Clock& clock_;
  SessionLogWriter* log_;
  TickLoopOptions options_;
  Inbox inbox_;
  Scratch scratch_;
  Intake intake_;
  StepReport report_;
  SessionStatistics statistics_;
  TickMetrics metrics_;
  TickRecorder recorder_;
  TickPublisher publisher_;
  std::map<UserId, std::int64_t> fastest_ns_;  ///< arrival minus send, of two clocks: least so far
  std::map<std::pair<PartId, PartId>, UnexaminedRow> unexamined_;  ///< since the last pulse
  std::vector<Decision> departures_;  ///< of before a restore, not yet logged
  std::int64_t opened_ns_ = 0, now_ns_ = 0, pulse_ns_ = 0;
  bool superseded_ = false;
  std::string superseded_by_;
  bool draining_ = false, last_ = false, hands_over_ = false;
};

}  // namespace mortise
