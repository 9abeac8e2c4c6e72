#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "client/bot/event_delay.h"
#include "client/bot/stream_digest.h"
#include "client/client.h"

namespace mortise {

/// What a participant has seen of a session, so that participants can be compared: two that saw the
/// same events in the same order have the same event hash; two that know the same poses have the
/// same pose hash.
class Tally {
 public:
  void add(const ClientUpdate& update, const Client& client);

  std::uint64_t refused() const;
  std::string event_hash() const;
  const std::vector<double>& latency_ms() const { return latency_ms_; }  ///< increment to pose
  const std::vector<double>& event_latency_ms() const { return event_latency_ms_; }
  const StreamDigest& stream() const { return stream_; }
  std::uint64_t replies() const { return replies_; }
  std::uint64_t resyncs() const { return resyncs_; }
  /// Highest sequence acknowledged, by local user.
  const std::vector<std::uint64_t>& acknowledged() const { return acknowledged_; }

  nlohmann::ordered_json json() const;

 private:
  void add_pair(const ClashEvent& event, const Client& client);
  std::vector<double> latency_ms_, event_latency_ms_;
  EventDelay event_delay_;
  StreamDigest stream_;
  std::vector<std::uint64_t> acknowledged_;
  std::array<std::uint64_t, kRefusalCount> refused_{}, commands_refused_by_{};
  std::uint64_t replies_ = 0, commands_refused_ = 0;
  std::uint64_t events_ = 0, first_seq_ = 0, last_seq_ = 0;
  std::array<std::uint64_t, 4> events_by_kind_{};
  std::map<ClashId, CollisionClass> worst_;
  std::map<std::string, CollisionClass> worst_of_pair_;  ///< see pair_key()
  std::optional<SessionPulse> first_pulse_, last_pulse_;
  std::uint64_t event_hash_ = 0;
  std::uint64_t resyncs_ = 0, server_losses_ = 0, meshes_ = 0;
};

/// Hash of all poses, by part id.
std::string pose_hash(const Client& client);
/// Hash of the open clashes: who with whom, class and depth.
std::string clash_hash(const Client& client);
/// Poses and open clashes in full.
nlohmann::ordered_json state_json(const Client& client);

}  // namespace mortise
