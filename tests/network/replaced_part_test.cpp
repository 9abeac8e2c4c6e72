// Parts that took another mesh, came, went or were made to stand, and then the server is gone: the
// session goes on with them.
#include <gtest/gtest.h>
#include <signal.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/base/hash.h"
#include "common/generators/generators.h"
#include "common/messages/names.h"
#include "tests/network/second_server.h"
#include "tests/support/cube_file.h"
#include "tests/support/stl_file.h"

namespace mortise::test {
namespace {

// Its face has no fit; as it is, it reaches a tenth of a millimetre into the plate all around.
constexpr CollisionClass kOfThick = CollisionClass::kReal;

/// anna holds a peg in its hole, which is fake as its fit says; revision B of it is too thick.
class ReplacedPeg : public SecondServer {
 protected:
  std::unique_ptr<Program> lead_with_peg() {
    auto server = start({folder_.write("peg.yaml", peg_yaml()), "--log", logs()});
    join("block");
    if (HasFatalFailure()) return server;
    EXPECT_TRUE(anna_->grab("peg"));
    anna_->client->send(anna_->user, peg(), {0, 0, -25});
    EXPECT_TRUE(all_have(first_mesh(), CollisionClass::kFake)) << server->errors();
    return server;
  }
  PartId peg() const { return anna_->client->find_part("peg"); }
  std::string mesh_of_peg(const Guest& guest) const {
    const PartId part = guest.client->find_part("peg");
    return part ? guest.client->parts().at(part).info.mesh_hash : "";
  }
  std::string first_mesh() {
    if (first_mesh_.empty()) first_mesh_ = mesh_of_peg(*anna_);
    return first_mesh_;
  }
  bool all_see(const std::function<bool(const Client&)>& so) {
    return wait_until(
        [&] { return so(*anna_->client) && so(*ben_->client) && so(*otto_->client); });
  }
  /// As all three see it: this mesh, and one open clash of this class.
  bool all_have(const std::string& mesh, CollisionClass is) {
    return wait_until([&] {
      for (const Guest* guest : {anna_.get(), ben_.get(), otto_.get()}) {
        const auto open = clashes(*guest);
        if (mesh_of_peg(*guest) != mesh || open.size() != 1 || open.begin()->second != is)
          return false;
      }
      return true;
    });
  }
  /// Returns the mesh that the peg then has, as all three see it.
  std::string take_revision_b() {
    const auto thick = generate("dowel", {{"diameter_mm", 20.2},
                                          {"length_mm", 40},
                                          {"chamfer_mm", 1},
                                          {"facets", 48},
                                          {"phase_rad", 0.1}});
    EXPECT_TRUE(thick) << thick.error().text;
    const std::vector<std::byte> file = stl_file(thick->mesh);
    const std::string before = mesh_of_peg(*anna_);
    EXPECT_NE(anna_->client->upload(anna_->user, "peg_b.stl", 1.0, file), 0u);
    EXPECT_NE(anna_->client->replace_part(anna_->user, peg(), content_hash(file)), 0u);
    EXPECT_TRUE(wait_until([&] { return mesh_of_peg(*anna_) != before; })) << told();
    EXPECT_TRUE(all_have(mesh_of_peg(*anna_), kOfThick)) << told();
    return mesh_of_peg(*anna_);
  }
  void undo(bool again = false) {
    if (again)
      anna_->client->redo(anna_->user, peg());
    else
      anna_->client->undo(anna_->user, peg());
  }
  void kill_first(Program& first, Program& second) {
    first.signal(SIGKILL);
    EXPECT_TRUE(says(second, "taken over at tick")) << second.errors();
    all_know_that_it_is_gone();
    EXPECT_TRUE(all_in());
  }
  /// What is sent before that is sent to nobody.
  void all_know_that_it_is_gone() {
    EXPECT_TRUE(wait_until([&] { return losses_ >= losses_seen_ + kClients; }));
    losses_seen_ = losses_;
  }
  std::unique_ptr<Program> go_on(std::vector<std::string> arguments) {
    all_know_that_it_is_gone();
    arguments.insert(arguments.begin(), {"--restore", logs()});
    auto server = start(arguments);
    EXPECT_TRUE(all_in()) << server->errors();
    return server;
  }
  std::string told() const {
    std::string all;
    for (const auto& [id, clash] : anna_->client->open_clashes())
      all += std::string(name_of(clash.verdict.collision_class)) + ": " +
             clash.verdict.explanation + "\n";
    for (const Reply& reply : anna_->replies) all += reply.text + "\n";
    return all;
  }
  /// The log of the last server, as it is written.
  void expect_verified() {
    const auto logs_now = logs_to_restore(logs(), "default", Newest::kWritten);
    ASSERT_FALSE(logs_now.empty());
    const auto log = read_session(logs_now.front());
    ASSERT_TRUE(log) << log.error().text;
    const auto report = verify(*log, 1);
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_FALSE(report->difference) << report->difference->what;
    EXPECT_EQ(report->not_verifiable, "");
  }

