#pragma once
#include <atomic>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <memory>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/messages/channel.h"
#include "idl/dds_channel.h"
#include "idl/guard_transport.h"
#include "idl/identity.h"
#include "idl/peer_removals.h"
#include "idl/peers_heard.h"
#include "idl/safe_type.h"
#include "idl/terms.h"
#include "idl/topics.h"

namespace mortise {

namespace dds = eprosima::fastdds::dds;

/// Hex of the first 12 bytes of a GUID: the participant.
ClientKey client_key(const eprosima::fastrtps::rtps::GUID_t& guid);

/// In which all endpoints of a session are.
std::string partition_of(const std::string& session);

/// Does anybody listen?
bool matched(dds::DataWriter* writer);

/// What a participant announces of its certificate: "dds.cert.sn", its subject, or "dds.ca.sn",
/// that of its authority; empty: it has none. Proven by nothing yet.
std::string announced(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& participant,
                      const char* property);

/// Takes all valid samples that have come, and hands each with its writer's GUID to the action.
/// False: the reader ended with an error, and may hold more.
template <class Sample, class Action>
bool take_all(dds::DataReader& reader, Action action) {
  using eprosima::fastrtps::types::ReturnCode_t;
  Sample sample;
  dds::SampleInfo info;
  ReturnCode_t code = ReturnCode_t::RETCODE_OK;
  while ((code = reader.take_next_sample(&sample, &info)) == ReturnCode_t::RETCODE_OK)
    if (info.valid_data) action(sample, info.sample_identity.writer_guid());
  return code == ReturnCode_t::RETCODE_NO_DATA;
}

/// One DDS participant in one session: transport, discovery and endpoints after the topic table.
/// Every creation is checked; each failure is one line.
class Participant {
 public:
  /// A directory is a client of every session at once: partition "session/*".
  enum class Side { kServer, kStandby, kClient, kDirectory };

  /// The listener may be null and must outlive the participant.
  static Result<std::unique_ptr<Participant>> open(const DdsOptions& options, Side side,
                                                   dds::DomainParticipantListener* listener);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// Said with each writer that is opened from now on, see term_of(); 0: none.
  void set_term(std::uint64_t term) { term_ = term; }
  /// Says it anew, with one that is open.
  void change_term(dds::DataWriter& writer, std::uint64_t term);

  /// Opens an endpoint unless an earlier one failed; the first failure stays in status.
  template <class Generated>
  void open_writer(Topic topic, dds::DataWriter*& writer, Status& status,
                   dds::DataWriterListener* listener = nullptr) {
    if (status)
      keep(open_writer(row_of(topic), new SafeType<Generated>(refused_), listener), writer, status);
  }
  template <class Generated>
  void open_reader(Topic topic, dds::DataReaderListener* listener, dds::DataReader*& reader,
                   Status& status) {
    if (status)
      keep(open_reader(row_of(topic), new SafeType<Generated>(refused_), listener), reader, status);
  }

  ClientKey key() const { return client_key(participant_->guid()); }
  std::uint64_t refused() const { return refused_->load(std::memory_order_relaxed); }
  const std::optional<Identity>& identity() const { return identity_; }  ///< own; none: no security
  /// One that is met said something that counts. With keys: where it falls silent for twice its
  /// lease, it is forgotten, and met anew; see PeersHeard.
  void note_spoke(const eprosima::fastrtps::rtps::GUID_t& peer);
  std::uint64_t dropped() const { return guard_->dropped.load(std::memory_order_relaxed); }
  std::uint64_t repeated() const { return guard_->repeated.load(std::memory_order_relaxed); }
  std::uint64_t cut() const { return guard_->cut.load(std::memory_order_relaxed); }

 private:
  Participant(const DdsOptions& options, Side side) : options_(options), side_(side) {}
  template <class Endpoint>
  static void keep(Result<Endpoint*> opened, Endpoint*& endpoint, Status& status) {
    if (opened) {
      endpoint = *opened;
    } else {
      status = opened.error();
    }
  }
  /// Takes ownership of the type.
  Result<dds::Topic*> open_topic(const TopicRow& row, dds::TopicDataType* type);
  Result<dds::DataWriter*> open_writer(const TopicRow& row, dds::TopicDataType* type,
                                       dds::DataWriterListener* listener);
  Result<dds::DataReader*> open_reader(const TopicRow& row, dds::TopicDataType* type,
                                       dds::DataReaderListener* listener);

  DdsOptions options_;
  Side side_;
  std::uint64_t term_ = 0;
  std::optional<Identity> identity_;
  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  std::shared_ptr<std::atomic<std::uint64_t>> refused_ =
      std::make_shared<std::atomic<std::uint64_t>>(0);
  std::shared_ptr<GuardCounts> guard_ = std::make_shared<GuardCounts>();
  std::shared_ptr<PeerRemovals> removals_ = std::make_shared<PeerRemovals>();
  std::shared_ptr<PeersHeard> peers_;  ///< null: no security
};

}  // namespace mortise
