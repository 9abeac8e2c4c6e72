#pragma once
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace mortise::test {

/// A UDP port of loopback where datagrams are only kept.
class UdpEar {
 public:
  UdpEar() {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof own;
    sockaddr generic{};
    std::memcpy(&generic, &own, sizeof own);
    bind(handle_, &generic, size);
    getsockname(handle_, &generic, &size);
    std::memcpy(&own, &generic, sizeof own);
    port_ = ntohs(own.sin_port);
  }
  ~UdpEar() { close(handle_); }
  UdpEar(const UdpEar&) = delete;
  UdpEar& operator=(const UdpEar&) = delete;
  int port() const { return port_; }  ///< 0: none could be had
  std::string place() const { return "127.0.0.1:" + std::to_string(port_); }
  /// The next datagram, empty when there is none for so long.
  std::vector<std::byte> next(int limit_ms = 5000) const {
    std::vector<std::byte> datagram(65536);
    pollfd ready{handle_, POLLIN, 0};
    const ssize_t size =
        poll(&ready, 1, limit_ms) > 0 ? recv(handle_, datagram.data(), datagram.size(), 0) : 0;
    datagram.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    return datagram;
  }
  void send(std::span<const std::byte> datagram, int port) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    sockaddr generic{};
    std::memcpy(&generic, &to, sizeof to);
    (void)sendto(handle_, datagram.data(), datagram.size(), 0, &generic, sizeof generic);
  }

 private:
  int handle_ = socket(AF_INET, SOCK_DGRAM, 0);
  int port_ = 0;
};

}  // namespace mortise::test
