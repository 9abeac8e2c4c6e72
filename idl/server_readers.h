#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "common/messages/channel.h"
#include "idl/convert.h"
#include "idl/doorman.h"
#include "idl/participant.h"
#include "idl/server_writers.h"

namespace mortise {

/// What a server hears from clients: the readers of its topics, who has joined as whom, and who is
/// not heard because their certificates were revoked.
class ServerReaders {
 public:
  /// Requests that are malformed, or of somebody who is revoked, are answered at once.
  explicit ServerReaders(ServerWriters& writers) : writers_(writers) {}

  /// Before any thread of Fast DDS calls.
  void know(std::unique_ptr<PeerIdentities> identities);
  Doorman& doorman() { return doorman_; }
  const PeerIdentities* identities() const { return identities_.get(); }  ///< null: no security
  void open(Participant& participant, Status& status);  ///< which must outlive this

  /// Whom to turn away; first, so that who has to go does not come in by what is taken next.
  void turn_away(const Participant& participant, ServerInput& input);
  void take(ServerInput& input);
  /// A participant has joined as this user.
  void note_joined(UserId user, const ClientKey& client) { joined_[user] = client; }

  const ChannelCounters& counters() const { return counters_; }
  ChannelCounters& counters() { return counters_; }

 private:
  template <class Sample, class Action>
  void take_each(dds::DataReader& reader, Action action);
  void take_requests(ServerInput& input);
  void take_request(const wire::Request& sample, const ClientKey& key, ServerInput& input);
  void take_presence(ServerInput& input);
  void take_increments(ServerInput& input);
  void take_departures(ServerInput& input);
  void refuse(const wire::Request& sample, const ClientKey& key, const std::string& text);
  bool owns(const ClientKey& client, UserId user);

  ServerWriters& writers_;
  Participant* participant_ = nullptr;
  std::unique_ptr<PeerIdentities> identities_;
  Doorman doorman_;
  dds::DataReader *presence_ = nullptr, *requests_ = nullptr, *increments_ = nullptr;
  std::map<UserId, ClientKey> joined_;
  std::set<ClientKey> present_;
  std::chrono::steady_clock::time_point next_presence_{};
  ChannelCounters counters_;
};

}  // namespace mortise
