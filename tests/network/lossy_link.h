#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "common/base/result.h"

namespace mortise::test {

struct LinkSettings {
  double loss = 0.0, duplicate = 0.0;  ///< chance of each IP packet, either way
  double delay_s = 0.0;                ///< one way
  double jitter_s = 0.0;               ///< up to so much more: packets overtake each other
  std::uint64_t seed = 1;
};

/// Two network namespaces, side 0 and side 1, with nothing between them but a bad link: one TUN
/// device in each, and a thread that carries packets from one to the other. All in this process and
/// gone with the object. Needs the right to make network namespaces.
class LossyLink {
 public:
  /// Fails with one line where namespaces or TUN devices are not permitted.
  static Result<std::unique_ptr<LossyLink>> open(const LinkSettings& settings);
  ~LossyLink();

  /// A thread whose sockets, and those of the threads that it starts, are on that side.
  std::thread on_side(int side, std::function<void()> work) const;
  static std::string address(int side);

  std::uint64_t carried() const { return carried_; }
  std::uint64_t lost() const { return lost_; }

 private:
  struct Side {
    int space = -1, device = -1;
  };
  explicit LossyLink(const LinkSettings& settings) : settings_(settings) {}
  static Status enter(int side, Side& made);
  void carry();

  LinkSettings settings_;
  Side sides_[2];
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> carried_{0}, lost_{0};
  std::thread carrier_;
};

}  // namespace mortise::test
