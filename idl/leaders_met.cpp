#include "idl/leaders_met.h"

#include <fastrtps/utils/IPLocator.h>

#include "idl/participant.h"
#include "idl/terms.h"

namespace mortise {
namespace {

using eprosima::fastrtps::rtps::IPLocator;

std::string address_of(const eprosima::fastrtps::rtps::WriterDiscoveryInfo& writer) {
  const auto& locators = writer.info.remote_locators().unicast;
  if (locators.empty()) return "an unknown address";
  return IPLocator::toIPv4string(locators[0]) + ":" +
         std::to_string(IPLocator::getPhysicalPort(locators[0]));
}

}  // namespace

void LeadersMet::note(const eprosima::fastrtps::rtps::WriterDiscoveryInfo& writer) {
  if (told_term(writer, session_) == 0) return;
  const ClientKey key = client_key(writer.info.guid());
  const std::lock_guard lock(mutex_);
  if (!where_.emplace(key, address_of(writer)).second) return;
  order_.push_back(key);
  if (order_.size() <= kMost) return;
  where_.erase(order_.front());
  order_.pop_front();
}

bool LeadersMet::contains(const ClientKey& key) const {
  const std::lock_guard lock(mutex_);
  return where_.contains(key);
}

std::string LeadersMet::where(const ClientKey& key) const {
  const std::lock_guard lock(mutex_);
  const auto found = where_.find(key);
  return found == where_.end() ? std::string() : found->second;
}

}  // namespace mortise
