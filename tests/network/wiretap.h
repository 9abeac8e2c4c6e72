#pragma once
#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <netinet/in.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <vector>

namespace mortise::test {

/// Hears all that goes to the server's ports, or to so many from `port` on.
class Wiretap {
 public:
  explicit Wiretap(int port, int ports = 2)
      : port_(port), ports_(ports), handle_(socket(AF_PACKET, SOCK_DGRAM, htons(ETH_P_IP))) {
    const int room = 1 << 24;
    setsockopt(handle_, SOL_SOCKET, SO_RCVBUFFORCE, &room, sizeof room);
  }
  ~Wiretap() { close(handle_); }
  bool works() const { return handle_ >= 0; }
  struct Heard {
    int port;
    std::vector<char> bytes;
  };
  /// What was heard so far: it ends, however much others say on this machine.
  std::vector<Heard> take() {
    std::vector<Heard> all;
    std::vector<char> packet(65536);
    for (ssize_t size; (size = recv(handle_, packet.data(), packet.size(), MSG_DONTWAIT)) > 0;) {
      iphdr ip{};
      udphdr udp{};
      std::memcpy(&ip, packet.data(), sizeof ip);
      const std::size_t at = ip.ihl * 4u;
      if (ip.protocol != IPPROTO_UDP || static_cast<std::size_t>(size) < at + sizeof udp) continue;
      std::memcpy(&udp, packet.data() + at, sizeof udp);
      const int port = ntohs(udp.dest);
      if (port < port_ || port >= port_ + ports_) continue;
      all.push_back({port, {packet.data() + at + sizeof udp, packet.data() + size}});
    }
    return all;
  }

 private:
  int port_, ports_, handle_;
};

/// To the same ports, by somebody else.
inline void send_again(const std::vector<Wiretap::Heard>& heard) {
  const int out = socket(AF_INET, SOCK_DGRAM, 0);
  for (const Wiretap::Heard& one : heard) {
    sockaddr_in in{};
    in.sin_family = AF_INET;
    in.sin_port = htons(static_cast<std::uint16_t>(one.port));
    in.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    sockaddr to{};
    std::memcpy(&to, &in, sizeof in);
    sendto(out, one.bytes.data(), one.bytes.size(), 0, &to, sizeof to);
  }
  close(out);
}

}  // namespace mortise::test
