#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "common/messages/channel.h"

namespace mortise {

/// Faults of a network, as probabilities in [0, 1]. Seeded: the same calls have the same faults.
struct MemoryFaults {
  double loss = 0.0;
  double duplicate = 0.0;
  double reorder = 0.0;  ///< chance that a message overtakes the one queued before it
  int delay_takes = 0;   ///< a message arrives up to so many take() calls late
  std::uint64_t seed = 1;
};

/// Both ends of a session in one process, without a network: for tests and for single-process use.
/// As with the DDS channel, requests, replies, snapshots and meshes always arrive, once and in
/// order; faults affect increments (up) and poses and events (down). Thread-safe: each end may run
/// in its own thread.
class MemoryHub {
 public:
  explicit MemoryHub(const MemoryFaults& up = {}, const MemoryFaults& down = {});

  /// The one server end. A second call replaces the first one, as a restarted server does: clients
  /// see server_lost once, and what was kept for late joiners is gone.
  std::unique_ptr<ServerChannel> open_server();

  /// A further client. Gets the kept snapshot and meshes, as a late joiner does. Closing it is
  /// reported in ServerInput::lost.
  std::unique_ptr<ClientChannel> open_client();

  /// Simulates a killed process: it is reported as lost without goodbye, and sends and receives
  /// nothing more.
  void kill(const ClientKey& client);

  /// Key of the client opened last.
  ClientKey last_client() const;

  struct State;

 private:
  std::shared_ptr<State> state_;
};

}  // namespace mortise
