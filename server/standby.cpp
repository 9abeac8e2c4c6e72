#include "server/standby.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/io/log/session_log_read.h"
#include "common/io/scenario/brought_part.h"
#include "common/messages/mesh_bytes.h"
#include "common/session/world/decisions.h"
#include "server/backlog.h"
#include "server/scheduling.h"
#include "server/silence.h"

namespace mortise {
namespace {

using Clock = std::chrono::steady_clock;

// One wait for news at most: a sixteenth of a tick of 60 Hz.
constexpr std::int64_t kTurn_ns = 1'000'000;
// One that was killed is known to be gone within 2 s.
constexpr auto kAnotherMayBeGone = std::chrono::seconds(5);

void hear(StandbyChannel& channel, std::deque<ToldTick>& told) {
  for (ToldTick& tick : channel.follow()) told.push_back(std::move(tick));
}

std::int64_t now_ns() { return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count(); }

/// Tells a silence how an ordinary thread of this process gets on: those that take what comes are
/// ordinary, while the loop that follows runs before all others.
class OrdinaryTurns {
 public:
  /// Never waits for that thread: what is not told now is told by the next call.
  void tell(Silence& silence) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;
    for (const double took_s : took_s_) silence.turn(took_s);
    took_s_.clear();
  }

 private:
  // Half of what one turn counts for.
  static constexpr std::chrono::duration<double> kTurn{0.5 * Silence::kTurnCounts_s};

  void run(const std::stop_token& stop) {
    run_as_others();
    std::unique_lock lock(mutex_);
    for (Clock::time_point at = Clock::now(); !stop.stop_requested();) {
      stopped_.wait_for(lock, stop, kTurn, [] { return false; });
      const Clock::time_point now = Clock::now();
      took_s_.push_back(std::chrono::duration<double>(now - std::exchange(at, now)).count());
    }
  }

  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::vector<double> took_s_;
  std::jthread thread_{[this](const std::stop_token& stop) { run(stop); }};  ///< last: it uses them
};

std::string text_of(Backlog::News news, std::uint64_t backlog, std::uint64_t tick) {
  switch (news) {
    case Backlog::News::kInStep:
      return "in step from tick " + std::to_string(tick) + " on";
    case Backlog::News::kInStepAgain:
      return "in step again from tick " + std::to_string(tick) + " on";
    case Backlog::News::kBehind:
      return std::to_string(backlog) +
             " ticks of the one that leads are not computed yet: a take-over would wait for them";
    case Backlog::News::kNone:
      break;
  }
  return {};
}

// A mesh as clients get it, or a part with what its file states of it.
std::optional<TriangleMesh> mesh_of(std::vector<std::byte> bytes) {
  if (is_step_document(bytes)) {
    Result<TriangleMesh> brought = brought_mesh(std::move(bytes));
    return brought ? std::optional(std::move(brought).value()) : std::nullopt;
  }
  std::optional<WireMesh> mesh = mesh_from_bytes(bytes);
  if (!mesh) return std::nullopt;
  return TriangleMesh{std::move(mesh->points_mm), std::move(mesh->triangles)};
}

}  // namespace

Follower::Follower(World& world, SessionStatistics& statistics, SessionLogWriter* log, int threads,
                   const CheckpointTimes& checkpoints)
    : world_(world),
      statistics_(statistics),
      log_(log),
      recorder_(world, log, checkpoints),
      threads_(threads),
      scratch_(threads) {
  statistics_.keep_ended_rows(SessionStatistics::kMostEndedRows);
  recorder_.open(now_ns());
}

Status Follower::take(const ToldTick& told) {
  FollowedTick tick;
  if (!decode(told.bytes, tick)) {
    return fail(Code::kMismatch, "tick " + std::to_string(told.tick) +
                                     " was told in words that this build does not know");
  }
  if (tick.has_seats) seats_ = std::move(tick.seats);
  time_ns_ = std::max(time_ns_, tick.time_ns);
  if (tick.mesh)
    if (Status taken = take_mesh(std::move(*tick.mesh)); !taken) return taken;
  if (tick.tick <= world_.tick) return ok();
  // Between the log and what was told nothing went in, or it would be in one of them.
  if (ticks_ > 0 && tick.tick != world_.tick + 1) {
    return fail(Code::kRuntime, "ticks after " + std::to_string(world_.tick) + " and before " +
                                    std::to_string(tick.tick) +
                                    " were not told to this one: start it again");
  }
  if (tick.tick - world_.tick > kMostIdleTicks)
    return fail(Code::kRuntime, "tick " + std::to_string(tick.tick) + " was told after tick " +
                                    std::to_string(world_.tick) + ": no session waits so long");
  while (world_.tick + 1 < tick.tick) {
    FollowedTick idle;
    idle.time_ns = tick.time_ns;
    step_once(idle);
  }
  step_once(tick);
  ++ticks_;
  handed_over_ = tick.hands_over;
  if (state_hash_ == tick.state_hash) return ok();
  return fail(Code::kMismatch, "at tick " + std::to_string(tick.tick) +
                                   " this engine computes something else than the one that leads");
}

