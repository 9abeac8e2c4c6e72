#pragma once
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#include <cstddef>
#include <deque>
#include <map>
#include <mutex>
#include <string>

#include "common/messages/channel.h"

namespace mortise {

/// Which participants lead the session, or have led it, as discovery tells: those that write its
/// answers under a term. Nobody else's ticks count. They are kept when they go, because their last
/// ticks may be taken later. Thread safe.
class LeadersMet {
 public:
  static constexpr std::size_t kMost = 256;  ///< the latest ones

  /// Before any thread of Fast DDS calls.
  void look_for(const std::string& session) { session_ = session; }
  void note(const eprosima::fastrtps::rtps::WriterDiscoveryInfo& writer);
  bool contains(const ClientKey& key) const;
  /// Its address, "10.0.0.5:7403"; empty: not met.
  std::string where(const ClientKey& key) const;

 private:
  std::string session_;
  mutable std::mutex mutex_;
  std::map<ClientKey, std::string> where_;
  std::deque<ClientKey> order_;
};

}  // namespace mortise
