#include "tests/network/domain.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

namespace mortise::test {
namespace {

// Their ports lie below those that the kernel gives to others.
constexpr int kDomains = 100, kFirstPort = 7400, kPorts = 250;

/// Does a socket hold a UDP port of it still? The kernel frees the name of a process that is ended
/// before its ports, and who ended the parent may not have waited for the child.
bool has_ports(int domain) {
  std::ifstream sockets("/proc/net/udp");
  std::string line;
  std::getline(sockets, line);  // the heading
  while (std::getline(sockets, line)) {
    const std::size_t colon = line.find(':', line.find(':') + 1);
    const int port = std::stoi(line.substr(colon + 1, 4), nullptr, 16);
    if (port >= kFirstPort + kPorts * domain && port < kFirstPort + kPorts * (domain + 1))
      return true;
  }
  return false;
}

/// A name in the network namespace, which lasts as long as any process has the socket: children
/// inherit it. Negative: somebody has it.
int take(int domain) {
  const int handle = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un named{};
  named.sun_family = AF_UNIX;
  const std::string name = "mortise-test-domain-" + std::to_string(domain);
  name.copy(named.sun_path + 1, name.size());  // a name that begins with zero is in no file system
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  const bool is_mine = bind(handle, reinterpret_cast<const sockaddr*>(&named), size) == 0;
  if (is_mine && !has_ports(domain)) return handle;
  close(handle);
  return -1;
}

}  // namespace

int take_domains(int count) {
  for (int tries = 0;; ++tries) {
    const int first = 1 + (static_cast<int>(getpid()) + tries) % (kDomains - count + 1);
    std::vector<int> taken;
    while (static_cast<int>(taken.size()) < count) {
      const int handle = take(first + static_cast<int>(taken.size()));
      if (handle < 0) break;
      taken.push_back(handle);
    }
    if (static_cast<int>(taken.size()) == count) return first;
    for (const int handle : taken) close(handle);
    if (tries % kDomains == kDomains - 1) std::this_thread::sleep_for(std::chrono::seconds(1));
  }
}

int own_domain() {
  static const testing::TestInfo* owner = nullptr;
  static int domain = 0;
  const testing::TestInfo* running = testing::UnitTest::GetInstance()->current_test_info();
  if (domain == 0 || running != owner) domain = take_domains(1);
  owner = running;
  return domain;
}

DdsOptions own_options(const std::string& session) {
  DdsOptions options;
  options.session = session;
  options.domain = own_domain();
  return options;
}

int spare_port(int domain, int index) { return kFirstPort + kPorts * domain + 200 + 5 * index; }

}  // namespace mortise::test