 private:
  std::string first_mesh_;
  int losses_seen_ = 0;
};

TEST_F(ReplacedPeg, ASecondServerThatStoodByHasTheNewMeshAndUndoesIt) {
  const auto first = lead_with_peg();
  const auto second = stand_by();
  ASSERT_FALSE(HasFailure());
  const std::string thick = take_revision_b();
  const AllIn before = as_all_are();
  kill_first(*first, *second);
  EXPECT_TRUE(all_have(thick, kOfThick));
  EXPECT_EQ(clashes(*otto_), before.clashes) << "it is the same clash";
  EXPECT_EQ(anna_->holder("peg"), before.anna);
  undo();
  EXPECT_TRUE(all_have(first_mesh(), CollisionClass::kFake)) << "the fit is of it again" << told();
  undo(true);
  EXPECT_TRUE(all_have(thick, kOfThick)) << told();
  second->signal(SIGINT);
  EXPECT_EQ(second->wait(kPatience_s), 0) << second->errors();
  expect_verified();
}

TEST_F(ReplacedPeg, ASecondServerThatComesAfterwardsHasTheNewMeshAndUndoesIt) {
  const auto first = lead_with_peg();
  ASSERT_FALSE(HasFailure());
  const std::string thick = take_revision_b();
  undo();
  EXPECT_TRUE(all_have(first_mesh(), CollisionClass::kFake)) << told();
  undo(true);
  EXPECT_TRUE(all_have(thick, kOfThick)) << told();
  const auto second = stand_by();
  ASSERT_FALSE(HasFailure());
  kill_first(*first, *second);
  EXPECT_TRUE(all_have(thick, kOfThick));
  undo();
  EXPECT_TRUE(all_have(first_mesh(), CollisionClass::kFake)) << told();
  second->signal(SIGINT);
  EXPECT_EQ(second->wait(kPatience_s), 0) << second->errors();
  expect_verified();
}

TEST_F(ReplacedPeg, ASessionThatGoesOnFromItsLogHasTheNewMeshAndUndoesIt) {
  const auto first = lead_with_peg();
  ASSERT_FALSE(HasFailure());
  const std::string thick = take_revision_b();
  const UserId anna = anna_->client->user_id(0);
  turn(2.2);  // two flushes later all of it is on disk
  first->signal(SIGKILL);
  EXPECT_EQ(first->wait(kPatience_s), 128 + SIGKILL);
  auto again = go_on({"--log", logs()});
  EXPECT_TRUE(all_have(thick, kOfThick)) << again->errors();
  EXPECT_EQ(anna_->client->user_id(0), anna);
  undo();
  EXPECT_TRUE(all_have(first_mesh(), CollisionClass::kFake)) << told();
  again->signal(SIGINT);
  EXPECT_EQ(again->wait(kPatience_s), 0) << again->errors();
  expect_verified();
  // What was taken back is as much in the log as what was done.
  again = go_on({"--no-log"});
  EXPECT_TRUE(all_have(first_mesh(), CollisionClass::kFake)) << again->errors();
  undo(true);
  EXPECT_TRUE(all_have(thick, kOfThick)) << told();
}

TEST_F(ReplacedPeg, ASessionThatGoesOnFromItsLogHasThePartsThatCameAndWent) {
  const auto first = lead_with_peg();
  ASSERT_FALSE(HasFailure());
  Client& anna = *anna_->client;
  // A post in the block that then stands, and another one that is taken away.
  const std::vector<std::byte> file = cube_file(5.0);
  const std::string hash = content_hash(file);
  EXPECT_NE(anna.upload(0, "post.stl", 1.0, file), 0u);
  EXPECT_NE(anna.add_part(0, "post", hash, Pose::translation({104, 0, 0}), true), 0u);
  EXPECT_NE(anna.add_part(0, "spare", hash, Pose::translation({200, 0, 0}), true), 0u);
  ASSERT_TRUE(all_see([](const Client& client) {
    return client.find_part("post") && client.find_part("spare") &&
           client.open_clashes().size() == 2;
  })) << told();
  const PartId post = anna.find_part("post"), spare = anna.find_part("spare");
  anna.set_moving(0, post, false);
  anna.remove_part(0, spare);
  const auto as_it_was = [&](const Client& client) {
    return client.find_part("post") == post && !client.parts().at(post).info.moving &&
           !client.find_part("spare") && client.open_clashes().size() == 2;
  };
  ASSERT_TRUE(all_see(as_it_was)) << told();
  const auto clashes_before = clashes(*anna_);
  turn(2.2);  // two flushes later all of it is on disk
  first->signal(SIGKILL);
  EXPECT_EQ(first->wait(kPatience_s), 128 + SIGKILL);

  auto again = go_on({"--log", logs()});
  ASSERT_TRUE(all_see(as_it_was)) << again->errors();
  EXPECT_EQ(clashes(*anna_), clashes_before);
  // Who comes now gets the mesh, and what was done is taken back.
  Guest late(domain_, "late");
  const std::string mesh = anna.parts().at(post).info.mesh_hash;
  bool has_mesh = false;
  EXPECT_TRUE(wait_until([&] {
    for (const MeshBytes& bytes : late.listen().meshes) has_mesh |= bytes.hash == mesh;
    return has_mesh && as_it_was(*late.client);
  }));
  anna.undo(0, post);
  anna.undo(0, spare);
  EXPECT_TRUE(all_see([&](const Client& client) {
    return client.find_part("spare") == spare && client.parts().at(post).info.moving;
  })) << told();
  again->signal(SIGINT);
  EXPECT_EQ(again->wait(kPatience_s), 0) << again->errors();
  expect_verified();
}

}  // namespace
}  // namespace mortise::test
