#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/client_update.h"
#include "client/unacknowledged.h"

namespace mortise {

/// The users of this client: they join, stay joined, and repeat increments until the server has
/// acknowledged them.
class OwnUsers {
 public:
  /// All must outlive this.
  OwnUsers(ClientChannel& channel, const ClientOptions& options, ClientStatistics& statistics)
      : channel_(channel), options_(options), statistics_(statistics) {}

  LocalUser add(const std::string& name, const std::string& role);
  void leave(LocalUser user, std::int64_t now_ns);
  /// While away a user stays joined and is not heard: the leases of what it holds go on.
  void set_away(LocalUser user, bool away) { users_[user].away = away; }
  std::size_t count() const { return users_.size(); }  ///< those who left included
  JoinState state(LocalUser user) const { return users_[user].state; }
  UserId id(LocalUser user) const { return users_[user].id; }
  const std::string& refusal(LocalUser user) const { return users_[user].refusal; }
  bool owns(UserId id) const;

  /// Both: the sequence number; 0 when the user has not joined (counted).
  std::uint64_t send(LocalUser user, Increment increment, std::int64_t now_ns);
  std::uint64_t send(LocalUser user, Command command, std::int64_t now_ns);

  void take(const JoinReply& reply, std::int64_t now_ns, ClientUpdate& update);
  /// A refused increment of one of our users.
  void take(const RefusedIncrement& refused);
  void take(const Ack& ack, std::uint64_t tick, std::int64_t now_ns, ClientUpdate& update);
  /// If one of our users is absent, or its id belongs to another user now, it has to join again.
  void doubt(const UserInfo& who);
  void forget_server();
  /// Joins, heartbeats and repeated increments.
  void send_what_is_due(std::int64_t now_ns);
  /// What was given up since the last call.
  void tell_given_up(ClientUpdate& update);
  /// Adds the counts of all users.
  void add_to(ClientStatistics& statistics) const;

 private:
  struct State {
    std::string name, role;
    JoinState state = JoinState::kUnknown;
    UserId id;
    std::uint64_t nonce = 0, increment_seq = 0, command_seq = 0, acked_seq = 0,
                  given_up_seq = 0;  ///< told so far
    Unacknowledged unacknowledged;
    bool was_joined = false;     ///< joins again by itself, also when refused
    bool awaits_answer = false;  ///< left while a join was not answered yet
    bool away = false;           ///< its leases are not renewed
    bool in_doubt = false;       ///< the server may count us as absent: ask to join again
    std::optional<std::int64_t> join_sent_ns, unacked_since_ns;
    std::int64_t heartbeat_at_ns = 0;
    std::string refusal;
  };
  State* find(UserId id);
  void send_heartbeats(std::int64_t now_ns);

  ClientChannel& channel_;
  const ClientOptions& options_;
  ClientStatistics& statistics_;
  std::vector<State> users_;
  std::uint64_t next_nonce_ = 1;
};

}  // namespace mortise
