#include "client/bot/tally.h"

#include <gtest/gtest.h>

#include "common/messages/memory_channel.h"

namespace mortise {
namespace {

ClashEvent event(std::uint64_t seq, double depth_mm) {
  ClashEvent e;
  e.kind = ClashEvent::Kind::kBegin;
  e.seq = seq;
  e.tick = 10 + seq;
  e.clash = ClashId{static_cast<std::uint32_t>(seq)};
  e.part_a = PartId{1};
  e.part_b = PartId{2};
  e.verdict.collision_class = CollisionClass::kReal;
  e.verdict.delta_mm = {depth_mm, depth_mm};
  return e;
}

class TallyTest : public ::testing::Test {
 protected:
  std::string hash_of(const std::vector<std::vector<ClashEvent>>& polls) {
    Tally tally;
    for (const auto& events : polls) {
      ClientUpdate update;
      update.events = events;
      tally.add(update, client_);
    }
    return tally.event_hash();
  }
  MemoryHub hub_;
  std::unique_ptr<ClientChannel> channel_ = hub_.open_client();
  Client client_{*channel_};
};

TEST_F(TallyTest, EventHashTellsContentAndOrderButNotPolling) {
  const auto a = event(1, 0.5), b = event(2, 0.25);
  EXPECT_EQ(hash_of({{a, b}}), hash_of({{a}, {}, {b}}));
  EXPECT_NE(hash_of({{a, b}}), hash_of({{b, a}}));
  EXPECT_NE(hash_of({{a}}), hash_of({{a, b}}));
  EXPECT_NE(hash_of({{a, event(2, 0.25000001)}}), hash_of({{a, b}}));
}

TEST_F(TallyTest, CountsRefusalsByReason) {
  Tally tally;
  ClientUpdate update;
  update.refused.push_back({UserId{1}, PartId{1}, 1, Refusal::kNotFinite});
  update.refused.push_back({UserId{1}, PartId{1}, 2, Refusal::kNotHolder});
  update.refused.push_back({UserId{1}, PartId{1}, 3, Refusal::kNotHolder});
  tally.add(update, client_);
  EXPECT_EQ(tally.refused(), 3U);
  EXPECT_EQ(tally.json()["refused"]["not the holder"], 2);
}

}  // namespace
}  // namespace mortise
