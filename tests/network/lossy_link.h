#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/base/result.h"

namespace mortise::test {

struct LinkSettings {
  double loss = 0.0, duplicate = 0.0;  ///< chance of each IP packet, either way
  double delay_s = 0.0;                ///< one way
  double jitter_s = 0.0;               ///< up to so much more: packets overtake each other
  std::uint64_t seed = 1;
};

/// Network namespaces, two unless said otherwise, with nothing between them but a bad link: one TUN
/// device in each, and a thread that carries packets by their destination. All in this process and
/// gone with the object. Needs the right to make network namespaces.
class LossyLink {
 public:
  /// Fails with one line where namespaces or TUN devices are not permitted.
  static Result<std::unique_ptr<LossyLink>> open(const LinkSettings& settings, int sides = 2);
  ~LossyLink();

  /// A thread whose sockets, and those of the threads that it starts, are on that side.
  std::thread on_side(int side, std::function<void()> work) const;
  static std::string address(int side);
  /// Nothing passes between these sides and the others; none: all is whole.
  void cut(const std::set<int>& apart);

  std::uint64_t carried() const { return carried_; }
  std::uint64_t lost() const { return lost_; }

 private:
  struct Side {
    int space = -1, device = -1;
  };
  LossyLink(const LinkSettings& settings, int sides)
      : settings_(settings), sides_(static_cast<std::size_t>(sides)) {}
  static Status enter(int side, Side& made);
  void carry();
  bool parted(int a, int b) const { return ((apart_ >> a ^ apart_ >> b) & 1) != 0; }

  LinkSettings settings_;
  std::vector<Side> sides_;
  std::atomic<unsigned> apart_{0};  ///< bit i: side i
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> carried_{0}, lost_{0};
  std::thread carrier_;
};

}  // namespace mortise::test