Status Follower::take_mesh(MeshPiece piece) {
  if (piece.offset == 0) mesh_ = {piece.hash, piece.quantum_mm, piece.length, 0, {}};
  // The rest of one whose beginning was told before this one came: it is told again from there.
  if (piece.hash != mesh_.hash || piece.offset != mesh_.bytes.size()) return ok();
  mesh_.bytes.insert(mesh_.bytes.end(), piece.bytes.begin(), piece.bytes.end());
  if (mesh_.bytes.size() < mesh_.length || !world_.shapes) return ok();
  std::optional<TriangleMesh> triangles = mesh_of(std::move(mesh_.bytes));
  if (!triangles || mesh_hash(*triangles) != mesh_.hash)
    return fail(Code::kMismatch, "mesh " + mesh_.hash + " was told with other bytes");
  auto make = [make = world_.shapes->make(), quantum_mm = mesh_.quantum_mm, threads = threads_,
               solid = std::make_shared<const Solid>(std::move(*triangles))]() -> PartShapePtr {
    auto shape = std::make_shared<const PartShape>(make(solid, quantum_mm));
    build_derived(*shape, threads);
    return shape;
  };
  meshes_.push_back({mesh_.quantum_mm, std::async(std::launch::async, std::move(make))});
  mesh_ = {};
  return ok();
}

bool Follower::has_meshes() {
  std::erase_if(meshes_, [this](Mesh& mesh) {
    if (mesh.shape.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    world_.shapes->add(mesh.shape.get(), mesh.quantum_mm);
    return true;
  });
  return meshes_.empty();
}

void Follower::step_once(FollowedTick& tick) {
  for (const Decision& decision : tick.decisions) apply_decision(world_, decision);
  const std::int64_t begun_ns = now_ns();
  StepReport report = step(world_, tick.increments, scratch_);
  state_hash_ = report.state_hash;
  statistics_.forget_users(tick.decisions);
  statistics_.add(report);
  if (log_ == nullptr) return;
  const std::int64_t stepped_ns = now_ns();
  recorder_.begin({.tick = report.tick,
                   .wall_ns = tick.time_ns,
                   .now_ns = stepped_ns,
                   .step_ns = stepped_ns - begun_ns,
                   .changed = !tick.decisions.empty() || !tick.increments.empty()});
  recorder_.hand_over(tick.decisions, tick.increments, report);
}

bool await_leader(StandbyChannel& channel, std::deque<ToldTick>& told,
                  const std::function<bool()>& stop) {
  for (FollowedTick newest; !stop(); channel.await_told(kTurn_ns)) {
    hear(channel, told);
    // What this build does not know is said by who takes it.
    if (!told.empty() &&
        (!decode(told.back().bytes, newest) || told.front().tick - 1 <= newest.logged_tick))
      return true;
  }
  return false;
}

Result<bool> follow(StandbyChannel& channel, std::deque<ToldTick> told, Follower& follower,
                    const std::function<bool()>& stop,
                    const std::function<void(const std::string&)>& note) {
  Silence silence;
  OrdinaryTurns turns;
  Backlog backlog;
  Clock::time_point counts = Clock::now();
  for (std::size_t confirmed = 0; !stop();) {
    // Asked first: what it told before it was gone is here by then.
    const bool is_gone = !channel.leader_present();
    hear(channel, told);
    if (std::string why = channel.barred(); !why.empty())
      return fail(Code::kRuntime, std::move(why));
    const bool another = channel.another_stands_by();
    if (!another) counts = Clock::now();
    if (told.size() > confirmed) {
      silence.heard();
      if (!another) channel.confirm({told.back().tick, follower.last_tick()});
    }
    if (told.size() > kMostUntaken_ticks) {
      return fail(Code::kRuntime, std::to_string(told.size()) +
                                      " ticks of the one that leads are not computed yet: this "
                                      "host is too slow to stand by");
    }
    const bool may_take = !told.empty() && follower.has_meshes();
    if (may_take) {
      if (Status taken = follower.take(told.front()); !taken) return taken.error();
      told.pop_front();
    }
    confirmed = told.size();
    const Backlog::News news = backlog.now_is(told.size());
    if (news != Backlog::News::kNone) note(text_of(news, told.size(), follower.last_tick()));
    const bool takes_over =
        told.empty() && (follower.handed_over() || (is_gone && silence.is_believed()));
    if (another && (takes_over || Clock::now() - counts > kAnotherMayBeGone))
      return fail(Code::kRuntime,
                  "another server stands by for this session, and one is enough: this one ends");
    if (takes_over) return true;
    turns.tell(silence);
    if (!is_gone) silence.present();
    if (!may_take) channel.await_told(kTurn_ns);
  }
  if (!channel.another_stands_by()) channel.confirm({kTakenAll, follower.last_tick()});
  return false;
}

}  // namespace mortise
