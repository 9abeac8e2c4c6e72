#include "idl/doorman.h"

#include <string>
#include <utility>

namespace mortise {

namespace rtps = eprosima::fastrtps::rtps;

void Doorman::on_participant_discovery(dds::DomainParticipant*,
                                       rtps::ParticipantDiscoveryInfo&& info) {
  using Info = rtps::ParticipantDiscoveryInfo;
  const ClientKey client = client_key(info.info.m_guid);
  if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT) {
    add(info.info.m_guid);
    if (!identities_) return;
    identities_->parted(client);
    const std::lock_guard lock(mutex_);
    unproven_.erase(client);
  } else if (identities_) {
    const std::string subject = announced(info, "dds.cert.sn");
    if (!subject.empty()) identities_->met(client, subject);
    const std::lock_guard lock(mutex_);
    unproven_.emplace(
        client,
        Unproven{Time::clock::now(), identities_->why_not(subject, announced(info, "dds.ca.sn"))});
  }
}

void Doorman::onParticipantAuthentication(dds::DomainParticipant*,
                                          rtps::ParticipantAuthenticationInfo&& info) {
  const std::lock_guard lock(mutex_);
  const ClientKey client = client_key(info.guid);
  Unproven& unproven = unproven_[client];
  unproven.since = Time::max();  // answered, either way
  if (info.status != rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT)
    turn_away(client, " was not let in: " + unproven.why.text);
}

void Doorman::on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) {
  leaders_.note(info);
  if (!identities_ || info.status != rtps::WriterDiscoveryInfo::DISCOVERED_WRITER ||
      info.info.topicName().to_string() != row_of(Topic::kIncrement).topic)
    return;
  const ClientKey client = client_key(info.info.guid());
  const std::optional<Identity> identity = identities_->identity_of(client);
  if (!identity || identity->role != "observer") return;
  const std::lock_guard lock(mutex_);
  turned_away_.push_back(identities_->whose(client) +
                         " does not let its owner send increments: none is heard");
}

void Doorman::on_liveliness_changed(dds::DataReader*, const dds::LivelinessChangedStatus& status) {
  const ClientKey client = client_key(rtps::iHandle2GUID(status.last_publication_handle));
  const std::lock_guard lock(mutex_);
  if (status.not_alive_count_change > 0)
    in_doubt_.emplace(client, 0);
  else if (status.alive_count_change > 0)
    in_doubt_.erase(client);
  else if (status.alive_count_change < 0)
    gone_.push_back(client);
}

std::vector<ClientKey> Doorman::take() {
  const std::lock_guard lock(mutex_);
  for (auto doubt = in_doubt_.begin(); doubt != in_doubt_.end();) {
    if (++doubt->second <= kTakesInDoubt) {
      ++doubt;
      continue;
    }
    gone_.push_back(doubt->first);
    doubt = in_doubt_.erase(doubt);
  }
  return std::exchange(gone_, {});
}

std::vector<std::string> Doorman::take_turned_away() {
  using std::chrono::seconds;
  // Where messages of a handshake get lost, it is begun anew after a second, and may be again.
  constexpr seconds kTimeToProve{2}, kTimeInDoubt{10};
  const std::lock_guard lock(mutex_);
  const Time now = Time::clock::now();
  for (auto& [client, unproven] : unproven_) {
    const bool is_certain = unproven.why.is_certain;
    if (unproven.since == Time::max() ||
        now - unproven.since < (is_certain ? kTimeToProve : kTimeInDoubt))
      continue;
    unproven.since = Time::max();  // said once
    turn_away(client, is_certain
                          ? " was not let in: " + unproven.why.text
                          : " has not proven who it is in " + std::to_string(kTimeInDoubt.count()) +
                                " s: " + unproven.why.text + ", or its messages get lost");
  }
  return std::exchange(turned_away_, {});
}

void Doorman::tell_repeats(std::uint64_t in_all, std::vector<std::string>& texts) {
  const Time now = Time::clock::now();
  if (in_all == repeats_told_ || now - repeats_told_at_ < std::chrono::seconds(1)) return;
  repeats_told_at_ = now;
  texts.push_back(std::to_string(in_all - std::exchange(repeats_told_, in_all)) +
                  " encrypted datagrams came a second time and were dropped: a recording, or a "
                  "net that doubles");
}

void Doorman::add(const rtps::GUID_t& guid) {
  const std::lock_guard lock(mutex_);
  in_doubt_.erase(client_key(guid));
  gone_.push_back(client_key(guid));
}

void Doorman::turn_away(const ClientKey& client, const std::string& text) {
  if (identities_->is_revoked(client)) return;
  turned_away_.push_back(identities_->whose(client) + text);
}

}  // namespace mortise
