#include "tests/network/lossy_link.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if.h>
#include <linux/if_tun.h>
#include <netinet/in.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <queue>
#include <random>
#include <vector>

namespace mortise::test {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kMaxPacket_bytes = 2048;  // above the device's 1500
constexpr std::size_t kMaxUnderWay = 65536;

Status broken(const std::string& what) {
  return fail(Code::kRuntime, what + ": " + std::strerror(errno));
}

sockaddr ipv4(const std::string& text) {
  sockaddr_in in{};
  in.sin_family = AF_INET;
  inet_pton(AF_INET, text.c_str(), &in.sin_addr);
  sockaddr out{};
  std::memcpy(&out, &in, sizeof in);
  return out;
}

/// Gives a device of this namespace its address (none: keeps it) and switches it on.
bool bring_up(const char* device, const std::string& address) {
  const int handle = socket(AF_INET, SOCK_DGRAM, 0);
  if (handle < 0) return false;
  ifreq request{};
  std::strncpy(request.ifr_name, device, IFNAMSIZ - 1);
  bool done = true;
  if (!address.empty()) {
    request.ifr_addr = ipv4(address);
    done = done && ioctl(handle, SIOCSIFADDR, &request) == 0;
    request.ifr_netmask = ipv4("255.255.255.0");
    done = done && ioctl(handle, SIOCSIFNETMASK, &request) == 0;
  }
  request.ifr_flags = IFF_UP | IFF_RUNNING;
  done = done && ioctl(handle, SIOCSIFFLAGS, &request) == 0;
  close(handle);
  return done;
}

struct Packet {
  Clock::time_point due;
  std::uint64_t number = 0;  ///< of two that are due at once the first goes first
  int to = 0;
  std::vector<char> bytes;
  bool operator<(const Packet& other) const {  // the queue's top is the largest
    return due != other.due ? due > other.due : number > other.number;
  }
};

/// Side that an IPv4 packet goes to, by the last number of its address; -1: none.
int destination(const std::vector<char>& packet, ssize_t size) {
  constexpr std::size_t kDestination = 16;  // RFC 791
  const auto byte = [&](std::size_t i) {
    return static_cast<unsigned char>(packet[kDestination + i]);
  };
  if (size < 20 || packet[0] >> 4 != 4 || byte(0) != 10 || byte(1) != 78 || byte(2) != 0) return -1;
  return byte(3) - 1;
}

}  // namespace

void LossyLink::cut(const std::set<int>& apart) {
  unsigned bits = 0;
  for (const int side : apart) bits |= 1u << side;
  apart_ = bits;
}

std::string LossyLink::address(int side) { return "10.78.0." + std::to_string(1 + side); }

Status LossyLink::enter(int side, Side& made) {
  if (unshare(CLONE_NEWNET) != 0) return broken("a network namespace is not permitted");
  made.space = ::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC);
  if (made.space < 0) return broken("/proc/thread-self/ns/net");
  made.device = ::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (made.device < 0) return broken("/dev/net/tun");
  ifreq request{};
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  std::strncpy(request.ifr_name, "link0", IFNAMSIZ - 1);
  if (ioctl(made.device, TUNSETIFF, &request) != 0) return broken("a TUN device is not permitted");
  if (!bring_up("link0", address(side)) || !bring_up("lo", "")) {
    return broken("the TUN device cannot be switched on");
  }
  return ok();
}

Result<std::unique_ptr<LossyLink>> LossyLink::open(const LinkSettings& settings, int sides) {
  std::unique_ptr<LossyLink> link(new LossyLink(settings, sides));
  for (int side = 0; side < sides; ++side) {
    Status status = ok();
    std::thread([&] { status = enter(side, link->sides_[static_cast<std::size_t>(side)]); }).join();
    if (!status) return status.error();
  }
  link->carrier_ = std::thread([made = link.get()] { made->carry(); });
  return link;
}

LossyLink::~LossyLink() {
  stop_ = true;
  if (carrier_.joinable()) carrier_.join();
  for (const Side& side : sides_) {
    if (side.device >= 0) close(side.device);
    if (side.space >= 0) close(side.space);
  }
}

std::thread LossyLink::on_side(int side, std::function<void()> work) const {
  return std::thread(
      [space = sides_[static_cast<std::size_t>(side)].space, work = std::move(work)] {
        if (setns(space, CLONE_NEWNET) == 0) work();
      });
}

void LossyLink::carry() {
  std::mt19937_64 random(settings_.seed);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  std::priority_queue<Packet> under_way;
  std::uint64_t number = 0;
  std::vector<char> buffer(kMaxPacket_bytes);
  const int sides = static_cast<int>(sides_.size());
  std::vector<pollfd> polled;
  for (const Side& side : sides_) polled.push_back({side.device, POLLIN, 0});
  while (!stop_) {
    // 1. Wait for a packet, or until one is due.
    const Clock::time_point wake = Clock::now() + std::chrono::milliseconds(20);
    const Clock::time_point until = under_way.empty() ? wake : std::min(wake, under_way.top().due);
    const auto wait =
        std::max(Clock::duration::zero(), Clock::duration(until - Clock::now())).count();
    const timespec limit{0, static_cast<long>(wait)};
    ppoll(polled.data(), polled.size(), &limit, nullptr);
    // 2. Take what came, lose some, double some.
    for (int from = 0; from < sides; ++from) {
      for (;;) {
        const ssize_t size =
            read(polled[static_cast<std::size_t>(from)].fd, buffer.data(), buffer.size());
        if (size <= 0) break;
        const int to = destination(buffer, size);
        if (to < 0 || to >= sides || to == from) continue;  // nobody's, multicast
        for (int copy = chance(random) < settings_.duplicate ? 2 : 1; copy > 0; --copy) {
          if (chance(random) < settings_.loss || under_way.size() >= kMaxUnderWay ||
              parted(from, to)) {
            ++lost_;
            continue;
          }
          const std::chrono::duration<double> takes(settings_.delay_s +
                                                    settings_.jitter_s * chance(random));
          under_way.push({Clock::now() + std::chrono::duration_cast<Clock::duration>(takes),
                          ++number,
                          to,
                          {buffer.begin(), buffer.begin() + size}});
        }
      }
    }
    // 3. Hand over what is due.
    while (!under_way.empty() && under_way.top().due <= Clock::now()) {
      const Packet& packet = under_way.top();
      carried_ += write(polled[static_cast<std::size_t>(packet.to)].fd, packet.bytes.data(),
                        packet.bytes.size()) > 0;
      under_way.pop();
    }
  }
}

}  // namespace mortise::test
