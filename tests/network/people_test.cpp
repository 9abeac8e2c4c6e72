// The session life between two designers and an observer over real DDS, with the real tick loop
// behind it.
#include <gtest/gtest.h>

#include <algorithm>

#include "client/client.h"
#include "common/io/scene_load.h"
#include "server/tick_loop.h"
#include "tests/network/small_server.h"

namespace mortise::test {
namespace {

constexpr const char* kScenario = R"(
name: people
units: mm
policy: report
parts:
  - name: plate
    generator: {kind: plate_with_bore, bore: 20, facets: 32}
  - name: peg
    generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 32, phase_deg: 5.625}
    pose: {position: [0, 0, 25]}
    moving: true
    features:
      chamfer_lower: {tolerance: {lower: -0.1, upper: -0.04}}
      chamfer_upper: {tolerance: {lower: -0.1, upper: -0.04}}
  - name: block
    generator: {kind: block, x: 4, y: 4, z: 4}
    pose: {position: [100, 0, 0]}
    moving: true
fits:
  - {between: [plate.bore, peg.journal], code: Ø20 H7/g6}
)";

Result<LoadedScene> scene_of_test() {
  auto reading = read_scenario_text(kScenario, "people.yaml");
  if (!reading) return reading.error();
  return load_scene(reading->scenario, default_meshes());
}

/// One participant and all that it was told.
struct Person {
  std::unique_ptr<ClientChannel> channel;
  std::unique_ptr<Client> client;
  std::vector<Reply> replies;
  std::vector<Decision> decisions;
  std::vector<ClashEvent> events;

  bool was_decided(Decision::Kind kind) const {
    return std::any_of(decisions.begin(), decisions.end(),
                       [kind](const Decision& decision) { return decision.kind == kind; });
  }
  /// The answer to a command, none when it has not come.
  const Reply* answer(std::uint64_t seq) const {
    for (const Reply& reply : replies)
      if (reply.seq == seq) return &reply;
    return nullptr;
  }
};

struct People : testing::Test {
  DdsOptions options;
  std::unique_ptr<ServerChannel> server;
  LoadedScene scene;
  SystemClock clock;
  std::unique_ptr<TickLoop> loop;
  Person anna, ben, eve;

  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    options = options_for_test(info->name());
    auto loaded = scene_of_test();
    ASSERT_TRUE(loaded) << loaded.error().text;
    scene = std::move(*loaded);
    auto opened = open_server_channel(options);
    ASSERT_TRUE(opened) << opened.error().text;
    server = std::move(*opened);
    TickLoopOptions loop_options;
    loop_options.session = options.session;
    loop = std::make_unique<TickLoop>(scene.world, *server, clock, nullptr, loop_options);
    loop->open();
    enter(anna, "anna", "designer");
    enter(ben, "ben", "designer");
    enter(eve, "eve", "observer");
    ASSERT_TRUE(wait([&] {
      for (const Person* person : {&anna, &ben, &eve})
        if (person->client->join_state(0) != JoinState::kJoined || !person->client->synced())
          return false;
      return anna.client->users().size() == 3;
    }));
  }
  void enter(Person& person, const std::string& name, const std::string& role) const {
    auto opened = open_client_channel(options);
    ASSERT_TRUE(opened) << opened.error().text;
    person.channel = std::move(*opened);
    person.client = std::make_unique<Client>(*person.channel);
    person.client->add_user(name, role);
  }
  void turn() {
    loop->tick();
    for (Person* person : {&anna, &ben, &eve}) {
      if (!person->client) continue;
      ClientUpdate update = person->client->poll();
      const auto append = [](auto& to, auto& from) {
        to.insert(to.end(), from.begin(), from.end());
      };
      append(person->replies, update.replies);
      append(person->decisions, update.decisions);
      append(person->events, update.events);
    }
  }
  bool wait(const std::function<bool()>& done) {
    return until(8.0, done, [this] { turn(); });
  }
  /// Waits for the answer to a command of the person.
  Reply answer(Person& person, std::uint64_t seq) {
    EXPECT_NE(seq, 0u);
    EXPECT_TRUE(wait([&] { return person.answer(seq) != nullptr; }));
    const Reply* reply = person.answer(seq);
    return reply != nullptr ? *reply : Reply{};
  }
  UserId holder(const Person& person, PartId part) const {
    return person.client->parts().at(part).info.holder;
  }
};

