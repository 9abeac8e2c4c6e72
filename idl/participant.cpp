#include "idl/participant.h"

#include <fcntl.h>
#include <unistd.h>

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/rtps/flowcontrol/FlowControllerDescriptor.hpp>
#include <mutex>

#include "idl/directory.h"
#include "idl/fast_dds_overrides.h"
#include "idl/guard_transport.h"
#include "idl/security_properties.h"
#include "idl/server_places.h"

namespace mortise {
namespace {

using eprosima::fastdds::rtps::FlowControllerDescriptor;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;

constexpr int kMaxDomain = 232;  // 7400 + 250 * 233 is no port any more
constexpr int kMaxPort = 65535;  // of UDP
// A client asks for the server so often (measured: 67 of 67 joins within 0.6 s; with 3 s 4 of 41
// took more than 2 s).
constexpr double kAnnouncementPeriod_s = 0.5;
// The longest a write may wait for a lock of Fast DDS; never for a reader.
constexpr double kServerWriteWait_s = 0.01, kClientWriteWait_s = 0.1;
// Clients wait for what one that stands by has not got: what is lost on the way comes soon.
constexpr double kServersHeartbeat_s = 0.02;
// Samples of different sessions have one key.
constexpr int kDirectoryDepth = 64;
// A socket's buffer holds a whole scene's burst.
constexpr std::uint32_t kSocketBuffer_bytes = 1 << 22;

Duration_t duration(double seconds) { return Duration_t(static_cast<long double>(seconds)); }

Error bad(const std::string& text) { return fail(Code::kInvalidInput, text); }
Error broken(const std::string& text) { return fail(Code::kRuntime, text); }

bool serves(Participant::Side side) {
  return side == Participant::Side::kServer || side == Participant::Side::kStandby;
}

Status check(const DdsOptions& options, Participant::Side side) {
  if (options.domain < 0 || options.domain > kMaxDomain) {
    return bad("DDS domain " + std::to_string(options.domain) + " is not in 0..232");
  }
  const bool every = side == Participant::Side::kDirectory && options.session == kEverySession;
  if (options.session.empty() || options.session.size() > 128 ||
      (!every && options.session.find_first_of("*?[]") != std::string::npos)) {
    return bad("session name '" + options.session +
               "' must have 1 to 128 characters and none of * ? [ ]");
  }
  const int port = server_port(options);
  if (port < 1 || port >= kMaxPort) {
    return bad("discovery port " + std::to_string(port) + " is not in 1..65534");
  }
  if (!serves(side) && options.discovery_port != 0 && options.server.empty() &&
      !options.discovery_server.empty()) {
    return bad("port " + std::to_string(port) +
               " of no host: the discovery server knows hosts and ports; leave it out, or name the "
               "server's host as well");
  }
  if (!is_ipv4(options.interface) || !is_own_address(options.interface)) {
    return bad("'" + options.interface +
               "' is not an IPv4 address of this machine: see `ip -4 addr` for those it has");
  }
  if (!(options.liveliness_lease_s > 0.0) || !(options.heartbeat_period_s > 0.0)) {
    return bad("liveliness lease and heartbeat period must be above 0 s");
  }
  if (!(options.participant_lease_s > kAnnouncementPeriod_s)) {
    return bad("participant lease must be longer than the announcement period of 0.5 s");
  }
  if (side == Participant::Side::kStandby && !place_is_free(options, port) &&
      !place_is_free(options, port + kSecondPlace)) {
    return broken("UDP ports " + std::to_string(port) + " to " + std::to_string(port + 3) + " of " +
                  options.interface +
                  " are in use: there is one that leads and one that stands by");
  }
  if (side == Participant::Side::kServer) {
    for (const int used : {port, port + 1}) {
      if (port_is_free(options.interface, used)) continue;
      return broken("UDP port " + std::to_string(used) + " of " + options.interface +
                    " is in use: another server runs on domain " + std::to_string(options.domain) +
                    "; choose another domain or port");
    }
  }
  return ok();
}

/// Sockets of a participant, with some to spare for what comes later. Fast DDS lives without them,
/// and nobody reaches it.
constexpr int kFiles = 32;

Status room_for_sockets() {
  std::vector<int> held;
  while (held.size() < kFiles) {
    const int file = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (file < 0) break;
    held.push_back(file);
  }
  const std::string why = std::strerror(errno);
  for (const int file : held) ::close(file);
  if (held.size() == kFiles) return ok();
  return broken("only " + std::to_string(held.size()) + " of the " + std::to_string(kFiles) +
                " files and sockets of a participant can be opened (" + why +
                "): raise the limit, e.g. ulimit -n 1024, or close other programs");
}

Locator_t locator(const std::string& address, int port) {
  Locator_t result;
  IPLocator::setIPv4(result, address);
  IPLocator::setPhysicalPort(result, static_cast<std::uint16_t>(port));
  return result;
}

/// A star: clients know the server's fixed port, or hear of it from a discovery server, and nobody
/// else; nothing is multicast. So clients never meet each other, a restarted server is a new
/// participant, and any DDS implementation can take part.
dds::DomainParticipantQos qos_of(const DdsOptions& options, Participant::Side side,
                                 const std::vector<std::string>& addresses,
                                 const std::vector<UdpPlace>& discovery_servers,
                                 const std::shared_ptr<GuardCounts>& counts,
                                 const std::shared_ptr<PeersHeard>& peers) {
  dds::DomainParticipantQos qos;
  const bool is_server = serves(side);
  qos.name(is_server ? "mortise-server" : "mortise-client");
  auto udp = std::make_shared<UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.push_back(options.interface);
  udp->sendBufferSize = kSocketBuffer_bytes;
  udp->receiveBufferSize = kSocketBuffer_bytes;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(
      std::make_shared<GuardDescriptor>(udp, counts, is_server && !options.keys.empty(), peers));

  auto& builtin = qos.wire_protocol().builtin;
  builtin.discovery_config.leaseDuration = duration(options.participant_lease_s);
  builtin.discovery_config.leaseDuration_announcementperiod = duration(kAnnouncementPeriod_s);
  const int first = server_port(options);
  int port = first;
  // The first place is left to the one that leads, which may be starting just now.
  if (side == Participant::Side::kStandby && place_is_free(options, port + kSecondPlace))
    port += kSecondPlace;
  // One that stands by looks for the one that leads, which waits to be found.
  if (side != Participant::Side::kServer)
    for (const std::string& address : addresses)
      for (const int place : {first, first + kSecondPlace})
        if (!is_server || address != options.interface || place != port)
          builtin.initialPeersList.push_back(locator(address, place));
  for (const UdpPlace& place : discovery_servers)
    builtin.initialPeersList.push_back(locator(to_text(place.ipv4), place.port));
  if (!discovery_servers.empty()) {
    const std::string text = to_text(Purpose{is_server, options.domain, options.session});
    qos.user_data().data_vec({text.begin(), text.end()});
  }
  if (is_server) {
    builtin.metatrafficUnicastLocatorList.push_back(locator(options.interface, port));
    qos.wire_protocol().default_unicast_locator_list.push_back(
        locator(options.interface, port + 1));
    builtin.mutation_tries = 0;  // this port or none
  } else {
    builtin.metatrafficUnicastLocatorList.push_back(locator(options.interface, 0));
  }
  auto flow = std::make_shared<FlowControllerDescriptor>();
  flow->name = kMeshFlowController;
  flow->max_bytes_per_period = kMeshBytesPerPeriod;
  flow->period_ms = kMeshPeriod_ms;
  qos.flow_controllers().push_back(flow);
  if (!options.keys.empty()) add_security(qos, KeyFiles(options.keys));
  return qos;
}

/// Whose keys these are, and whether they are for this side.
Result<Identity> own_identity(const DdsOptions& options, Participant::Side side) {
  Result<Identity> identity = check_keys(options.keys);
  if (!identity) return identity;
  const bool is_servers = identity->role == "server";
  if (is_servers == serves(side)) return identity;
  return bad(
      options.keys + ": these are the keys of a" +
      (is_servers ? " server" : "n ordinary " + identity->role) + ", '" + identity->name + "': " +
      (is_servers ? "take part with those of a designer, observer, bot or gateway"
                  : "a server needs some of its own: mortise keys issue NAME --role server"));
}

/// Settings of the process, made once: no shortcut between participants of one process, so that a
/// test meets the same network as a user; no lines of Fast DDS on stdout, which belongs to results.
void set_up_process() {
  static std::once_flag once;
  std::call_once(once, [] {
    eprosima::fastrtps::LibrarySettingsAttributes settings;
    settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
    dds::Log::ClearConsumers();
    (void)overrides_in_force();  // asked so that it is linked
  });
}

template <class Qos>
void set_common(Qos& qos, const TopicRow& row, const DdsOptions& options, int depth) {
  qos.reliability().kind =
      row.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind =
      row.transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().depth = depth;
  qos.resource_limits().max_instances = row.max_keys;
  qos.resource_limits().max_samples_per_instance = depth;
  qos.resource_limits().max_samples = row.max_keys * depth;
  qos.resource_limits().allocated_samples = 0;
  qos.endpoint().history_memory_policy =
      row.large ? eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE
                : eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
  if (row.presence) {
    qos.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
    qos.liveliness().lease_duration = duration(options.liveliness_lease_s);
  }
}

// Fast DDS 2.9.1 never ends where it stamps a sample with a time before 1970.
Status clock_shows_time() {
  if (std::time(nullptr) >= 0) return ok();
  return broken("the clock of this machine shows a time before 1970; set it and start again");
}

}  // namespace

std::string partition_of(const std::string& session) { return "session/" + session; }

void Participant::change_term(dds::DataWriter& writer, std::uint64_t term) {
  set_term(term);
  dds::DataWriterQos qos = writer.get_qos();
  put_term(term, qos);
  writer.set_qos(qos);
}

bool matched(dds::DataWriter* writer) {
  dds::PublicationMatchedStatus status;
  return writer->get_publication_matched_status(status) ==
             eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK &&
         status.current_count > 0;
}

std::string announced(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& participant,
                      const char* property) {
  const std::string* value = eprosima::fastrtps::rtps::DataHolderHelper::find_property_value(
      participant.info.identity_token_, property);
  return value != nullptr ? *value : std::string();
}

ClientKey client_key(const eprosima::fastrtps::rtps::GUID_t& guid) {
  constexpr char kDigits[] = "0123456789abcdef";
  ClientKey key;
  for (const eprosima::fastrtps::rtps::octet byte : guid.guidPrefix.value) {
    key += kDigits[byte >> 4];
    key += kDigits[byte & 15];
  }
  return key;
}

void Participant::note_spoke(const eprosima::fastrtps::rtps::GUID_t& peer) {
  if (peers_ && peer.guidPrefix != participant_->guid().guidPrefix)
    peers_->watch(std::bit_cast<PeersHeard::Prefix>(peer.guidPrefix.value));
}

Result<std::unique_ptr<Participant>> Participant::open(const DdsOptions& options, Side side,
                                                       dds::DomainParticipantListener* listener) {
  if (Status room = room_for_sockets(); !room) return room.error();
  if (Status shows = clock_shows_time(); !shows) return shows.error();
  if (Status checked = check(options, side); !checked) return checked.error();
  const auto addresses = addresses_of(options, !serves(side));
  if (!addresses) return addresses.error();
  const auto discovery_servers = discovery_servers_of(options);
  if (!discovery_servers) return discovery_servers.error();
  set_up_process();
  std::unique_ptr<Participant> made(new Participant(options, side));
  if (!options.keys.empty() && options.check_keys) {
    Result<Identity> identity = own_identity(options, side);
    if (!identity) return identity.error();
    made->identity_ = *identity;
  }
  if (!options.keys.empty())
    made->peers_ = std::make_shared<PeersHeard>(
        std::chrono::duration<double>(2.0 * options.participant_lease_s));
  made->participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<dds::DomainId_t>(options.domain),
      qos_of(options, side, *addresses, *discovery_servers, made->guard_, made->peers_), listener,
      dds::StatusMask::none());
  if (made->participant_ == nullptr) {
    return broken("Fast DDS refused a participant on " + options.interface + ", domain " +
                  std::to_string(options.domain) +
                  (options.keys.empty() ? "" : ", with the keys in " + options.keys));
  }
  know_peers(made->participant_->guid().guidPrefix, made->removals_, made->peers_);
  const std::string partition = partition_of(options.session);
  dds::PublisherQos publisher_qos = dds::PUBLISHER_QOS_DEFAULT;
  publisher_qos.partition().push_back(partition.c_str());
  made->publisher_ = made->participant_->create_publisher(publisher_qos);
  dds::SubscriberQos subscriber_qos = dds::SUBSCRIBER_QOS_DEFAULT;
  subscriber_qos.partition().push_back(partition.c_str());
  made->subscriber_ = made->participant_->create_subscriber(subscriber_qos);
  if (made->publisher_ == nullptr || made->subscriber_ == nullptr) {
    return broken("Fast DDS refused publisher or subscriber of session " + options.session);
  }
  return made;
}

