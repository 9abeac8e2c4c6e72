#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/client.h"

namespace mortise {

/// What a participant has seen of a session, so that participants can be compared: two that saw the
/// same events in the same order have the same event hash; two that know the same poses have the
/// same pose hash.
class Tally {
 public:
  void add(const ClientUpdate& update, const Client& client);

  std::uint64_t refused() const;
  double latency_percentile_ms(double fraction) const;  ///< 0 when nothing was acknowledged
  std::string event_hash() const;

  nlohmann::ordered_json json() const;

 private:
  std::vector<double> latency_ms_;
  std::array<std::uint64_t, kRefusalCount> refused_{};
  std::uint64_t replies_ = 0, commands_refused_ = 0;
  std::uint64_t events_ = 0, first_seq_ = 0, last_seq_ = 0;
  std::array<std::uint64_t, 4> events_by_kind_{};
  std::map<ClashId, CollisionClass> worst_;
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
