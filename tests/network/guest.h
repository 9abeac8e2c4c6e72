#pragma once
#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "client/client.h"
#include "idl/dds_channel.h"
#include "tests/network/patience.h"

namespace mortise::test {

inline double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A participant in this process.
struct Guest {
  Guest(int domain, const std::string& name, const std::string& role = "designer",
        const std::string& keys = "")
      : Guest(by(domain, keys), name, role) {}
  Guest(const DdsOptions& options, const std::string& name, const std::string& role = "designer") {
    auto opened = open_client_channel(options);
    if (!opened) return;
    channel = std::move(*opened);
    client = std::make_unique<Client>(*channel);
    user = client->add_user(name, role);
  }
  ClientUpdate listen() {
    ClientUpdate update = client->poll();
    for (const RefusedIncrement& r : update.refused) refused.push_back(r);
    for (const Reply& r : update.replies) replies.push_back(r);
    // May be taken or lost: later acknowledgements do not speak of them.
    for (const GivenUp& given_up : update.given_up)
      told_up_to_ = std::max(told_up_to_, given_up.seq);
    const std::uint64_t sent = client->statistics().increments_sent;
    for (const SeenAck& ack : update.acks)
      while (told_up_to_ < std::min(ack.seq, sent)) taken.insert(++told_up_to_);
    if (const UserId now = client->user_id(user)) id = now;
    return update;
  }
  bool until(double limit_s, const std::function<bool()>& done) {
    for (const double end_s = steady_s() + limit_s; steady_s() < end_s;) {
      listen();
      if (done()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }
  bool joined() {
    return until(kPatience_s, [&] { return client->user_id(user) && client->synced(); });
  }
  UserId holder(const char* part) const {
    return client->parts().at(client->find_part(part)).info.holder;
  }
  double x(const char* part) const {
    return client->parts().at(client->find_part(part)).info.X_WP.p.x();
  }
  bool grab(const char* part) {
    const std::uint64_t seq = client->grab(user, client->find_part(part));
    const auto is_refused = [&] {
      return std::any_of(replies.begin(), replies.end(), [&](const Reply& reply) {
        return reply.seq == seq && reply.refusal != Refusal::kNone;
      });
    };
    return until(kPatience_s,
                 [&] { return holder(part) == client->user_id(user) || is_refused(); }) &&
           !is_refused();
  }

  std::unique_ptr<ClientChannel> channel;
  std::unique_ptr<Client> client;
  LocalUser user = 0;
  UserId id;                      ///< of the last time that it was in
  std::set<std::uint64_t> taken;  ///< increments that a server has said to have, refused ones too;
                                  ///< of those that `client` sent
  std::vector<RefusedIncrement> refused;
  std::vector<Reply> replies;

 private:
  static DdsOptions by(int domain, const std::string& keys) {
    DdsOptions options;
    options.domain = domain;
    options.keys = keys;
    return options;
  }
  std::uint64_t told_up_to_ = 0;  ///< increments up to here are taken, or in doubt
};

}  // namespace mortise::test
