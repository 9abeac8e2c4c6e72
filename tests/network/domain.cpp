#include "tests/network/domain.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <string>
#include <thread>
#include <vector>

namespace mortise::test {
namespace {

// Their ports, 7400 + 250 * domain on, lie below those that the kernel gives to others.
constexpr int kDomains = 100;

/// A name in the network namespace, which lasts as long as any process has the socket: children
/// inherit it. Negative: somebody has it.
int take(int domain) {
  const int handle = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un named{};
  named.sun_family = AF_UNIX;
  const std::string name = "mortise-test-domain-" + std::to_string(domain);
  name.copy(named.sun_path + 1, name.size());  // a name that begins with zero is in no file system
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (bind(handle, reinterpret_cast<const sockaddr*>(&named), size) == 0) return handle;
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

int spare_port(int domain, int index) { return 7400 + 250 * domain + 200 + 5 * index; }

}  // namespace mortise::test
