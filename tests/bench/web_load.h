#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/bench/session_load.h"
#include "tests/network/page_client.h"

namespace mortise::bench {

/// What the first thread of a process, in a server the one that ticks, spent on a core and in
/// waiting for one, by the kernel's books. NAN where it keeps none.
struct ThreadTime {
  double ran_s, waited_s;
};
ThreadTime first_thread_of(pid_t process);

/// The gateway as a program, beside a server.
class BenchGateway {
 public:
  explicit BenchGateway(BenchServer& server);
  int port() const { return port_; }  ///< 0: it did not start
  const std::string& token() const { return token_; }
  double resident_mb() const;
  double cpu_s() const { return program_->cpu_s(); }
  Json statistics() const;

 private:
  std::unique_ptr<test::Program> program_;
  std::string token_;
  int port_ = 0;
};

/// Pages without a browser, turned by one thread: each looks on, and says or does something at
/// `rate_hz`.
class PageLoad {
 public:
  struct Shape {
    int pages = 16;
    double rate_hz = 60.0;
    bool moves = false;  ///< a part each, to and fro; else it says where it looks from
    int first_part = 1;  ///< of the moving ones, by number from 0
    int stopped = 0;     ///< further pages that read nothing after a while
    double stop_at_s = 1.0;
  };
  /// What one page saw.
  struct Seen {
    std::uint64_t frames = 0, bytes = 0;
    bool open = false;
  };
  PageLoad(const BenchGateway& gateway, const Shape& shape);
  ~PageLoad();

  bool joined() const { return joined_; }  ///< all of them, and each with its part when it moves
  std::string why_not() const { return why_not_; }
  /// From here on it counts what is seen.
  void mark() { marked_ = true; }
  std::vector<Seen> seen() const;  ///< since mark(), after stop()
  void stop();

 private:
  struct Page {
    std::unique_ptr<test::PageClient> client;
    std::uint32_t part = 0;
    std::uint64_t frames_before = 0, bytes_before = 0, beats = 0;
  };
  void run();
  void beat(Page& page, bool first);

  Shape shape_;
  std::vector<Page> pages_, stopped_;
  std::atomic<bool> stop_{false}, marked_{false};
  bool joined_ = false;
  std::string why_not_;
  std::thread thread_;
};

}  // namespace mortise::bench
