#include "client/own_users.h"

#include <algorithm>
#include <utility>

namespace mortise {
namespace {

std::int64_t in_ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

}  // namespace

LocalUser OwnUsers::add(const std::string& name, const std::string& role) {
  // The place of one who left, unless the server may still let that one in.
  auto free = std::find_if(users_.begin(), users_.end(), [](const State& user) {
    return user.state == JoinState::kLeft && !user.awaits_answer;
  });
  if (free == users_.end()) free = users_.insert(free, State{});
  statistics_.increments_repeated += free->unacknowledged.repeated();
  statistics_.increments_given_up += free->unacknowledged.given_up();
  *free = State{};
  free->name = name;
  free->role = role;
  free->state = JoinState::kJoining;
  // The same nonce for every try: a server that has already said yes says it again.
  free->nonce = next_nonce_++;
  return static_cast<LocalUser>(free - users_.begin());
}

void OwnUsers::leave(LocalUser index, std::int64_t now_ns) {
  State& user = users_[index];
  if (user.id) {
    // Nobody will repeat them later.
    if (!user.unacknowledged.empty()) channel_.send(user.unacknowledged.repeat(now_ns));
    channel_.leave(user.id);
  }
  user.awaits_answer = !user.id && user.join_sent_ns && user.state == JoinState::kJoining;
  user.state = JoinState::kLeft;
  user.id = UserId{};
}

OwnUsers::State* OwnUsers::find(UserId id) {
  if (!id) return nullptr;
  const auto found =
      std::find_if(users_.begin(), users_.end(), [id](const State& user) { return user.id == id; });
  return found == users_.end() ? nullptr : &*found;
}

bool OwnUsers::owns(UserId id) const {
  return id && std::any_of(users_.begin(), users_.end(),
                           [id](const State& user) { return user.id == id; });
}

std::uint64_t OwnUsers::send(LocalUser index, Increment increment, std::int64_t now_ns) {
  State& user = users_[index];
  if (user.state != JoinState::kJoined) {
    ++statistics_.not_joined;
    return 0;
  }
  increment.user = user.id;
  increment.seq = ++user.increment_seq;
  if (!user.unacked_since_ns) user.unacked_since_ns = now_ns;
  channel_.send(user.unacknowledged.add({increment, now_ns}, now_ns));
  ++statistics_.increments_sent;
  return increment.seq;
}

std::uint64_t OwnUsers::send(LocalUser index, Command command, std::int64_t now_ns) {
  State& user = users_[index];
  if (user.state != JoinState::kJoined) {
    ++statistics_.not_joined;
    return 0;
  }
  // A release must not overtake the end of the drag: once more what is not acknowledged yet.
  if (!user.unacknowledged.empty()) channel_.send(user.unacknowledged.repeat(now_ns));
  command.user = user.id;
  command.seq = ++user.command_seq;
  command.after = user.unacknowledged.newest();
  channel_.send(command);
  return command.seq;
}

void OwnUsers::take(const JoinReply& reply, std::int64_t now_ns, ClientUpdate& update) {
  for (LocalUser index = 0; index < users_.size(); ++index) {
    State& user = users_[index];
    if (user.nonce != reply.nonce) continue;
    if (user.state == JoinState::kLeft) {
      // Let in after it had gone: it would stay there for as long as this client.
      if (reply.refusal == Refusal::kNone && user.awaits_answer) channel_.leave(reply.user);
      user.awaits_answer = false;
    }
    if (user.state != JoinState::kJoining && user.state != JoinState::kJoined) continue;
    if (reply.refusal == Refusal::kNone) {
      user.in_doubt = false;
      if (user.state == JoinState::kJoined && user.id == reply.user) continue;
      user.state = JoinState::kJoined;
      user.id = reply.user;
      user.was_joined = true;
      user.refusal.clear();
      user.unacked_since_ns.reset();
      user.unacknowledged.clear();
      user.heartbeat_at_ns = now_ns - in_ns(options_.heartbeat_s);
      update.joined.push_back(index);
    } else {
      user.refusal = reply.text;
      user.id = UserId{};
      // Who had joined keeps trying: the server may not have noticed yet that its old self is gone.
      user.state = user.was_joined ? JoinState::kJoining : JoinState::kRefused;
    }
  }
}

void OwnUsers::take(const RefusedIncrement& refused) {
  State* user = find(refused.user);
  if (user != nullptr && refused.reason == Refusal::kUnknownUser) user->in_doubt = true;
}

void OwnUsers::take(const Ack& ack, std::uint64_t tick, std::int64_t now_ns, ClientUpdate& update) {
  State* user = find(ack.user);
  if (user == nullptr || ack.seq <= user->acked_seq) return;
  // Of whoever was this user before: a server may say late what it kept until it might.
  if (ack.seq > user->increment_seq) return;
  user->acked_seq = ack.seq;
  user->unacknowledged.acknowledge(ack.seq);
  user->unacked_since_ns.reset();
  if (ack.seq < user->increment_seq) user->unacked_since_ns = now_ns;
  update.acks.push_back({static_cast<LocalUser>(user - users_.data()), ack.seq, tick, ack.sent_ns});
  if (ack.sent_ns != 0)
    update.latency_ms.push_back(static_cast<double>(now_ns - ack.sent_ns) * 1e-6);
}

void OwnUsers::doubt(const UserInfo& who) {
  State* user = find(who.user);
  if (user != nullptr && (!who.present || who.name != user->name)) user->in_doubt = true;
}

void OwnUsers::forget_server() {
  for (State& user : users_) {
    user.awaits_answer = false;
    if (user.state != JoinState::kJoined) continue;
    user.state = JoinState::kJoining;
    user.id = UserId{};
    user.in_doubt = false;
    user.join_sent_ns.reset();
    user.unacknowledged.clear();
  }
}

// Those of all users go together: a server takes them in one tick, and is spared the others.
void OwnUsers::send_heartbeats(std::int64_t now_ns) {
  const auto silent_for = [&](const State& user, double s) {
    return user.state == JoinState::kJoined && now_ns - user.heartbeat_at_ns >= in_ns(s);
  };
  if (std::none_of(users_.begin(), users_.end(),
                   [&](const State& user) { return silent_for(user, options_.heartbeat_s); }))
    return;
  for (State& user : users_) {
    if (!silent_for(user, 0.5 * options_.heartbeat_s)) continue;
    user.heartbeat_at_ns = now_ns;
    // Of nobody: this client lives, and no lease is renewed.
    channel_.heartbeat(user.away ? UserId{} : user.id);
  }
}

void OwnUsers::send_what_is_due(std::int64_t now_ns) {
  send_heartbeats(now_ns);
  for (State& user : users_) {
    if (user.unacked_since_ns && now_ns - *user.unacked_since_ns >= in_ns(options_.ack_timeout_s)) {
      user.in_doubt = true;
      user.unacked_since_ns = now_ns;
    }
    const bool wants =
        user.state == JoinState::kJoining || (user.state == JoinState::kJoined && user.in_doubt);
    if (wants &&
        (!user.join_sent_ns || now_ns - *user.join_sent_ns >= in_ns(options_.join_retry_s))) {
      user.join_sent_ns = now_ns;
      channel_.join(user.nonce, user.name, user.role);
      ++statistics_.joins_sent;
    }
    if (user.state == JoinState::kJoined && !user.unacknowledged.empty() &&
        now_ns - user.unacknowledged.last_sent_ns() >= in_ns(options_.repeat_after_s)) {
      channel_.send(user.unacknowledged.repeat(now_ns));
    }
  }
}

void OwnUsers::tell_given_up(ClientUpdate& update) {
  for (State& user : users_) {
    const std::uint64_t seq = user.unacknowledged.given_up_to();
    if (std::exchange(user.given_up_seq, seq) < seq)
      update.given_up.push_back({static_cast<LocalUser>(&user - users_.data()), seq});
  }
}

void OwnUsers::add_to(ClientStatistics& statistics) const {
  for (const State& user : users_) {
    statistics.increments_repeated += user.unacknowledged.repeated();
    statistics.increments_given_up += user.unacknowledged.given_up();
  }
}

}  // namespace mortise
