#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <random>

#include "server/inbox.h"
#include "tests/unit/server/small_world.h"

namespace mortise {
namespace {

using namespace mortise::testing;

/// Whatever is sent, by whomever: every increment is either taken or refused with a reason, a
/// user's sequence rises, only holders move parts, and a part has one present holder or none.
TEST(Inbox, KeepsItsBooksUnderRandomTraffic) {
  std::uint64_t taken_in_all = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    const auto below = [&](std::uint64_t n) { return random() % n; };
    World world = small_world();
    Inbox inbox({.messages_per_s = 300.0, .max_users = 5, .increments_per_tick = 4});
    Intake intake;
    std::int64_t now_ns = 0;
    std::uint64_t sent = 0, taken = 0, nonce = 0, increment_seq = 0, command_seq = 0;
    std::map<UserId, std::uint64_t> last_seq;
    std::map<UserId, ClientKey> owner;
    const char* const clients[] = {"a", "b", "c"};
    const double nan = std::numeric_limits<double>::quiet_NaN();

    for (int drain = 0; drain < 600; ++drain) {
      now_ns += static_cast<std::int64_t>(below(below(20) == 0 ? 3 * kSecond_ns : 40'000'000));
      const bool quiet = drain >= 500;  // the last hundred work off what waits
      ServerInput input;
      for (std::uint64_t i = quiet ? 0 : below(12); i > 0; --i) {
        ClientKey client = clients[below(3)];
        UserId user{static_cast<std::uint32_t>(below(7))};
        const PartId part{static_cast<std::uint32_t>(below(5))};
        if (below(3) > 0) {  // mostly honest: the holder, or at least the user's own client
          const Part* held = part ? world.find(part) : nullptr;
          if (held != nullptr && held->holder) user = held->holder;
          if (owner.contains(user)) client = owner[user];
        }
        switch (below(12)) {
          case 0:
            input.joins.push_back({client, ++nonce, "user" + std::to_string(below(6)),
                                   below(9) ? "bot" : "observer"});
            break;
          case 1:
            if (below(6) == 0) input.lost.push_back({below(2) ? user : UserId{}, client, false});
            break;
          case 2:
            if (below(4) == 0) input.lost.push_back({user, client, true});
            break;
          case 3:
            input.heartbeats.push_back(user);
            break;
          case 4:
          case 5:
            input.commands.push_back({client,
                                      {user, part, below(9) ? ++command_seq : command_seq,
                                       static_cast<CommandKind>(below(5))}});
            break;
          case 6:
            ++sent;
            input.increments.push_back(
                {client, {user, part, ++increment_seq, {0, 0, 0}, {0, 0, 0}}});
            input.increments.back().at_door = Refusal::kNotFinite;
            break;
          default:
            for (std::uint64_t n = below(6); n > 0; --n) {
              ++sent;
              const std::uint64_t seq = below(9) ? ++increment_seq : below(increment_seq + 70);
              const double x = below(20) ? 1.0 : (below(2) ? nan : 1e200);
              input.increments.push_back({client, {user, part, seq, {x, 0, 0}, {0, 0, 0}}, 1});
            }
        }
      }
      inbox.admit(std::move(input), world, now_ns, intake);

      taken += intake.increments.size();
      for (const Increment& increment : intake.increments) {
        ASSERT_LT(last_seq[increment.user], increment.seq) << "seed " << seed;
        last_seq[increment.user] = increment.seq;
      }
      for (const JoinReply& reply : intake.join_replies) {
        if (!reply.user) continue;
        last_seq[reply.user] = 0;  // who comes back counts anew
        owner[reply.user] = reply.client;
      }
      for (const Part& part : world.parts) {
        if (!part.holder) continue;
        ASSERT_TRUE(part.moving);
        ASSERT_TRUE(world.find(part.holder)->present) << "seed " << seed << " drain " << drain;
      }
      ASSERT_LE(inbox.users_present(), 5U);
    }
    const InboxCounters& counters = inbox.counters();
    EXPECT_EQ(counters.increments, sent);
    EXPECT_EQ(counters.accepted, taken);
    EXPECT_EQ(counters.accepted + counters.refused_in_all(), sent) << "something went missing";
    taken_in_all += taken;
  }
  EXPECT_GT(taken_in_all, 1000U) << "the traffic tests nothing";
}

}  // namespace
}  // namespace mortise
