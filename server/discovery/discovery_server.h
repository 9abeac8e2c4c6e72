#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "common/base/result.h"

namespace mortise {

struct DiscoveryOptions {
  std::string interface = "127.0.0.1";  ///< own IPv4 address to hear at
  int port = 0;                         ///< 0: 7398
};

struct DiscoveryCounts {
  std::uint64_t heard = 0;      ///< announcements taken
  std::uint64_t passed_on = 0;  ///< datagrams to others
  std::uint64_t not_sent = 0;   ///< that the network did not take
  // Datagrams that were dropped; see Introductions::Outcome.
  std::uint64_t malformed = 0, no_announcement = 0, no_purpose = 0, from_elsewhere = 0,
                other_purpose = 0, unknown = 0, too_often = 0, full = 0;
  std::size_t participants = 0, servers = 0, sessions = 0;  ///< now
  std::size_t most_participants = 0;                        ///< at one time
};

/// Introduces servers and clients of all sessions of a site to each other (DdsOptions::
/// discovery_server): it forwards the announcement of a participant, byte for byte, to those that
/// need it (Introductions); after that they communicate directly. It has no keys and proves
/// nothing: server and client check each other's certificates. When it is lost or restarted,
/// sessions that run are not interrupted; only a newcomer waits.
///
/// This is not the Discovery Server of Fast DDS, which in version 2.9 does not work with
/// DDS-Security.
class DiscoveryServer {
 public:
  /// Fails where the interface is not of this machine or the port is in use.
  static Result<std::unique_ptr<DiscoveryServer>> open(const DiscoveryOptions& options);
  virtual ~DiscoveryServer() = default;

  /// Reports servers that come and go, at most 10 lines a second, with the printable characters of
  /// session names; and warns of participants that did not fit, at most once in 10 s.
  using Tell = std::function<void(bool is_warning, const std::string& line)>;
  virtual void run_for(double seconds, const Tell& tell) = 0;
  virtual std::string place() const = 0;  ///< address:port
  virtual DiscoveryCounts counts() const = 0;
};

}  // namespace mortise
