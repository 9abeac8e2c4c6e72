#include "idl/directory.h"

#include <fastrtps/utils/IPLocator.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <tuple>

#include "idl/chunks.h"
#include "idl/convert.h"
#include "idl/participant.h"
#include "mortisePubSubTypes.h"

namespace mortise {
namespace {

namespace rtps = eprosima::fastrtps::rtps;
const std::string kPartition = partition_of("");

/// What a server's endpoints say: in which session, and whether it leads.
class Endpoints final : public dds::DomainParticipantListener {
 public:
  struct Server {
    KnownServer told;
    bool answers = false, takes = false;
  };
  void on_participant_discovery(dds::DomainParticipant*,
                                rtps::ParticipantDiscoveryInfo&& info) override {
    using Info = rtps::ParticipantDiscoveryInfo;
    const std::lock_guard lock(mutex_);
    const rtps::GuidPrefix_t& prefix = info.info.m_guid.guidPrefix;
    if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT) {
      servers_.erase(prefix);
      return;
    }
    for (const rtps::Locator_t& place : info.info.metatraffic_locators.unicast) {
      KnownServer& server = servers_[prefix].told;
      server.address = rtps::IPLocator::toIPv4string(place);
      server.port = rtps::IPLocator::getPhysicalPort(place);
    }
  }
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) override {
    const std::lock_guard lock(mutex_);
    const bool here = info.status != rtps::WriterDiscoveryInfo::REMOVED_WRITER;
    const auto found = servers_.find(info.info.guid().guidPrefix);
    if (!here && found == servers_.end()) return;
    Server& server = servers_[info.info.guid().guidPrefix];
    const std::string topic = info.info.topicName().to_string();
    if (topic == row_of(Topic::kAnswers).topic) server.answers = here;
    if (topic == row_of(Topic::kTaken).topic) server.takes = here;
    const auto& user_data = info.info.m_qos.m_userData.data_vec();
    server.told.term = std::max(server.told.term, term_of(user_data));
    server.told.version = version_of(user_data);
    for (const std::string& partition : info.info.m_qos.m_partition.names())
      if (partition.starts_with(kPartition))
        server.told.session = partition.substr(kPartition.size());
  }
  std::map<rtps::GuidPrefix_t, Server> servers() const {
    const std::lock_guard lock(mutex_);
    return servers_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<rtps::GuidPrefix_t, Server> servers_;
};

class DdsDirectory final : public Directory {
 public:
  Status open(const DdsOptions& options) {
    session_ = options.session;
    auto participant = Participant::open(options, Participant::Side::kDirectory, &endpoints_);
    if (!participant) return participant.error();
    participant_ = std::move(participant.value());
    Status status = ok();
    participant_->open_reader<wire::SnapshotPubSubType>(Topic::kSnapshot, nullptr, snapshots_,
                                                        status);
    participant_->open_reader<wire::PulsePubSubType>(Topic::kPulse, nullptr, pulses_, status);
    if (!status && !options.keys.empty() && options.session == kEverySession)
      return fail(status.error().code, status.error().text + ": are the keys in " + options.keys +
                                           " for one session only? Then name it");
    return status;
  }

  std::vector<KnownServer> known() override {
    listen();
    std::map<std::string, std::uint64_t> highest_term;
    const auto servers = endpoints_.servers();
    for (const auto& [prefix, server] : servers)
      if (server.answers)
        highest_term[server.told.session] =
            std::max(highest_term[server.told.session], server.told.term);
    std::vector<KnownServer> all;
    for (const auto& [prefix, server] : servers) {
      if (!server.answers && !server.takes) continue;  // or not yet
      if (session_ != kEverySession && server.told.session != session_) continue;
      all.push_back(server.told);
      KnownServer& known = all.back();
      known.place = !server.answers                            ? KnownServer::Place::kStandsBy
                    : known.term < highest_term[known.session] ? KnownServer::Place::kOvertaken
                                                               : KnownServer::Place::kLeads;
      const auto found = heard_.find(prefix);
      if (found == heard_.end()) continue;
      known.parts = found->second.parts;
      known.tick_rate_hz = found->second.tick_rate_hz;
      known.pulse = found->second.pulse;
    }
    std::sort(all.begin(), all.end(), [](const KnownServer& a, const KnownServer& b) {
      return std::tie(a.session, a.address, a.port) < std::tie(b.session, b.address, b.port);
    });
    return all;
  }

 private:
  struct Heard {
    ChunkCollector<wire::Snapshot> collector;
    std::optional<std::size_t> parts;
    std::optional<double> tick_rate_hz;
    std::optional<SessionPulse> pulse;
  };

  template <class Sample, class Action>
  void take_each(dds::DataReader* reader, Action action) {
    take_all<Sample>(*reader, [&](const Sample& sample, const rtps::GUID_t& writer) {
      action(sample, heard_[writer.guidPrefix]);
    });
  }

  /// What is malformed is left out: then it is not known.
  void listen() {
    take_each<wire::Snapshot>(snapshots_, [](const wire::Snapshot& sample, Heard& heard) {
      const auto chunks = heard.collector.add(sample);
      if (!chunks) return;
      std::size_t parts = 0;
      for (const wire::Snapshot& chunk : *chunks) {
        const Result<Snapshot> read = from_wire(chunk);
        if (!read) return;
        parts += read->parts.size();
        heard.tick_rate_hz = read->tick_rate_hz;
      }
      heard.parts = parts;
    });
    take_each<wire::Pulse>(pulses_, [](const wire::Pulse& sample, Heard& heard) {
      if (const Result<SessionPulse> pulse = from_wire(sample)) heard.pulse = *pulse;
    });
  }

  std::string session_;
  Endpoints endpoints_;  // before the participant, whose threads call it
  std::unique_ptr<Participant> participant_;
  dds::DataReader *snapshots_ = nullptr, *pulses_ = nullptr;
  std::map<rtps::GuidPrefix_t, Heard> heard_;
};

}  // namespace

Result<std::unique_ptr<Directory>> open_directory(const DdsOptions& options) {
  auto directory = std::make_unique<DdsDirectory>();
  if (Status opened = directory->open(options); !opened) return opened.error();
  return std::unique_ptr<Directory>(std::move(directory));
}

}  // namespace mortise
