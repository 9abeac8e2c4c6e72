#pragma once
#include <string>
#include <vector>

#include "idl/announcement.h"
#include "idl/dds_channel.h"

namespace mortise {

bool is_ipv4(const std::string& text);
bool is_own_address(const std::string& text);  ///< of this machine

/// Whether a UDP port can be had: Fast DDS would silently live without it.
bool port_is_free(const std::string& interface, int port);

/// First of the two ports of a session's server.
int server_port(const DdsOptions& options);
/// The place of one that stands by, so far above; the first one, once the one that leads has this.
inline constexpr int kSecondPlace = 2;
bool place_is_free(const DdsOptions& options, int port);

/// Where discovery servers hear, unless told.
inline constexpr int kDiscoveryServerPort = 7398;
/// Of DdsOptions::discovery_server, each once; names are looked up as below.
Result<std::vector<UdpPlace>> discovery_servers_of(const DdsOptions& options);

/// IPv4 of all hosts where servers of the session may be, each once. Where none is named it is the
/// own one; for clients that ask a discovery server, none. Names are looked up as this
/// machine looks up any (hosts file, DNS); one may stand for several hosts. Takes as long as that:
/// seconds, where a DNS server is silent. Fails where a name has no IPv4 address.
Result<std::vector<std::string>> addresses_of(const DdsOptions& options, bool is_client);

/// Can there be another server of the session: at the second place of this host, or on another?
bool may_have_another_server(const DdsOptions& options);

}  // namespace mortise
