// The session life between two designers and an observer over real DDS, with the real tick loop
// behind it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "common/base/hash.h"
#include "tests/network/domain.h"
#include "tests/network/site.h"
#include "tests/network/small_server.h"
#include "tests/support/cube_file.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {
namespace {

struct People : testing::Test {
  std::unique_ptr<Site> site;
  Person anna, ben, eve;

  void SetUp() override {
    site = std::make_unique<Site>(own_options(), peg_yaml());
    anna.enter(site->options, "anna");
    ben.enter(site->options, "ben");
    eve.enter(site->options, "eve", "observer");
    ASSERT_TRUE(wait([&] {
      for (const Person* person : {&anna, &ben, &eve})
        if (!person->is_in()) return false;
      return anna.client->users().size() == 3;
    }));
  }
  void turn() {
    site->loop->tick();
    for (Person* person : {&anna, &ben, &eve}) person->listen();
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

TEST_F(People, PartsComeAndGoWhileEverybodySeesIt) {
  const PartId block{3};
  const auto all_see = [&](const std::function<bool(const Client&)>& so) {
    return wait([&] {
      return std::ranges::all_of(std::array{&anna, &ben, &eve},
                                 [&](const Person* person) { return so(*person->client); });
    });
  };
  // 1. A file, and a part of it, 1 mm deep in the block.
  const std::vector<std::byte> file = cube_file(5.0);
  const Pose& X_WB = anna.client->parts().at(block).info.X_WP;
  const double radius_mm = anna.client->parts().at(block).info.radius_mm;
  ASSERT_NE(anna.client->upload(0, "post.stl", 1.0, file), 0U);
  const Pose X_WP = Pose::translation(X_WB.p + Vec3(0.5 * radius_mm, 0, 0));
  const Reply added =
      answer(anna, anna.client->add_part(0, "post", content_hash(file), X_WP, true));
  ASSERT_EQ(added.refusal, Refusal::kNone) << added.text;
  ASSERT_TRUE(all_see([](const Client& client) {
    const PartId post = client.find_part("post");
    return post && client.parts().at(post).info.radius_mm > 8.0 && !client.open_clashes().empty();
  }));
  const PartId post = ben.client->find_part("post");
  EXPECT_TRUE(ben.was_decided(Decision::Kind::kAddPart));
  // 2. Who comes later sees it, and has its mesh.
  Person late;
  late.enter(site->options, "late");
  std::vector<MeshBytes> meshes;
  ASSERT_TRUE(wait([&] {
    ClientUpdate update = late.client->poll();
    for (MeshBytes& mesh : update.meshes) meshes.push_back(std::move(mesh));
    return late.is_in() && late.client->find_part("post") == post && !meshes.empty() &&
           std::ranges::any_of(meshes, [&](const MeshBytes& mesh) {
             return mesh.hash == late.client->parts().at(post).info.mesh_hash;
           });
  }));
  // 3. It is held and moved as any other; then it goes and comes back.
  EXPECT_EQ(answer(ben, ben.client->grab(0, post)).refusal, Refusal::kNone);
  EXPECT_EQ(answer(anna, anna.client->remove_part(0, post)).refusal, Refusal::kHeldByOther);
  EXPECT_EQ(answer(ben, ben.client->release(0, post)).refusal, Refusal::kNone);
  EXPECT_EQ(answer(eve, eve.client->remove_part(0, post)).refusal, Refusal::kObserver);
  EXPECT_EQ(answer(ben, ben.client->remove_part(0, post)).refusal, Refusal::kNone);
  EXPECT_TRUE(all_see([&](const Client& client) {
    return !client.find_part("post") && client.open_clashes().empty();
  }));
  EXPECT_EQ(answer(anna, anna.client->undo(0, post)).refusal, Refusal::kMovedBySomeoneElse);
  EXPECT_EQ(answer(ben, ben.client->undo(0, post)).refusal, Refusal::kNone);
  EXPECT_TRUE(all_see([&](const Client& client) {
    return client.find_part("post") == post && !client.open_clashes().empty();
  }));
  EXPECT_EQ(answer(anna, anna.client->set_moving(0, post, false)).refusal, Refusal::kNone);
  EXPECT_TRUE(all_see([&](const Client& client) { return !client.parts().at(post).info.moving; }));
  EXPECT_EQ(answer(ben, ben.client->grab(0, post)).refusal, Refusal::kPartIsStatic);
}

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
  late.enter(site->options, "late", "observer");
  ASSERT_TRUE(wait([&] {
    late.listen();
    return late.is_in();
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
  EXPECT_EQ(site->channel->counters().malformed, 0u);
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
  again.enter(site->options, "ben");
  ASSERT_TRUE(wait([&] {
    again.client->poll();
    return again.client->join_state(0) == JoinState::kJoined && present(anna, "ben");
  }));
  EXPECT_EQ(again.client->user_id(0), was);
  EXPECT_EQ(anna.client->users().size(), 3u);
}

}  // namespace
}  // namespace mortise::test
