#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "idl/leaders_met.h"
#include "idl/participant.h"

namespace mortise {

/// Hears who comes and goes, in threads of Fast DDS; take() asks what it heard. Also the listener
/// of the presence reader.
class Doorman final : public dds::DomainParticipantListener {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// Before any thread of Fast DDS calls; null: nobody proves anything.
  void know(PeerIdentities* identities) { identities_ = identities; }

  LeadersMet& leaders() { return leaders_; }
  /// Who has gone since, asked once a tick. A client that was not heard for its lease counts as
  /// gone after kTakesInDoubt more, and not at all if it is heard again by then: where this process
  /// stood still, its datagrams wait to be read.
  std::vector<ClientKey> take();
  /// 50 ms at 60 Hz: what waits is read within a tick or two, and others learn it in 1.1 leases.
  static constexpr int kTakesInDoubt = 3;
  /// Who was not let in since, and why, in words. Also those of whom nothing was proven in time:
  /// where the other end is to begin the handshake and does not like our certificate, nobody tells
  /// us. Not who is revoked: PeerIdentities tells of them.
  std::vector<std::string> take_turned_away();
  /// Says how many encrypted datagrams came a second time, once a second, if any did; `in_all`: of
  /// the whole session. For one thread.
  void tell_repeats(std::uint64_t in_all, std::vector<std::string>& texts);

  void on_participant_discovery(dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void onParticipantAuthentication(
      dds::DomainParticipant*,
      eprosima::fastrtps::rtps::ParticipantAuthenticationInfo&& info) override;
  /// What an observer would send is not heard, whatever its own end lets pass: its permissions have
  /// no increments. Nobody can tell it so.
  void on_publisher_discovery(dds::DomainParticipant*,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  /// MANUAL_BY_TOPIC: also when other clients live, unlike automatic liveliness (Fast DDS #4373).
  void on_liveliness_changed(dds::DataReader*, const dds::LivelinessChangedStatus& status) override;

 private:
  struct Unproven {
    Time since = Time::max();  ///< max: proven, or said
    PeerIdentities::WhyNot why;
  };
  void add(const eprosima::fastrtps::rtps::GUID_t& guid);
  void turn_away(const ClientKey& client, const std::string& text);

  LeadersMet leaders_;
  std::mutex mutex_;
  std::vector<ClientKey> gone_;
  std::map<ClientKey, int> in_doubt_;  // not heard for its lease; asked so often since
  std::vector<std::string> turned_away_;
  std::map<ClientKey, Unproven> unproven_;
  PeerIdentities* identities_ = nullptr;
  std::uint64_t repeats_told_ = 0;
  Time repeats_told_at_{};
};

}  // namespace mortise
