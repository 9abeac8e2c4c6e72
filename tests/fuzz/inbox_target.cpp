#include <cmath>
#include <cstring>
#include <map>

#include "common/base/check.h"
#include "server/inbox.h"
#include "tests/fuzz/targets.h"
#include "tests/unit/server/small_world.h"

namespace mortise::test {
namespace {

using namespace mortise::testing;

/// Numbers out of bytes; zeros behind their end.
class Script {
 public:
  explicit Script(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  bool more() const { return at_ < bytes_.size(); }
  std::uint32_t byte() { return more() ? bytes_[at_++] : 0; }
  /// Small ones mostly, and every other one within reach.
  std::uint64_t number() {
    const std::uint64_t small = byte();
    if (small < 250) return small;
    std::uint64_t large = 0;
    for (int i = 0; i < 8; ++i) large = large << 8 | byte();
    return large;
  }
  double real() {
    const std::uint64_t bits = number();
    if (bits < 250) return static_cast<double>(bits) - 125.0;
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

void add(Script& script, ServerInput& input) {
  const std::string client(1, static_cast<char>('a' + script.byte() % 3));
  const UserId user{script.byte() % 5};
  const PartId part{script.byte() % 5};
  switch (script.byte() % 8) {
    case 0:
      input.joins.push_back({client, script.number(),
                             std::string(1, static_cast<char>('k' + script.byte() % 4)),
                             script.byte() % 4 == 0 ? "observer" : "designer"});
      break;
    case 1:
      input.lost.push_back({user, client, script.byte() % 2 == 0});
      break;
    case 2:
      input.heartbeats.push_back(user);
      break;
    case 3:
    case 4: {
      Command command;
      command.user = user;
      command.part = part;
      command.seq = script.number();
      command.kind = static_cast<CommandKind>(1 + script.byte() % (kCommandKindCount - 1));
      command.after = script.number();
      const std::uint32_t more = script.byte();
      for (std::uint32_t n = more % 4; n > 0; --n)
        command.details.parts.push_back(PartId{script.byte() % 5});
      command.details.other_user = UserId{more / 4 % 5};
      command.details.other_part = PartId{more / 20 % 5};
      input.commands.push_back({client, command});
      break;
    }
    default: {  // a batch as the door lets it through: rising, finite or refused
      const std::uint64_t kept_from = script.number();
      std::uint64_t seq = std::max<std::uint64_t>(kept_from, 1) + script.byte() % 4;
      const std::uint64_t fresh_from = seq + script.byte() % 4;
      for (std::uint32_t n = 1 + script.byte() % 4; n > 0; --n) {
        ReceivedIncrement r;
        r.client = client;
        r.increment = {user, part, seq, {script.real(), 0, 0}, {0, 0, script.real()}};
        r.kept_from = kept_from;
        r.repeated = seq < fresh_from;
        if (script.byte() % 16 == 0) r.at_door = Refusal::kNotFinite;
        input.increments.push_back(r);
        const std::uint64_t step = 1 + script.byte() % 3;
        if (seq + step < seq) break;
        seq += step;
      }
    }
  }
}

}  // namespace

bool fuzz_inbox(std::span<const std::uint8_t> bytes) {
  Script script(bytes);
  World world = small_world();
  constexpr std::uint32_t kMostParts = 1;
  Inbox inbox({.messages_per_s = 200.0,
               .max_users = 3,
               .increments_per_tick = 4,
               .parts_per_user = kMostParts});
  Intake intake;
  std::map<UserId, std::uint64_t> last;
  std::int64_t now_ns = 0;
  bool any = false;
  for (int drain = 0; drain < 64 && script.more(); ++drain) {
    now_ns += static_cast<std::int64_t>(script.byte()) * 20'000'000;
    ServerInput input;
    for (std::uint32_t n = script.byte() % 8; n > 0; --n) add(script, input);
    inbox.admit(std::move(input), world, now_ns, intake);
    for (const JoinReply& reply : intake.join_replies) last.erase(reply.user);
    for (const Increment& increment : intake.increments) {
      MORTISE_CHECK(increment.seq > last[increment.user], "a user's sequence goes back");
      MORTISE_CHECK(increment.translation_mm.allFinite() && increment.rotation_rad.allFinite(),
                    "not finite");
      last[increment.user] = increment.seq;
      any = true;
    }
    std::map<UserId, std::uint32_t> held;
    for (const Part& part : world.parts) {
      if (!part.holder) continue;
      MORTISE_CHECK(++held[part.holder] <= kMostParts, "a hand that holds too much");
      MORTISE_CHECK(part.moving && world.find(part.holder)->present, "a part in nobody's hand");
    }
    const InboxCounters& counters = inbox.counters();
    MORTISE_CHECK(counters.accepted + counters.refused_in_all() <= counters.increments, "books");
    MORTISE_CHECK(inbox.users_present() <= 3, "more users than are admitted");
  }
  return any;
}

std::vector<std::string> inbox_seeds() {
  // client, user, part, kind of message, and what it takes.
  const std::string join("\x00\x00\x00\x00\x01\x00\x01", 7),
      grab("\x00\x01\x02\x03\x01\x00\x00\x00", 8);
  std::string session = std::string("\x01\x01", 2) + join + std::string("\x01\x01", 2) + grab;
  for (char seq = 1; seq < 12; ++seq) {
    session += std::string("\x01\x01", 2);                      // a drain with one message
    session += std::string("\x00\x01\x02\x05", 4);              // increments of user 1, part 2
    session += seq;                                             // kept from
    session += std::string("\x00\x00\x00\x7e\x7d\x01\x00", 7);  // one of 1 mm
  }
  const std::string release("\x01\x01\x00\x01\x02\x03\x02\x01\x0c\x00", 10);
  return {session, session + release, session + session.substr(20) + release};
}

}  // namespace mortise::test
