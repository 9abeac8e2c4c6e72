#pragma once
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "server/inbox.h"
#include "tests/unit/server/small_world.h"

namespace mortise::testing {

/// Anna (client "a") and Ben (client "b") have joined; Anna holds the red part.
class InboxTest : public ::testing::Test {
 protected:
  void SetUp() override {
    anna_ = join("a", "anna");
    ben_ = join("b", "ben");
    ASSERT_EQ(command("a", anna_, kRed, CommandKind::kGrab).refusal, Refusal::kNone);
  }

  UserId join(const ClientKey& client, const std::string& name, std::string role = "designer") {
    ServerInput input;
    input.joins.push_back({client, ++nonce_, name, std::move(role)});
    admit(std::move(input));
    EXPECT_EQ(intake_.join_replies.size(), 1U);
    reply_ = intake_.join_replies.front();
    return reply_.user;
  }
  Reply command(const ClientKey& client, UserId user, PartId part, CommandKind kind) {
    ServerInput input;
    input.commands.push_back({client, {user, part, ++command_seq_, kind}});
    admit(std::move(input));
    return intake_.replies.empty() ? Reply{} : intake_.replies.back();
  }
  static ReceivedIncrement increment(const ClientKey& client, UserId user, PartId part,
                                     std::uint64_t seq, const Vec3& by = Vec3(1, 0, 0)) {
    return {client, {user, part, seq, by, Vec3::Zero()}, static_cast<std::int64_t>(seq) * 10};
  }
  void admit(ServerInput input) { inbox_.admit(std::move(input), world_, now_ns_, intake_); }
  /// Sends one increment and says what became of it.
  Refusal send(const ReceivedIncrement& received) {
    ServerInput input;
    input.increments.push_back(received);
    admit(std::move(input));
    if (intake_.increments.size() == 1) return Refusal::kNone;
    EXPECT_EQ(intake_.refused.size(), 1U);
    return intake_.refused.empty() ? Refusal::kNone : intake_.refused.front().reason;
  }
  std::uint64_t refused(Refusal reason) const {
    return inbox_.counters().refused[static_cast<std::size_t>(reason)];
  }

  World world_ = small_world();
  Inbox inbox_{InboxLimits{}};
  Intake intake_;
  JoinReply reply_;
  UserId anna_, ben_;
  std::int64_t now_ns_ = kSecond_ns;
  std::uint64_t nonce_ = 0, command_seq_ = 0;
};

}  // namespace mortise::testing
