#pragma once
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace mortise::test {

using Datagram = std::vector<std::uint8_t>;

/// Hears what comes to a port of loopback (0: says only), and says what it is told to.
class Socket {
 public:
  explicit Socket(int port) : handle_(socket(AF_INET, SOCK_DGRAM, 0)) {
    if (port != 0) {
      const sockaddr own = address(port);
      bound_ = bind(handle_, &own, sizeof own) == 0;
    }
    const timeval limit{0, 100'000};
    setsockopt(handle_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  }
  ~Socket() { close(handle_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  bool bound() const { return bound_; }
  Datagram receive() {
    Datagram datagram(65536);
    const ssize_t size = recv(handle_, datagram.data(), datagram.size(), 0);
    datagram.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return datagram;
  }
  void send(const Datagram& datagram, int port) {
    const sockaddr to = address(port);
    sendto(handle_, datagram.data(), datagram.size(), 0, &to, sizeof to);
  }

 private:
  static sockaddr address(int port) {
    sockaddr_in in{};
    in.sin_family = AF_INET;
    in.sin_port = htons(static_cast<std::uint16_t>(port));
    in.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    sockaddr out{};
    std::memcpy(&out, &in, sizeof in);
    return out;
  }
  int handle_;
  bool bound_ = false;
};

/// Datagrams that came to these ports while their sockets were full.
inline std::uint64_t overflowed_at(int port, int ports) {
  std::ifstream table("/proc/net/udp");
  std::uint64_t all = 0;
  std::string line;
  for (std::getline(table, line); std::getline(table, line);) {
    std::istringstream words(line);
    std::string number, local;
    words >> number >> local;
    const int at = std::stoi(local.substr(local.find(':') + 1), nullptr, 16);
    if (at >= port && at < port + ports)
      all += std::stoull(line.substr(line.rfind(' ', line.find_last_not_of(' ')) + 1));
  }
  return all;
}

/// One to four changes behind the header of RTPS, which holds who speaks.
inline Datagram mutate(Datagram datagram, std::mt19937_64& random) {
  for (std::uint64_t change = 1 + random() % 4; change-- > 0 && datagram.size() > 24;) {
    const std::size_t at = 20 + random() % (datagram.size() - 20);
    switch (random() % 4) {
      case 0:
        datagram[at] = static_cast<std::uint8_t>(random());
        break;
      case 1:
        datagram[at] = static_cast<std::uint8_t>(datagram[at] ^ (1u << random() % 8));
        break;
      case 2:
        datagram.resize(at);
        break;
      default:
        std::memset(datagram.data() + (at & ~std::size_t{3}), 0xff,
                    std::min<std::size_t>(4, datagram.size() - (at & ~std::size_t{3})));
    }
  }
  return datagram;
}

}  // namespace mortise::test
