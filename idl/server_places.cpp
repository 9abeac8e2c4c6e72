#include "idl/server_places.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <sstream>

namespace mortise {
namespace {

// Well-known ports are 7400 + 250 domain + {0, 1, 10 + 2 i, 11 + 2 i}; 2 and 3 are nobody's.
constexpr int kPortBase = 7400, kPortsPerDomain = 250, kServerPortOffset = 2;

std::vector<std::string> hosts_of(const DdsOptions& options) {
  std::vector<std::string> hosts;
  std::stringstream words(options.server.empty() ? options.interface : options.server);
  for (std::string word; std::getline(words, word, ',');) hosts.push_back(word);
  return hosts;
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

Result<std::vector<std::string>> addresses_of(const DdsOptions& options) {
  std::vector<std::string> addresses;
  for (const std::string& host : hosts_of(options)) {
    const std::vector<std::string> found = is_ipv4(host) ? std::vector{host} : look_up(host);
    if (found.empty())
      return fail(Code::kInvalidInput,
                  "server '" + host +
                      "' is neither an IPv4 address nor a name that has one here: see `getent "
                      "ahostsv4 " +
                      host + "`");
    for (const std::string& address : found)
      if (std::find(addresses.begin(), addresses.end(), address) == addresses.end())
        addresses.push_back(address);
  }
  return addresses;
}

bool place_is_free(const DdsOptions& options, int port) {
  return port_is_free(options.interface, port) && port_is_free(options.interface, port + 1);
}

bool may_have_another_server(const DdsOptions& options) {
  return hosts_of(options).size() > 1 ||
         !place_is_free(options, server_port(options) + kSecondPlace);
}

}  // namespace mortise
