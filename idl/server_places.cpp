#include "idl/server_places.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <sstream>

namespace mortise {
namespace {

// Well-known ports are 7400 + 250 domain + {0, 1, 10 + 2 i, 11 + 2 i}; 2 and 3 are nobody's.
constexpr int kPortBase = 7400, kPortsPerDomain = 250, kServerPortOffset = 2;
constexpr int kMaxPort = 65535;

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> all;
  std::stringstream words(text);
  for (std::string word; std::getline(words, word, ',');) all.push_back(word);
  return all;
}

std::vector<std::string> hosts_of(const DdsOptions& options) {
  return words_of(options.server.empty() ? options.interface : options.server);
}

/// IPv4 of a name, as they are told; empty: none.
std::vector<std::string> look_up(const std::string& name) {
  addrinfo wanted{};
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_DGRAM;  // each address once
  addrinfo* list = nullptr;
  if (getaddrinfo(name.c_str(), nullptr, &wanted, &list) != 0) return {};
  std::vector<std::string> addresses;
  for (const addrinfo* at = list; at != nullptr; at = at->ai_next) {
    char text[NI_MAXHOST];
    if (getnameinfo(at->ai_addr, at->ai_addrlen, text, sizeof text, nullptr, 0, NI_NUMERICHOST) ==
        0)
      addresses.emplace_back(text);
  }
  freeaddrinfo(list);
  return addresses;
}

/// What it is for is said where it has none.
Result<std::vector<std::string>> addresses_of_host(const std::string& what,
                                                   const std::string& host) {
  std::vector<std::string> found = is_ipv4(host) ? std::vector{host} : look_up(host);
  if (!found.empty()) return found;
  return fail(Code::kInvalidInput, what + " '" + host +
                                       "' is neither an IPv4 address nor a name that has one "
                                       "here: see `getent ahostsv4 " +
                                       host + "`");
}

template <class Value>
void add_once(const Value& value, std::vector<Value>& all) {
  if (std::find(all.begin(), all.end(), value) == all.end()) all.push_back(value);
}

}  // namespace

bool is_ipv4(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

bool is_own_address(const std::string& text) {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return false;
  in_addr wanted{};
  inet_pton(AF_INET, text.c_str(), &wanted);
  bool found = false;
  for (const ifaddrs* at = list; at != nullptr; at = at->ifa_next) {
    if (at->ifa_addr == nullptr || at->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in address{};
    std::memcpy(&address, at->ifa_addr, sizeof address);
    found = found || address.sin_addr.s_addr == wanted.s_addr;
  }
  freeifaddrs(list);
  return found;
}

bool port_is_free(const std::string& interface, int port) {
  const int handle = socket(AF_INET, SOCK_DGRAM, 0);
  if (handle < 0) return false;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, interface.c_str(), &address.sin_addr);
  sockaddr generic{};
  static_assert(sizeof generic == sizeof address);
  std::memcpy(&generic, &address, sizeof address);
  const bool is_free = bind(handle, &generic, sizeof generic) == 0;
  close(handle);
  return is_free;
}

int server_port(const DdsOptions& options) {
  return options.discovery_port != 0
             ? options.discovery_port
             : kPortBase + kPortsPerDomain * options.domain + kServerPortOffset;
}

Result<std::vector<std::string>> addresses_of(const DdsOptions& options, bool is_client) {
  std::vector<std::string> addresses;
  if (is_client && options.server.empty() && !options.discovery_server.empty()) return addresses;
  for (const std::string& host : hosts_of(options)) {
    const auto found = addresses_of_host("server", host);
    if (!found) return found.error();
    for (const std::string& address : *found) add_once(address, addresses);
  }
  return addresses;
}

Result<std::vector<UdpPlace>> discovery_servers_of(const DdsOptions& options) {
  std::vector<UdpPlace> places;
  for (const std::string& word : words_of(options.discovery_server)) {
    const std::size_t colon = word.find(':');
    int port = kDiscoveryServerPort;
    if (colon != std::string::npos) {
      const char* const end = word.data() + word.size();
      const auto read = std::from_chars(word.data() + colon + 1, end, port);
      if (read.ec != std::errc() || read.ptr != end || port < 1 || port > kMaxPort)
        return fail(Code::kInvalidInput, "discovery server '" + word +
                                             "': the port behind the colon is not in 1..65535");
    }
    const auto found = addresses_of_host("discovery server", word.substr(0, colon));
    if (!found) return found.error();
    for (const std::string& address : *found) {
      in_addr ipv4{};
      inet_pton(AF_INET, address.c_str(), &ipv4);
      add_once(UdpPlace{ntohl(ipv4.s_addr), static_cast<std::uint16_t>(port)}, places);
    }
  }
  return places;
}

std::string looked_at(const DdsOptions& options) {
  const std::string hosts = options.server.empty() ? options.interface : options.server;
  if (options.discovery_server.empty()) return hosts;
  return (options.server.empty() ? "" : hosts + ", or ") +
         std::string("wherever the discovery server ") + options.discovery_server + " knows";
}

bool place_is_free(const DdsOptions& options, int port) {
  return port_is_free(options.interface, port) && port_is_free(options.interface, port + 1);
}

bool may_have_another_server(const DdsOptions& options) {
  return hosts_of(options).size() > 1 || !options.discovery_server.empty() ||
         !place_is_free(options, server_port(options) + kSecondPlace);
}

}  // namespace mortise
