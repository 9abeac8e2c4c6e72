#include "idl/server_watch.h"

#include <algorithm>
#include <utility>

namespace mortise {

namespace rtps = eprosima::fastrtps::rtps;

namespace {

rtps::GuidPrefix_t prefix_of(const rtps::InstanceHandle_t& handle) {
  return rtps::iHandle2GUID(handle).guidPrefix;
}

}  // namespace

void ServerWatch::on_participant_discovery(dds::DomainParticipant*,
                                           rtps::ParticipantDiscoveryInfo&& info) {
  using Info = rtps::ParticipantDiscoveryInfo;
  if (identities_ == nullptr) return;
  const ClientKey participant = client_key(info.info.m_guid);
  if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT)
    return identities_->parted(participant);  // or whoever announces much fills the memory
  const std::string subject = announced(info, "dds.cert.sn");
  if (!subject.empty()) identities_->met(participant, subject);
}

void ServerWatch::on_publisher_discovery(dds::DomainParticipant*,
                                         rtps::WriterDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t term = told_term(info, session_);
  if (term == 0) return;
  servers_[info.info.guid().guidPrefix].term = term;
  look_who_is_revoked();
  choose();
}

void ServerWatch::on_subscription_matched(dds::DataReader*,
                                          const dds::SubscriptionMatchedStatus& status) {
  const std::lock_guard lock(mutex_);
  Server& server = servers_[prefix_of(status.last_publication_handle)];
  server.answers = status.current_count_change > 0;
  if (server.answers) server.met = ++met_;
  choose();
  arrivals_.ring();
}

void ServerWatch::on_publication_matched(dds::DataWriter*,
                                         const dds::PublicationMatchedStatus& status) {
  const std::lock_guard lock(mutex_);
  servers_[prefix_of(status.last_subscription_handle)].readers += status.current_count_change;
  arrivals_.ring();
}

ServerWatch::Answer ServerWatch::take(int topics) {
  if (identities_ != nullptr) (void)identities_->newly_revoked();  // which looks at the list
  const std::lock_guard lock(mutex_);
  if (identities_ != nullptr) {
    look_who_is_revoked();
    choose();
  }
  const auto leader = servers_.find(leader_);
  const bool present = led_ && leader != servers_.end() && leader->second.readers >= topics;
  bool alone = true;
  for (auto& [prefix, server] : servers_) {
    server.gone = server.met > 0 && !server.answers;
    alone = alone && !server.answers;
  }
  return {std::exchange(lost_, false), present, alone};
}

void ServerWatch::part_from_all() {
  const std::lock_guard lock(mutex_);
  for (auto& [prefix, server] : servers_) {
    server.answers = false;
    server.readers = 0;
  }
  choose();
}

bool ServerWatch::is_past(const Prefix& server) const {
  const std::lock_guard lock(mutex_);
  const auto found = servers_.find(server);
  return found != servers_.end() &&
         (found->second.gone || found->second.revoked || found->second.term < highest_term_);
}

// Of one that is gone the last word counts.
void ServerWatch::look_who_is_revoked() {
  highest_term_ = 0;
  for (auto& [prefix, server] : servers_) {
    const auto identity =
        identities_ == nullptr
            ? std::nullopt
            : identities_->identity_of(client_key({prefix, rtps::c_EntityId_RTPSParticipant}));
    if (identity) server.revoked = identities_->is_revoked(*identity);
    if (!server.revoked) highest_term_ = std::max(highest_term_, server.term);
  }
}

void ServerWatch::choose() {
  const Server* best = nullptr;
  Prefix leader;
  for (const auto& [prefix, server] : servers_) {
    if (!server.answers || server.revoked || server.term < highest_term_) continue;
    if (best != nullptr && server.met < best->met) continue;
    best = &server;
    leader = prefix;
  }
  const bool same = led_ == (best != nullptr) && (!led_ || leader == leader_);
  if (same) return;
  lost_ = lost_ || led_;
  led_ = best != nullptr;
  leader_ = leader;
}

}  // namespace mortise
