#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

namespace mortise::bench {

/// What a participant hears, called by threads of its DDS implementation.
struct PeerHears {
  std::function<void(std::uint64_t seq)> increment;     ///< server
  std::function<void(bool alive)> presence;             ///< server: a client's writer
  std::function<void(std::uint64_t seq)> acknowledged;  ///< client
  std::function<void(std::size_t bytes)> mesh;          ///< client: a piece
};

struct PeerOptions {
  int domain = 0;
  bool is_server = false;
  double lease_s = 0.8;   ///< of presence
  bool meshes = false;    ///< client: read them
  std::string keys = {};  ///< folder of an identity; empty: no security
};

/// A participant of a session with four of its topics, by one DDS implementation: increments and
/// presence to the server, acknowledgements and meshes to clients.
class Peer {
 public:
  virtual ~Peer() = default;
  virtual bool say_increment(std::uint64_t seq) = 0;     ///< client: 100 bytes
  virtual bool say_present() = 0;                        ///< client
  virtual bool say_acknowledged(std::uint64_t seq) = 0;  ///< server
  /// Server. False: not now, the writer is full.
  virtual bool say_mesh(std::uint32_t chunk, std::span<const std::uint8_t> bytes) = 0;
  /// Client: the server hears it, and it the server.
  virtual bool has_met() const = 0;
};

/// What each implementation is as Debian ships it, with the settings of this project or those that
/// come nearest. Null: it could not be opened.
std::unique_ptr<Peer> open_fast_dds(const PeerOptions& options, PeerHears hears);
std::unique_ptr<Peer> open_cyclone(const PeerOptions& options, PeerHears hears);

inline constexpr std::uint32_t kPieceBytes = 59'000;

}  // namespace mortise::bench
