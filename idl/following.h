#pragma once
#include <chrono>
#include <utility>
#include <vector>

#include "common/messages/channel.h"
#include "idl/chunks.h"
#include "idl/doorman.h"
#include "idl/identity.h"
#include "mortisePubSubTypes.h"

namespace mortise {

/// What the server that leads tells of its ticks: of all that are heard the one with the highest
/// term, of equal ones the highest key.
class LeaderTold {
 public:
  /// Says whether that one leads instead of `own`, a term (0: it does not lead) and a key. Pieces
  /// come in order. `ticks` may be null.
  bool hear(const wire::ServerTick& sample, const ClientKey& key,
            const std::pair<std::uint64_t, ClientKey>& own, std::vector<ToldTick>* ticks) {
    const std::pair rank(sample.term(), key);
    if (key == own.second || rank < std::pair(term_, leader_)) return false;
    term_ = sample.term();
    leader_ = key;
    counts_on_ = sample.follower();
    const bool superseded = own.first != 0 && rank > own;
    if (ticks == nullptr) return superseded;
    if (auto tick = collector_.add(sample)) ticks->push_back(std::move(*tick));
    return superseded;
  }
  /// A leader that is revoked ends once it has the list, too. What it tells until then is heard,
  /// for some seconds since it was first asked for: who works with it holds that for safe.
  bool may_be_ending(const ClientKey& revoked) {
    // Lists are looked at each second, and come one after the other.
    constexpr std::chrono::seconds kMayTake(5);
    const auto now = std::chrono::steady_clock::now();
    if (std::exchange(revoked_, revoked) != revoked) revoked_at_ = now;
    return revoked == leader_ && now - revoked_at_ < kMayTake;
  }
  std::uint64_t term() const { return term_; }
  const ClientKey& leader() const { return leader_; }        ///< empty: none was heard
  const ClientKey& counts_on() const { return counts_on_; }  ///< the one that stands by, for it
  std::uint64_t dropped() const { return collector_.dropped(); }  ///< pieces

 private:
  std::uint64_t term_ = 0;
  ClientKey leader_, counts_on_;
  ClientKey revoked_;  ///< of whom it was asked last
  std::chrono::steady_clock::time_point revoked_at_{};
  TickCollector collector_;
};

/// The one that stands by and counts: the first that says what it has, until it is gone or revoked.
class FollowerTold {
 public:
  /// What was said since the last call. `identities` may be null: no security.
  TakenTicks take(dds::DataReader& reader, std::uint64_t term, const PeerIdentities* identities) {
    TakenTicks taken;
    wire::ServerTaken sample;
    dds::SampleInfo info;
    while (reader.take_next_sample(&sample, &info) ==
           eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data || sample.term() != term) continue;
      const ClientKey key = client_key(info.sample_identity.writer_guid());
      if (identities != nullptr && identities->is_revoked(key)) {
        if (key == follower_) follower_.clear();
        continue;
      }
      if (follower_.empty()) follower_ = key;
      if (key != follower_ || sample.tick() < taken.received) continue;
      taken = {sample.tick(), sample.computed()};
    }
    return taken;
  }
  /// Empty: none.
  const ClientKey& follower(const ServersWatch& servers) {
    if (!servers.follows(follower_)) follower_.clear();
    return follower_;
  }

 private:
  ClientKey follower_;
};

}  // namespace mortise
