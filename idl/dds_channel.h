#pragma once
#include <memory>
#include <string>

#include "common/base/result.h"
#include "common/messages/channel.h"

namespace mortise {

/// Where a session is met. Servers of one host live beside each other by another domain or another
/// port.
struct DdsOptions {
  std::string session = "default";      ///< partition "session/<name>"
  int domain = 0;                       ///< 0..232
  std::string interface = "127.0.0.1";  ///< own IPv4 address; nothing is sent or heard elsewhere
  /// Hosts where the session may be led, comma between: IPv4, or a name, which is looked up once
  /// and may stand for all of them. Empty: same as interface; with a discovery server, for clients,
  /// none.
  std::string server = "";
  /// Discovery servers that know where the session is led (mortise-discovery), comma between:
  /// HOST[:PORT], IPv4 or a name. Empty: none is asked.
  std::string discovery_server = "";
  /// First of the server's two UDP ports; one that stands by takes the next two. 0: 7402 + 250
  /// domain.
  int discovery_port = 0;
  double liveliness_lease_s = 0.8;   ///< server and client: a silent client is gone after this
  double participant_lease_s = 2.0;  ///< a silent process is gone after this
  double heartbeat_period_s = 0.1;   ///< of reliable writers; 0.02 on lossy links
  /// Server: when the session was led last, ms since 1970, as its log tells; 0: it begins. It leads
  /// under a later term, also where the clock was set back since.
  std::uint64_t led_until_ms = 0;
  bool meshes = true;    ///< client: receive meshes
  bool features = true;  ///< client: receive what constraints can name
  /// Folder of an identity (see client/tools/keys): DDS-Security on. Empty: off. Participants with
  /// and without never meet.
  std::string keys = {};
  bool check_keys = true;  ///< look at them first, to say what is wrong; else only the others judge
};

/// For messages: where the session is looked for, "10.0.0.1, or wherever the discovery server hall
/// knows".
std::string looked_at(const DdsOptions& options);

/// The server's end: the fixed point that clients look for. Fails in one line when the port is in
/// use, the interface is not of this machine, or the domain is out of range.
Result<std::unique_ptr<ServerChannel>> open_server_channel(const DdsOptions& options);

/// The same of a server that stands by: at the server's port, or two above it where that is taken.
Result<std::unique_ptr<StandbyChannel>> open_standby_channel(const DdsOptions& options);

/// A participant's end. Returns at once; the server may come later (ClientInput::server_present).
Result<std::unique_ptr<ClientChannel>> open_client_channel(const DdsOptions& options);

}  // namespace mortise
