#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "idl/participant.h"

namespace mortise {

namespace rtps = eprosima::fastrtps::rtps;

/// Knows which server leads the session, by the match with its answers and the term that its
/// writers carry. The highest term counts, of equal ones the newest: one that was killed and
/// started again is met before the old one's lease ends, and one that was overtaken may come back.
/// What was led by a higher term is never led by a lower one again. Servers of other sessions may
/// be met at the places where this one is looked for: what they say of theirs counts nothing here.
class ServerWatch final : public dds::DomainParticipantListener {
 public:
  /// Before any thread of Fast DDS calls.
  void look_for(const std::string& session) { session_ = session; }
  /// The same; whoever is revoked leads nobody here, however high its term.
  void know(PeerIdentities* identities) { identities_ = identities; }
  void on_participant_discovery(dds::DomainParticipant*,
                                rtps::ParticipantDiscoveryInfo&& info) override {
    using Info = rtps::ParticipantDiscoveryInfo;
    if (identities_ == nullptr) return;
    const ClientKey participant = client_key(info.info.m_guid);
    if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT)
      return identities_->parted(participant);  // or whoever announces much fills the memory
    const std::string subject = announced(info, "dds.cert.sn");
    if (!subject.empty()) identities_->met(participant, subject);
  }
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) override {
    const std::lock_guard lock(mutex_);
    const std::uint64_t term = told_term(info, session_);
    if (term == 0) return;
    servers_[info.info.guid().guidPrefix].term = term;
    look_who_is_revoked();
    choose();
  }
  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override {
    const std::lock_guard lock(mutex_);
    Server& server = servers_[prefix_of(status.last_publication_handle)];
    server.answers = status.current_count_change > 0;
    if (server.answers) server.met = ++met_;
    choose();
  }
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    const std::lock_guard lock(mutex_);
    servers_[prefix_of(status.last_subscription_handle)].readers += status.current_count_change;
  }
  struct Answer {
    bool lost = false;     ///< since the last call
    bool present = false;  ///< and hears us, on so many topics
  };
  Answer take(int topics) {
    if (identities_ != nullptr) (void)identities_->newly_revoked();  // which looks at the list
    const std::lock_guard lock(mutex_);
    if (identities_ != nullptr) {
      look_who_is_revoked();
      choose();
    }
    const auto leader = servers_.find(leader_);
    const bool present = led_ && leader != servers_.end() && leader->second.readers >= topics;
    for (auto& [prefix, server] : servers_) server.gone = server.met > 0 && !server.answers;
    return {std::exchange(lost_, false), present};
  }
  /// Nothing that it says counts any more: overtaken, or its going was told by take(). Its last
  /// words may come after that, each topic by its own way.
  bool is_past(const rtps::GuidPrefix_t& server) const {
    const std::lock_guard lock(mutex_);
    const auto found = servers_.find(server);
    return found != servers_.end() &&
           (found->second.gone || found->second.revoked || found->second.term < highest_term_);
  }

 private:
  struct Server {
    std::uint64_t term = 0, met = 0;
    bool answers = false, gone = false, revoked = false;
    int readers = 0;
  };
  static rtps::GuidPrefix_t prefix_of(const rtps::InstanceHandle_t& handle) {
    return rtps::iHandle2GUID(handle).guidPrefix;
  }
  /// Of one that is gone the last word counts.
  void look_who_is_revoked() {
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
  void choose() {
    const Server* best = nullptr;
    rtps::GuidPrefix_t leader;
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

  std::string session_;
  PeerIdentities* identities_ = nullptr;  ///< null: no security
  mutable std::mutex mutex_;
  std::map<rtps::GuidPrefix_t, Server> servers_;
  std::uint64_t highest_term_ = 0, met_ = 0;
  bool lost_ = false, led_ = false;
  rtps::GuidPrefix_t leader_;
};

}  // namespace mortise
