#pragma once
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "idl/bell.h"
#include "idl/participant.h"

namespace mortise {

/// Knows which server leads the session, by the match with its answers and the term that its
/// writers carry. The highest term counts, of equal ones the newest: one that was killed and
/// started again is met before the old one's lease ends, and one that was overtaken may come back.
/// What was led by a higher term is never led by a lower one again. Servers of other sessions may
/// be met at the places where this one is looked for: what they say of theirs counts nothing here.
class ServerWatch final : public dds::DomainParticipantListener {
 public:
  using Prefix = eprosima::fastrtps::rtps::GuidPrefix_t;

  /// `arrivals` rings when the server says something, comes or goes; it must outlive the watch.
  explicit ServerWatch(Bell& arrivals) : arrivals_(arrivals) {}

  /// Before any thread of Fast DDS calls.
  void look_for(const std::string& session) { session_ = session; }
  /// The same; whoever is revoked leads nobody here, however high its term.
  void know(PeerIdentities* identities) { identities_ = identities; }

  struct Answer {
    bool lost = false;     ///< since the last call
    bool present = false;  ///< and hears us, on so many topics
    bool alone = false;    ///< no server is met, revoked and overtaken ones included
  };
  Answer take(int topics);
  /// The participant is gone, and another one comes: nobody is met. Terms are remembered.
  void part_from_all();
  /// Nothing that it says counts any more: overtaken, or its going was told by take(). Its last
  /// words may come after that, each topic by its own way.
  bool is_past(const Prefix& server) const;

  void on_participant_discovery(dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_publisher_discovery(dds::DomainParticipant*,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override;
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override;
  void on_data_available(dds::DataReader*) override { arrivals_.ring(); }

 private:
  struct Server {
    std::uint64_t term = 0, met = 0;
    bool answers = false, gone = false, revoked = false;
    int readers = 0;
  };
  void look_who_is_revoked();
  void choose();

  Bell& arrivals_;
  std::string session_;
  PeerIdentities* identities_ = nullptr;  ///< null: no security
  mutable std::mutex mutex_;
  std::map<Prefix, Server> servers_;
  std::uint64_t highest_term_ = 0, met_ = 0;
  bool lost_ = false, led_ = false;
  Prefix leader_;
};

}  // namespace mortise
