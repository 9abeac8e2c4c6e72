#include "tests/network/small_server.h"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

namespace mortise::test {

double now_s() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

void sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

bool until(double limit_s, const std::function<bool()>& done, const std::function<void()>& turn) {
  const double end_s = now_s() + limit_s;
  while (!done()) {
    if (now_s() > end_s) return false;
    turn();
    sleep_s(0.004);
  }
  return true;
}

SmallServer::SmallServer(ServerChannel& channel, const std::string& session, std::uint32_t count)
    : channel_(channel), session_(session) {
  for (std::uint32_t i = 1; i <= count; ++i) {
    parts.push_back({PartId{i}, UserId{}, Pose::translation(Vec3(i, 0, 0))});
  }
  channel_.publish_snapshot(snapshot());
}

Snapshot SmallServer::snapshot() const {
  Snapshot snapshot;
  snapshot.session = session_;
  snapshot.tick = tick;
  snapshot.event_seq = event_seq;
  snapshot.policy = "report";
  for (const PartPose& pose : parts) {
    PartInfo part;
    part.part = pose.part;
    part.name = "part" + std::to_string(pose.part.value);
    part.mesh_hash = "0123456789abcdef0123456789abcdef";
    part.moving = true;
    part.holder = pose.holder;
    part.X_WP = pose.X_WP;
    part.radius_mm = 1.0;
    snapshot.parts.push_back(part);
  }
  for (const auto& [id, user] : users) snapshot.users.push_back({id, user.second, true});
  return snapshot;
}

void SmallServer::turn() {
  ++tick;
  last_input = channel_.take();
  for (const LostUser& user : last_input.lost) lost.push_back(user);
  bool wanted = !last_input.snapshot_requests.empty();
  for (const JoinRequest& join : last_input.joins) {
    UserId id{static_cast<std::uint32_t>(users.size() + 1)};
    for (const auto& [known, user] : users) {
      if (user.first == join.client && user.second == join.name) id = known;
    }
    users[id] = {join.client, join.name};
    channel_.publish_join_reply({join.client, join.nonce, id, Refusal::kNone, ""});
    wanted = true;
  }
  commands += last_input.commands.size();
  std::vector<Reply> replies;
  for (const ReceivedCommand& received : last_input.commands) {
    const Command& command = received.command;
    PartPose& part = parts[command.part.value - 1];
    part.holder = command.kind == CommandKind::kGrab ? command.user : UserId{};
    replies.push_back({command.user, command.part, command.seq, Refusal::kNone, part.holder, ""});
  }
  PoseBatch batch;
  batch.tick = tick;
  std::vector<RefusedIncrement> refused;
  for (const ReceivedIncrement& received : last_input.increments) {
    const auto& [user, part_id, seq, translation_mm, rotation_rad] = received.increment;
    if (seq <= newest[user]) continue;  // a repeat
    newest[user] = seq;
    if (received.at_door != Refusal::kNone) {
      refused.push_back({user, part_id, seq, received.at_door});
      batch.acks.push_back({user, seq, 0});
      continue;
    }
    ++increments;
    PartPose& part = parts[received.increment.part.value - 1];
    part.X_WP.p += received.increment.translation_mm;
    batch.parts.push_back(part);
    batch.acks.push_back({received.increment.user, received.increment.seq, received.sent_ns});
  }
  batch.event_seq = event_seq;
  const double start_s = now_s();
  if (!replies.empty()) channel_.publish_replies(replies);
  refused_at_door += refused.size();
  if (!refused.empty()) channel_.publish_refusals(refused);
  if (!batch.acks.empty()) channel_.publish_poses(batch);
  if (wanted) channel_.publish_snapshot(snapshot());
  note_publish(start_s);
}

void SmallServer::publish_events(std::uint32_t count) {
  std::vector<ClashEvent> events;
  for (std::uint32_t i = 0; i < count; ++i) events.push_back(some_event(++event_seq, tick));
  const double start_s = now_s();
  channel_.publish_events(events);
  note_publish(start_s);
}

void SmallServer::note_publish(double start_s) {
  constexpr double kSlow_s = 0.008;
  const double took_s = now_s() - start_s;
  longest_publish_s = std::max(longest_publish_s, took_s);
  slow_publishes += took_s > kSlow_s;
}

ClashEvent some_event(std::uint64_t seq, std::uint64_t tick) {
  ClashEvent event;
  event.kind = ClashEvent::Kind::kChange;
  event.seq = seq;
  event.tick = tick;
  event.begin_tick = 0;
  event.clash = ClashId{static_cast<std::uint32_t>(1 + seq % 7)};
  event.part_a = PartId{1};
  event.part_b = PartId{2};
  event.verdict.collision_class = CollisionClass::kReal;
  event.verdict.explanation = "event " + std::to_string(seq);
  return event;
}

Child::Child(const std::string& role, const DdsOptions& options, const std::string& name,
             double stay_s) {
  std::string program = MORTISE_BIN_DIR "/network_peer";
  std::string words[] = {role, std::to_string(options.domain), options.session,
                         name, std::to_string(stay_s),         options.keys};
  char* arguments[] = {program.data(),  words[0].data(), words[1].data(), words[2].data(),
                       words[3].data(), words[4].data(), words[5].data(), nullptr};
  if (posix_spawn(&pid_, program.c_str(), nullptr, nullptr, arguments, environ) != 0) {
    std::perror(program.c_str());
    pid_ = 0;
  }
}

Child::~Child() {
  if (pid_ <= 0 || ended_) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

void Child::signal(int number) const { kill(pid_, number); }

int Child::wait(double limit_s) {
  const double end_s = now_s() + limit_s;
  while (now_s() < end_s) {
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      ended_ = true;
      return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    sleep_s(0.01);
  }
  return -1;
}

}  // namespace mortise::test