TEST_F(People, HandsOverReviewsAndChangesRulesWhileEverybodySeesIt) {
  const PartId plate{1}, peg{2}, block{3};
  // 1. Roles are seen by all; the observer is refused with a reason.
  EXPECT_TRUE(std::any_of(
      ben.client->users().begin(), ben.client->users().end(),
      [](const UserInfo& user) { return user.name == "eve" && user.role == Role::kObserver; }));
  const Reply refused = answer(eve, eve.client->grab(0, peg));
  EXPECT_EQ(refused.refusal, Refusal::kObserver);
  EXPECT_FALSE(refused.text.empty());

  // 2. Steal by consent.
  EXPECT_EQ(answer(anna, anna.client->grab(0, peg)).refusal, Refusal::kNone);
  EXPECT_EQ(answer(ben, ben.client->grab(0, peg)).refusal, Refusal::kHeldByOther);
  EXPECT_EQ(answer(ben, ben.client->ask_hand_over(0, peg)).refusal, Refusal::kNone);
  ASSERT_TRUE(wait([&] { return anna.was_decided(Decision::Kind::kAskHandOver); }));
  EXPECT_EQ(answer(anna, anna.client->consent(0, peg)).refusal, Refusal::kNone);
  ASSERT_TRUE(wait([&] {
    return holder(ben, peg) == ben.client->user_id(0) && holder(eve, peg) == holder(ben, peg);
  }));

  // 3. Ben puts the peg in: a fake collision. Anna approves it.
  ben.client->send(0, peg, Vec3(0, 0, -18));
  ASSERT_TRUE(wait([&] { return !anna.client->open_clashes().empty(); }));
  const ClashEvent clash = anna.client->open_clashes().begin()->second;
  EXPECT_EQ(clash.verdict.collision_class, CollisionClass::kFake);
  EXPECT_EQ(answer(anna, anna.client->review(0, clash.clash, ReviewStatus::kApproved, "as drawn"))
                .refusal,
            Refusal::kNone);
  ASSERT_TRUE(wait([&] {
    const auto& open = eve.client->open_clashes();
    return !open.empty() && open.begin()->second.review.status == ReviewStatus::kApproved;
  }));

  // 4. Another fit makes it real: everybody is told why, and that the approval is gone.
  const Reply bad =
      answer(anna, anna.client->set_fit(0, {plate, "bore"}, {peg, "journal"}, "H7/h"));
  EXPECT_EQ(bad.refusal, Refusal::kBadRule) << bad.text;
  EXPECT_EQ(
      answer(anna, anna.client->set_fit(0, {plate, "bore"}, {peg, "journal"}, "H7/p6")).refusal,
      Refusal::kNone);
  for (Person* person : {&anna, &ben, &eve}) {
    ASSERT_TRUE(wait([&] {
      return std::any_of(person->events.begin(), person->events.end(),
                         [](const ClashEvent& event) { return event.approval_lost; });
    }));
    const auto told = std::find_if(person->events.begin(), person->events.end(),
                                   [](const ClashEvent& event) { return event.approval_lost; });
    EXPECT_EQ(told->cause, Decision::Kind::kSetTolerance);
    EXPECT_EQ(told->user, anna.client->user_id(0));
    EXPECT_EQ(told->verdict.collision_class, CollisionClass::kReal);
    EXPECT_EQ(told->review.status, ReviewStatus::kActive);
  }

  // 5. Policy, group, undo and redo; one who comes late finds what stands.
  EXPECT_EQ(answer(anna, anna.client->set_policy(0, "stop")).refusal, Refusal::kNone);
  ASSERT_TRUE(wait([&] { return ben.client->policy() == "stop"; }));
  EXPECT_EQ(answer(anna, anna.client->grab(0, {block, peg})).refusal, Refusal::kHeldByOther);
  EXPECT_EQ(answer(ben, ben.client->grab(0, {block, peg})).refusal, Refusal::kNone);
  EXPECT_EQ(answer(ben, ben.client->release(0, {block, peg})).refusal, Refusal::kNone);
  EXPECT_EQ(answer(anna, anna.client->undo(0, peg)).refusal, Refusal::kMovedBySomeoneElse);
  EXPECT_EQ(answer(ben, ben.client->undo(0, peg)).refusal, Refusal::kNone);
  ASSERT_TRUE(wait([&] { return anna.client->open_clashes().empty(); }));
  EXPECT_EQ(answer(ben, ben.client->redo(0, peg)).refusal, Refusal::kNone);
  Person late;
  enter(late, "late", "observer");
  ASSERT_TRUE(wait([&] {
    late.client->poll();
    return late.client->synced() && late.client->join_state(0) == JoinState::kJoined;
  }));
  EXPECT_EQ(late.client->policy(), "stop");
  EXPECT_EQ(late.client->standing().size(), 2u);  // the fit and the policy
  EXPECT_EQ(late.client->users().size(), 4u);

  // 6. The same events for all, in the same order; nothing was malformed.
  ASSERT_TRUE(wait([&] {
    return anna.client->statistics().highest_event_seq ==
               eve.client->statistics().highest_event_seq &&
           ben.client->statistics().highest_event_seq == eve.client->statistics().highest_event_seq;
  }));
  ASSERT_EQ(anna.events.size(), eve.events.size());
  for (std::size_t i = 0; i < anna.events.size(); ++i) {
    EXPECT_EQ(anna.events[i].seq, eve.events[i].seq);
    EXPECT_EQ(anna.events[i].review.status, eve.events[i].review.status);
  }
  EXPECT_EQ(server->counters().malformed, 0u);
  EXPECT_EQ(anna.channel->counters().malformed, 0u);
}

TEST_F(People, PresenceFollowsWhoLeavesAndComesBack) {
  const auto present = [](const Person& person, const std::string& name) {
    return std::any_of(person.client->users().begin(), person.client->users().end(),
                       [&](const UserInfo& user) { return user.name == name && user.present; });
  };
  const UserId was = ben.client->user_id(0);
  ben.client->grab(0, PartId{3});
  ASSERT_TRUE(wait([&] { return holder(anna, PartId{3}) == was; }));
  ben.client->leave(0);
  ASSERT_TRUE(wait([&] { return !present(anna, "ben") && !present(eve, "ben"); }));
  EXPECT_FALSE(holder(anna, PartId{3}));
  Person again;
  enter(again, "ben", "designer");
  ASSERT_TRUE(wait([&] {
    again.client->poll();
    return again.client->join_state(0) == JoinState::kJoined && present(anna, "ben");
  }));
  EXPECT_EQ(again.client->user_id(0), was);
  EXPECT_EQ(anna.client->users().size(), 3u);
}

}  // namespace
}  // namespace mortise::test
