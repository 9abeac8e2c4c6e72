// Participants that leave at a moment at which the library ends the process; keys that it computes
// again and again.
#include "idl/fast_dds_overrides.h"

#include <dlfcn.h>
#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/builtin/discovery/participant/PDP.h>
#include <fastdds/rtps/common/CDRMessage_t.h>
#include <fastdds/rtps/resources/ResourceEvent.h>
#include <fastdds/rtps/resources/TimedEvent.h>
#include <gtest/gtest.h>

#include <array>
#include <future>
#include <random>
#include <thread>
#include <utility>
#include <vector>

namespace mortise {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

/// Discovery of a participant without a network, that says whom it was told to remove.
class Discovery : public rtps::PDP {
 public:
  explicit Discovery(const rtps::RTPSParticipantAllocationAttributes& allocation)
      : PDP(nullptr, allocation) {}

  bool init(rtps::RTPSParticipantImpl*) override { return true; }
  bool createPDPEndpoints() override { return true; }
  void assignRemoteEndpoints(rtps::ParticipantProxyData*) override {}
  void notifyAboveRemoteEndpoints(const rtps::ParticipantProxyData&) override {}
  void removeRemoteEndpoints(rtps::ParticipantProxyData*) override {}
  rtps::ParticipantProxyData* createParticipantProxyData(const rtps::ParticipantProxyData&,
                                                         const rtps::GUID_t&) override {
    return nullptr;
  }
  bool remove_remote_participant(const rtps::GUID_t& guid,
                                 rtps::ParticipantDiscoveryInfo::DISCOVERY_STATUS) override {
    removed.push_back(guid);
    return true;
  }

  std::vector<rtps::GUID_t> removed;
};

/// As the library's timer does: by name, wherever the dynamic linker finds it.
void look_at_lease(rtps::PDP& discovery, rtps::ParticipantProxyData& remote) {
  void* found = dlsym(RTLD_DEFAULT, MORTISE_LEASE_CHECK);
  ASSERT_NE(found, nullptr);
  reinterpret_cast<void (*)(rtps::PDP*, rtps::ParticipantProxyData*)>(found)(&discovery, &remote);
}

class ParticipantLease : public ::testing::Test {
 protected:
  ParticipantLease() {
    discovery_.removed.clear();
    // Fast DDS leaves the lease as the memory was until somebody announces one: 0 s here.
    rtps::ParticipantProxyData announced(allocation_);
    announced.m_leaseDuration = {0, 0};
    EXPECT_TRUE(remote_.updateData(announced));
  }