Participant::~Participant() {
  if (participant_ == nullptr) return;
  participant_->set_listener(nullptr);
  removals_->stop();
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

Result<dds::Topic*> Participant::open_topic(const TopicRow& row, dds::TopicDataType* type) {
  // Type objects in discovery data crash their reader (Fast DDS 2.9.1), and repel other
  // implementations.
  type->auto_fill_type_object(false);
  type->auto_fill_type_information(false);
  dds::TypeSupport support(type);
  const std::string type_name = support.get_type_name();
  // Two topics of one type share it.
  if (participant_->find_type(type_name).empty() &&
      support.register_type(participant_) != ReturnCode_t::RETCODE_OK) {
    return broken(std::string("Fast DDS refused type ") + type_name);
  }
  // A server both tells ticks and hears those of others.
  auto* known = dynamic_cast<dds::Topic*>(participant_->lookup_topicdescription(row.topic));
  if (known != nullptr) return known;
  dds::Topic* topic = participant_->create_topic(row.topic, type_name, dds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) return broken(std::string("Fast DDS refused topic ") + row.topic);
  return topic;
}

Result<dds::DataWriter*> Participant::open_writer(const TopicRow& row, dds::TopicDataType* type,
                                                  dds::DataWriterListener* listener) {
  Result<dds::Topic*> topic = open_topic(row, type);
  if (!topic) return topic.error();
  dds::DataWriterQos qos;
  set_common(qos, row, options_, row.writer_depth);
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.reliability().max_blocking_time =
      duration(row.to_server ? kClientWriteWait_s : kServerWriteWait_s);
  qos.reliable_writer_qos().times.heartbeatPeriod = duration(options_.heartbeat_period_s);
  qos.publish_mode().kind =
      row.asynchronous ? dds::ASYNCHRONOUS_PUBLISH_MODE : dds::SYNCHRONOUS_PUBLISH_MODE;
  if (row.throttled) qos.publish_mode().flow_controller_name = kMeshFlowController;
  if (row.presence) {
    // Only meaningful for automatic kinds, but must lie below the lease.
    qos.liveliness().announcement_period = duration(0.5 * options_.liveliness_lease_s);
  }
  if (row.leads) {
    qos.reliable_writer_qos().times.heartbeatPeriod = duration(kServersHeartbeat_s);
    // By topic: automatic liveliness would be told to every client as well, 27 times a second.
    qos.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
    qos.liveliness().lease_duration = duration(kLeaderLease_s);
    qos.liveliness().announcement_period = duration(kLeaderAssert_s);
  }
  if (serves(side_)) put_term(term_, qos);
  dds::DataWriter* writer = publisher_->create_datawriter(
      topic.value(), qos, listener,
      listener == nullptr ? dds::StatusMask::none() : dds::StatusMask::publication_matched());
  if (writer == nullptr) {
    return broken(std::string("Fast DDS refused the writer of topic ") + row.topic);
  }
  return writer;
}

Result<dds::DataReader*> Participant::open_reader(const TopicRow& row, dds::TopicDataType* type,
                                                  dds::DataReaderListener* listener) {
  Result<dds::Topic*> topic = open_topic(row, type);
  if (!topic) return topic.error();
  dds::DataReaderQos qos;
  set_common(
      qos, row, options_,
      side_ == Side::kDirectory ? std::max(kDirectoryDepth, row.reader_depth) : row.reader_depth);
  qos.history().kind = row.reader == TopicRow::Reader::kKeepAll ? dds::KEEP_ALL_HISTORY_QOS
                                                                : dds::KEEP_LAST_HISTORY_QOS;
  if (row.leads) {
    qos.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
    qos.liveliness().lease_duration = duration(kLeaderLease_s);
  }
  const dds::StatusMask mask = listener == nullptr ? dds::StatusMask::none()
                                                   : dds::StatusMask::liveliness_changed()
                                                         << dds::StatusMask::subscription_matched()
                                                         << dds::StatusMask::data_available();
  dds::DataReader* reader = subscriber_->create_datareader(topic.value(), qos, listener, mask);
  if (reader == nullptr) {
    return broken(std::string("Fast DDS refused the reader of topic ") + row.topic);
  }
  return reader;
}

}  // namespace mortise