  rtps::RTPSParticipantAllocationAttributes allocation_;
  // One for all, never ended: its destructor asks for a network.
  static Discovery& the_only() {
    static Discovery& only = *new Discovery(rtps::RTPSParticipantAllocationAttributes{});
    return only;
  }
  Discovery& discovery_ = the_only();
  rtps::ParticipantProxyData remote_{allocation_};
};

TEST_F(ParticipantLease, OneWhoHasLeftMeanwhileEndsNoProcess) {
  remote_.should_check_lease_duration = true;
  ASSERT_EQ(remote_.m_guid, rtps::GUID_t::unknown());
  look_at_lease(discovery_, remote_);
  EXPECT_TRUE(discovery_.removed.empty());
}

TEST_F(ParticipantLease, OneWhoIsSilentIsRemoved) {
  remote_.should_check_lease_duration = true;
  remote_.m_guid.guidPrefix.value[0] = 7;
  remote_.m_guid.entityId = rtps::c_EntityId_RTPSParticipant;
  look_at_lease(discovery_, remote_);  // never heard of, with a lease of 0 s
  ASSERT_EQ(discovery_.removed.size(), 1U);
  EXPECT_EQ(discovery_.removed[0], remote_.m_guid);
}

TEST_F(ParticipantLease, IsLookedAtAgainWhereAnotherHasTheLock) {
  remote_.should_check_lease_duration = true;
  remote_.m_guid.guidPrefix.value[0] = 7;
  rtps::ResourceEvent timers;
  timers.init_thread();
  std::promise<void> looked_again;
  remote_.lease_duration_event = new rtps::TimedEvent(
      timers,
      [&] {
        look_at_lease(discovery_, remote_);
        looked_again.set_value();
        return false;
      },
      1.0);
  {
    const std::lock_guard lock(*discovery_.getMutex());
    std::thread([&] { look_at_lease(discovery_, remote_); }).join();  // or it stands still here
    EXPECT_TRUE(discovery_.removed.empty());
  }
  looked_again.get_future().wait();
  EXPECT_EQ(discovery_.removed.size(), 1U);
  delete std::exchange(remote_.lease_duration_event, nullptr);
}

TEST_F(ParticipantLease, WhereNoLeaseIsAskedForNobodyIsRemoved) {
  remote_.should_check_lease_duration = false;
  remote_.m_guid.guidPrefix.value[0] = 7;
  look_at_lease(discovery_, remote_);
  EXPECT_TRUE(discovery_.removed.empty());
}

TEST(EncodedMessage, WhoseReceiversHaveLeftIsNotSent) {
  using Encode = bool (*)(const void*, const rtps::CDRMessage_t&, rtps::CDRMessage_t&,
                          const std::vector<rtps::GuidPrefix_t>&);
  const auto encode = reinterpret_cast<Encode>(dlsym(RTLD_DEFAULT, MORTISE_ENCODE));
  ASSERT_NE(encode, nullptr);
  rtps::CDRMessage_t plain, encoded;
  // Security of nobody: with no receiver it must not be asked.
  EXPECT_FALSE(encode(nullptr, plain, encoded, {}));
}

using Key = std::array<std::uint8_t, 32>;
using ComputeKey = void (*)(void*, Key&, bool, const Key&, const Key&, std::uint32_t, int);

TEST(SessionKeys, ThatAreKeptAreThoseOfTheLibrary) {
  const auto kept = reinterpret_cast<ComputeKey>(dlsym(RTLD_DEFAULT, MORTISE_SESSION_KEY));
  const auto computed = reinterpret_cast<ComputeKey>(dlsym(RTLD_NEXT, MORTISE_SESSION_KEY));
  ASSERT_NE(kept, nullptr);
  ASSERT_NE(computed, nullptr);
  ASSERT_NE(kept, computed);
  std::mt19937_64 random(7);
  const auto random_key = [&] {
    Key key;
    for (std::uint8_t& byte : key) byte = static_cast<std::uint8_t>(random());
    return key;
  };
  // Few of each, so that what is asked comes again; sessions that fall on one place among them, and
  // master keys and salts that differ in their last byte.
  std::vector<Key> masters, salts;
  for (int i = 0; i < 3; ++i) {
    masters.push_back(random_key());
    salts.push_back(random_key());
    masters.push_back(masters.back());
    salts.push_back(salts.back());
    ++masters.back()[31];
    ++salts.back()[31];
  }
  const std::uint32_t sessions[] = {0, 1, 1024, 2048, 0xfffffffe};
  const auto one_of = [&](const auto& some) { return some[random() % std::size(some)]; };
  for (int i = 0; i < 5000; ++i) {
    const Key master = one_of(masters), salt = one_of(salts);
    const std::uint32_t session = one_of(sessions);
    const bool receiver_specific = random() % 2 == 0;
    const int length = random() % 2 == 0 ? 16 : 32;
    Key ours = random_key(), theirs = random_key();
    kept(nullptr, ours, receiver_specific, master, salt, session, length);
    computed(nullptr, theirs, receiver_specific, master, salt, session, length);
    ASSERT_EQ(ours, theirs) << i;
  }
}

TEST(FastDdsOverrides, AreInForce) { EXPECT_TRUE(overrides_in_force()); }

}  // namespace
}  // namespace mortise
