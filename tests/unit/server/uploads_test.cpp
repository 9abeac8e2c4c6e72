// Mesh files that users send while ticks go on, and the parts that are made of them.
#include "server/uploads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "client/client.h"
#include "common/base/hash.h"
#include "common/io/scenario/brought_part.h"
#include "common/io/scenario/scene_load.h"
#include "common/messages/memory_channel.h"
#include "common/messages/mesh_bytes.h"
#include "common/session/world/part_shapes.h"
#include "server/standby.h"
#include "server/tick_loop.h"
#include "tests/support/cube_file.h"
#include "tests/unit/io/step_samples.h"
#include "tests/unit/server/small_world.h"

namespace mortise {
namespace {

using namespace mortise::testing;
using namespace std::chrono_literals;

class TickingClock : public Clock {
 public:
  std::int64_t now_ns() override { return now_ns_; }
  std::int64_t wall_ns() override { return now_ns_; }
  void sleep_until_ns(std::int64_t deadline_ns) override { now_ns_ = deadline_ns; }
  void pass() { now_ns_ += kSecond_ns / 60; }

 private:
  std::int64_t now_ns_ = 100 * kSecond_ns;
};

class KeptLog : public SessionLogWriter {
 public:
  void record(TickRecord record) override { records.push_back(std::move(record)); }
  Status close() override { return ok(); }
  std::uint64_t dropped_ticks() const override { return 0; }
  std::uint64_t bytes_written() const override { return 0; }
  Status status() const override { return ok(); }
  std::vector<TickRecord> records;
};

World world_with_shapes() {
  World world = small_world();
  world.policy = Policy::kReport;
  world.shapes = std::make_shared<PartShapes>([](SolidPtr solid, double) {
    return PartShape{std::move(solid), {}, nominal_band()};
  });
  world.shapes->add(world.parts[0].solid, 0.0);
  return world;
}

/// A client with one user, and what it was told.
struct Person {
  std::unique_ptr<ClientChannel> channel;
  std::unique_ptr<Client> client;
  LocalUser user = 0;
  std::map<std::uint64_t, Reply> replies;  ///< by sequence
  std::vector<UploadState> uploads;
  std::vector<Decision> decisions;
  std::vector<ClashEvent> events;
  std::vector<MeshBytes> meshes;

  void poll() {
    ClientUpdate update = client->poll();
    for (const Reply& reply : update.replies) replies[reply.seq] = reply;
    uploads.insert(uploads.end(), update.uploads.begin(), update.uploads.end());
    decisions.insert(decisions.end(), update.decisions.begin(), update.decisions.end());
    events.insert(events.end(), update.events.begin(), update.events.end());
    for (MeshBytes& mesh : update.meshes) meshes.push_back(std::move(mesh));
  }
};

class UploadTest : public ::testing::Test {
 protected:
  void begin(const InboxLimits& limits = {}) {
    server_ = hub_.open_server();
    TickLoopOptions options;
    options.inbox = limits;
    loop_ = std::make_unique<TickLoop>(world_, *server_, clock_, &log_, options);
    loop_->open();
  }
  Person& join(const std::string& name, const std::string& role = "designer") {
    people_.push_back(std::make_unique<Person>());
    Person& person = *people_.back();
    person.channel = hub_.open_client();
    person.client = std::make_unique<Client>(*person.channel, ClientOptions{},
                                             [this] { return clock_.now_ns(); });
    person.user = person.client->add_user(name, role);
    for (int i = 0; i < 4; ++i) turn();
    EXPECT_EQ(person.client->join_state(person.user), JoinState::kJoined);
    return person;
  }
  void turn() {
    clock_.pass();
    loop_->tick();
    for (const auto& person : people_) person->poll();
  }
  /// Ticks until then; what is made beside them takes its time.
  template <class Done>
  bool turn_until(Done done) {
    // A child reads the file, on a machine that may be busy, or with a sanitizer.
    for (int i = 0; i < 300'000; ++i) {
      turn();
      if (done()) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  bool answered(const Person& person, std::uint64_t seq) {
    return turn_until([&] { return person.replies.contains(seq); });
  }
  /// Pieces as a client of one's own sends them.
  void send(Person& person, const UploadPiece& piece) { person.channel->send(piece); }
  UploadPiece piece(const Person& person, std::uint64_t number, std::uint64_t offset,
                    std::uint64_t size, std::uint64_t length) {
    return {person.client->user_id(person.user), number, "a.mmsh", 1.0, "feed", length, offset,
            std::vector<std::byte>(size)};
  }
  UploadState last_state(Person& person) {
    for (int i = 0; i < 3; ++i) turn();
    EXPECT_FALSE(person.uploads.empty());
    return person.uploads.empty() ? UploadState{} : person.uploads.back();
  }

  MemoryHub hub_;
  TickingClock clock_;
  KeptLog log_;
  World world_ = world_with_shapes();
  std::unique_ptr<ServerChannel> server_;
  std::unique_ptr<TickLoop> loop_;
  std::vector<std::unique_ptr<Person>> people_;
};

TEST_F(UploadTest, APartIsMadeOfAFileAndEverybodySeesIt) {
  begin();
  Person& ada = join("ada");
  Person& bob = join("bob");
  const std::vector<std::byte> file = test::cube_file(4.0);
  EXPECT_EQ(ada.client->upload(ada.user, "post.stl", 1.0, file), 1U);
  const std::uint64_t seq = ada.client->add_part(ada.user, "post", content_hash(file),
                                                 Pose::translation({8.5, 0, 0}), true);
  const std::uint64_t other = ada.client->set_moving(ada.user, kBlue, false);
  ASSERT_TRUE(answered(ada, other)) << "it waits for nobody's mesh";
  EXPECT_FALSE(ada.replies.contains(seq));
  ASSERT_TRUE(answered(ada, seq));
  EXPECT_EQ(ada.replies[seq].refusal, Refusal::kNone) << ada.replies[seq].text;
  ASSERT_FALSE(ada.uploads.empty());
  EXPECT_TRUE(ada.uploads.back().ready);
  EXPECT_EQ(ada.uploads.back().received, file.size());
  EXPECT_TRUE(bob.uploads.empty());
  for (int i = 0; i < 12; ++i) turn();
  Person& late = join("late");
  const std::string hash = ada.uploads.back().mesh_hash;
  for (Person* person : {&ada, &bob, &late}) {
    const PartId id = person->client->find_part("post");
    ASSERT_EQ(id, PartId{4});
    const PartInfo& info = person->client->parts().at(id).info;
    EXPECT_EQ(info.mesh_hash, hash);
    EXPECT_GT(info.radius_mm, 6.9);
    EXPECT_TRUE(info.moving);
    EXPECT_EQ(std::ranges::count_if(person->meshes, [&](auto& m) { return m.hash == hash; }), 1);
    EXPECT_FALSE(person->client->parts().at(kBlue).info.moving);
    ASSERT_EQ(person->client->open_clashes().size(), 1U);
    EXPECT_EQ(person->client->open_clashes().begin()->second.cause, Decision::Kind::kAddPart);
  }
  // The log has the mesh with the tick that names it first.
  loop_->close();
  std::size_t meshes = 0;
  for (const TickRecord& record : log_.records)
    for (const SolidPtr& solid : record.meshes) {
      ++meshes;
      EXPECT_EQ(solid->hash(), hash);
      EXPECT_TRUE(std::ranges::any_of(
          record.decisions, [](const Decision& d) { return d.kind == Decision::Kind::kAddPart; }));
    }
  EXPECT_EQ(meshes, 1U);
}

TEST_F(UploadTest, AFileTakesThePlaceOfAMeshForEverybody) {
  begin();
  Person& ada = join("ada");
  Person& bob = join("bob");
  const std::string before = world_.parts[kBlue.value - 1].solid->hash();
  const std::vector<std::byte> file = test::cube_file(4.0);
  ada.client->upload(ada.user, "blue_b.stl", 1.0, file);
  const std::uint64_t seq = ada.client->replace_part(ada.user, kBlue, content_hash(file));
  EXPECT_FALSE(ada.replies.contains(seq)) << "the tick does not wait for it";
  ASSERT_TRUE(answered(ada, seq));
  EXPECT_EQ(ada.replies[seq].refusal, Refusal::kNone) << ada.replies[seq].text;
  const std::string after = ada.uploads.back().mesh_hash;
  EXPECT_NE(before, after);
  for (int i = 0; i < 12; ++i) turn();
  Person& late = join("late");
  for (Person* person : {&ada, &bob, &late}) {
    const PartInfo& info = person->client->parts().at(kBlue).info;
    EXPECT_EQ(info.mesh_hash, after);
    EXPECT_EQ(info.name, "blue");
    EXPECT_LT(info.radius_mm, 7.0);
  }
  const std::uint64_t back = ada.client->undo(ada.user, kBlue);
  ASSERT_TRUE(answered(ada, back));
  EXPECT_EQ(ada.replies[back].refusal, Refusal::kNone) << ada.replies[back].text;
  EXPECT_TRUE(turn_until([&] { return bob.client->parts().at(kBlue).info.mesh_hash == before; }));
}

TEST_F(UploadTest, AMeshOfTheSessionNeedsNoUpload) {
  begin();
  Person& ada = join("ada");
  const std::string hash = world_.parts[0].solid->hash();
  const std::uint64_t seq =
      ada.client->add_part(ada.user, "copy", hash, Pose::translation({0, 90, 0}), true);
  ASSERT_TRUE(answered(ada, seq));
  EXPECT_EQ(ada.replies[seq].refusal, Refusal::kNone) << ada.replies[seq].text;
  const std::uint64_t gone = ada.client->remove_part(ada.user, PartId{4});
  ASSERT_TRUE(answered(ada, gone));
  EXPECT_FALSE(ada.client->find_part("copy"));
  const std::uint64_t back = ada.client->undo(ada.user, PartId{4});
  ASSERT_TRUE(answered(ada, back));
  EXPECT_TRUE(turn_until([&] { return bool(ada.client->find_part("copy")); }));
}

TEST_F(UploadTest, WhatCannotBeReadIsSaidWithTheNameThatWasGiven) {
  begin();
  Person& ada = join("ada");
  const std::vector<std::byte> file(5000, std::byte{7});
  for (const char* name : {"bad.stl", "bad.mmsh", "bad.txt", "bad.step"}) {
    ada.client->upload(ada.user, name, 1.0, file);
    const std::uint64_t seq =
        ada.client->add_part(ada.user, "post", content_hash(file), Pose{}, true);
    ASSERT_TRUE(answered(ada, seq)) << name;
    EXPECT_EQ(ada.replies[seq].refusal, Refusal::kUnreadableMesh) << name;
    EXPECT_EQ(ada.uploads.back().refusal, Refusal::kUnreadableMesh) << name;
    const std::string& text = ada.replies[seq].text;
    EXPECT_TRUE(text.starts_with(name)) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_EQ(text.find("/tmp"), std::string::npos) << text;
  }
  const std::uint64_t seq = ada.client->add_part(ada.user, "post", "feed", Pose{}, true);
  ASSERT_TRUE(answered(ada, seq));
  EXPECT_EQ(ada.replies[seq].refusal, Refusal::kUnknownMesh);
}

TEST_F(UploadTest, EachLimitIsOneLine) {
  InboxLimits limits;
  limits.upload_bytes = 1000;
  limits.upload_bytes_of_user = 2500;
  limits.uploads_at_once = 2;
  begin(limits);
  Person& ada = join("ada");
  Person& bot = join("bot", "bot");
  send(bot, piece(bot, 1, 0, 10, 100));
  EXPECT_EQ(last_state(bot).refusal, Refusal::kNoRight);
  send(ada, piece(ada, 1, 0, 10, 1001));
  EXPECT_EQ(last_state(ada).refusal, Refusal::kUploadLimit);
  send(ada, piece(ada, 2, 0, 10, 1000));
  EXPECT_EQ(last_state(ada).refusal, Refusal::kNone);
  EXPECT_EQ(last_state(ada).received, 10U);
  send(ada, piece(ada, 3, 0, 10, 1000));
  EXPECT_EQ(last_state(ada).refusal, Refusal::kNone);
  send(ada, piece(ada, 4, 0, 10, 100));
  EXPECT_EQ(last_state(ada).refusal, Refusal::kUploadLimit) << "two are under way";
  send(ada, piece(ada, 2, 20, 10, 1000));
  EXPECT_EQ(last_state(ada).refusal, Refusal::kUnreadableMesh) << "a piece is missing";
  send(ada, piece(ada, 5, 0, 10, 600));
  EXPECT_EQ(last_state(ada).refusal, Refusal::kUploadLimit) << "all of the user together";
  EXPECT_NE(last_state(ada).text.find("'ada'"), std::string::npos);
  // Bytes that are not what was announced.
  send(ada, piece(ada, 6, 0, 100, 100));
  EXPECT_TRUE(turn_until([&] { return ada.uploads.back().refusal != Refusal::kNone; }));
  EXPECT_EQ(ada.uploads.back().refusal, Refusal::kUnreadableMesh);
  EXPECT_NE(ada.uploads.back().text.find("announced"), std::string::npos);
  for (const Person* person : {&ada, &bot})
    for (const UploadState& state : person->uploads)
      EXPECT_EQ(state.text.find('\n'), std::string::npos);
}

// However it is cut, it is one file.
TEST_F(UploadTest, AFileMayComeInPiecesOfAnySize) {
  begin();
  Person& ada = join("ada");
  const std::vector<std::byte> file = test::cube_file(4.0);
  std::size_t at = 0;
  for (std::size_t size = 1; at < file.size(); size = 2 * size + 1) {
    const std::size_t end = std::min(file.size(), at + size);
    send(ada, {ada.client->user_id(ada.user),
               1,
               "post.stl",
               1.0,
               content_hash(file),
               file.size(),
               at,
               {file.begin() + static_cast<std::ptrdiff_t>(at),
                file.begin() + static_cast<std::ptrdiff_t>(end)}});
    at = end;
  }
  ASSERT_TRUE(turn_until([&] { return !ada.uploads.empty() && ada.uploads.back().ready; }));
  EXPECT_EQ(ada.uploads.back().received, file.size());
  EXPECT_TRUE(world_.shapes->find(ada.uploads.back().mesh_hash).solid);
}

// What the session has no use for any more is let go of beside the ticks.
TEST(PartMaker, LetsGoOfWhatItIsGivenInItsThread) {
  PartMaker maker(world_with_shapes().shapes->make(), 1, nullptr);
  std::atomic<bool> is_gone = false;
  std::thread::id by;
  maker.discard(nullptr);
  maker.discard(std::shared_ptr<const void>(&by, [&](const void*) {
    by = std::this_thread::get_id();
    is_gone = true;
  }));
  for (int i = 0; i < 60'000 && !is_gone; ++i) std::this_thread::sleep_for(1ms);
  ASSERT_TRUE(is_gone);
  EXPECT_NE(by, std::this_thread::get_id());
}

TEST_F(UploadTest, WhoSendsFasterThanIsConfirmedIsCutOff) {
  begin();
  Person& ada = join("ada");
  for (std::uint64_t i = 0; i < 9; ++i)
    send(ada, piece(ada, 1, i * kUploadPiece_bytes, kUploadPiece_bytes, 600'000));
  EXPECT_EQ(last_state(ada).refusal, Refusal::kRateTooHigh);
}

TEST_F(UploadTest, APieceForSomebodyElseIsDropped) {
  begin();
  Person& ada = join("ada");
  Person& bob = join("bob");
  send(bob, piece(ada, 1, 0, 10, 100));
  for (int i = 0; i < 3; ++i) turn();
  EXPECT_TRUE(ada.uploads.empty());
  EXPECT_GT(loop_->inbox().counters().foreign, 0U);
}

TEST_F(UploadTest, WhatIsNotCompleteGoesWithItsUser) {
  begin();
  Person& ada = join("ada");
  send(ada, piece(ada, 1, 0, 10, 100));
  EXPECT_EQ(last_state(ada).received, 10U);
  ada.client->leave(ada.user);
  for (int i = 0; i < 3; ++i) turn();
  Person& again = join("ada");
  send(again, piece(again, 1, 10, 10, 100));
  for (int i = 0; i < 3; ++i) turn();
  EXPECT_TRUE(again.uploads.empty()) << "nothing goes on from what it had sent";
}

/// A channel to clients with a server that stands by.
struct Followed final : ServerChannel {
  explicit Followed(ServerChannel& inner) : inner_(inner) {}
  std::vector<ToldTick> told;
  bool came = true;

  ServerInput take() override {
    ServerInput input = inner_.take();
    input.follower_came = std::exchange(came, false);
    return input;
  }
  bool has_follower() const override { return true; }
  void publish_tick(const ToldTick& tick) override { told.push_back(tick); }
  void publish_join_reply(const JoinReply& reply) override { inner_.publish_join_reply(reply); }
  void publish_replies(std::span<const Reply> x) override { inner_.publish_replies(x); }
  void publish_decisions(std::span<const Decision> x) override { inner_.publish_decisions(x); }
  void publish_standing(std::span<const StandingChange> x) override { inner_.publish_standing(x); }
  void publish_refusals(std::span<const RefusedIncrement> x) override {
    inner_.publish_refusals(x);
  }
  void publish_uploads(std::span<const UploadState> x) override { inner_.publish_uploads(x); }
  void publish_poses(const PoseBatch& x) override { inner_.publish_poses(x); }
  void publish_events(std::span<const ClashEvent> x) override { inner_.publish_events(x); }
  void publish_snapshot(Snapshot x) override { inner_.publish_snapshot(std::move(x)); }
  void publish_mesh(const std::string& hash, std::span<const std::byte> x) override {
    inner_.publish_mesh(hash, x);
  }
  void publish_coming_mesh(const std::string& hash, std::span<const std::byte> x) override {
    inner_.publish_coming_mesh(hash, x);
  }
  void publish_features(const FeatureTable& x) override { inner_.publish_features(x); }
  void publish_pulse(const SessionPulse& x) override { inner_.publish_pulse(x); }
  bool has_readers() const override { return inner_.has_readers(); }
  ChannelCounters counters() const override { return inner_.counters(); }

 private:
  ServerChannel& inner_;
};

// The one that stands by has the mesh before the decision that names it, also where it came while
// the mesh was told to another one.
TEST_F(UploadTest, TheOneThatStandsByMakesTheSamePart) {
  const auto inner = hub_.open_server();
  Followed channel(*inner);
  loop_ = std::make_unique<TickLoop>(world_, channel, clock_, &log_, TickLoopOptions{});
  loop_->open();
  World twin = world_with_shapes();
  SessionStatistics statistics;
  Follower follower(twin, statistics, nullptr, 1);
  const auto follow = [&] {
    for (const ToldTick& tick : std::exchange(channel.told, {})) {
      while (!follower.has_meshes()) std::this_thread::sleep_for(1ms);
      const Status taken = follower.take(tick);
      ASSERT_TRUE(taken) << taken.error().text;
    }
  };
  Person& ada = join("ada");
  // More than goes in one piece.
  TriangleMesh mesh;
  for (int i = 0; i < 3000; ++i) {
    const TriangleMesh one = cube(0.2);
    const auto first = static_cast<std::uint32_t>(mesh.points_mm.size());
    for (const Vec3& point : one.points_mm) mesh.points_mm.push_back(point + Vec3(i, 0, 0));
    for (const auto& t : one.triangles)
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  const std::vector<std::byte> file = mesh_to_bytes(mesh.points_mm, mesh.triangles);
  ASSERT_GT(file.size(), 3U * 256U * 1024U);
  ada.client->upload(ada.user, "row.mmsh", 1.0, file);
  ASSERT_TRUE(turn_until([&] { return !ada.uploads.empty() && ada.uploads.back().ready; }));
  const std::uint64_t seq = ada.client->add_part(ada.user, "row", content_hash(file),
                                                 Pose::translation({0, 0, 99}), true);
  turn();
  turn();
  turn();
  ASSERT_FALSE(ada.replies.contains(seq)) << "the mesh is still being told";
  channel.came = true;  // another one, which has heard the pieces from the middle on
  ASSERT_TRUE(answered(ada, seq));
  EXPECT_EQ(ada.replies[seq].refusal, Refusal::kNone) << ada.replies[seq].text;
  turn();
  follow();
  ASSERT_EQ(twin.parts.size(), 4U);
  EXPECT_EQ(twin.parts[3].solid->hash(), world_.parts[3].solid->hash());
  EXPECT_EQ(follower.last_tick(), world_.tick);
}

World world_of_shapes() {
  World world = world_with_shapes();
  world.shapes = std::make_shared<PartShapes>([](SolidPtr solid, double quantum_mm) {
    return shape_of(std::move(solid), quantum_mm, UndeclaredSurface::kRecognized);
  });
  world.shapes->add(world.parts[0].solid, 0.0);
  return world;
}

std::string stated_faces_of(const Part& part) {
  std::string text;
  for (const SurfaceBand::Face& face : part.band.faces)
    text += face.name + " " + std::to_string(static_cast<int>(face.grade)) + " " +
            face.tolerance_source + "; ";
  return text;
}

// Of a STEP file: surfaces and tolerances reach the one that leads, the one that stands by, the log
// and everybody, also who comes later.
TEST_F(UploadTest, WhatAFileStatesOfItsFacesIsKnownToAll) {
  StepDocument document = test::ring_and_pins();
  StepStatement& size = document.statements.emplace_back();
  size.kind = StepStatement::Kind::kSize;
  size.name = "diameter";
  size.value = 20.0;
  size.code = "g6";
  size.faces = {{1, test::cylinder_of(document.parts[1], false)}};
  document.parts[1].loose_faces = 1;
  const std::vector<std::byte> file = brought_bytes(document, 1);
  const auto inner = hub_.open_server();
  Followed channel(*inner);
  world_ = world_of_shapes();
  loop_ = std::make_unique<TickLoop>(world_, channel, clock_, &log_, TickLoopOptions{});
  loop_->open();
  World twin = world_of_shapes();
  SessionStatistics statistics;
  Follower follower(twin, statistics, nullptr, 1);
  Person& ada = join("ada");
  ada.client->upload(ada.user, "pin.step.mmsh", 1.0, file);
  const std::uint64_t seq = ada.client->add_part(ada.user, "pin", content_hash(file),
                                                 Pose::translation({0, 0, 99}), true);
  ASSERT_TRUE(answered(ada, seq));
  ASSERT_EQ(ada.replies[seq].refusal, Refusal::kNone) << ada.replies[seq].text;
  for (int i = 0; i < 12; ++i) turn();
  Person& late = join("late");
  ASSERT_TRUE(turn_until([&] { return !late.client->features().of(PartId{4}).empty(); }));
  const Part& part = world_.parts[3];
  EXPECT_NE(stated_faces_of(part).find("shaft_1 2 Ø20 g6"), std::string::npos)
      << stated_faces_of(part);
  EXPECT_EQ(part.notes, std::vector<std::string>{"1 faces that bound no solid were left out"});
  for (Person* person : {&ada, &late}) {
    const auto mesh = std::ranges::find(person->meshes, part.solid->hash(), &MeshBytes::hash);
    ASSERT_NE(mesh, person->meshes.end());
    EXPECT_TRUE(mesh_from_bytes(mesh->bytes)) << "clients get the mesh alone";
    const auto features = person->client->features().of(PartId{4});
    const auto shaft = std::ranges::find(features, "shaft_1", &FeatureInfo::name);
    ASSERT_NE(shaft, features.end());
    EXPECT_EQ(shaft->origin, FeatureOrigin::kDeclared);
  }
  for (const ToldTick& tick : channel.told) {
    while (!follower.has_meshes()) std::this_thread::sleep_for(1ms);
    const Status taken = follower.take(tick);
    ASSERT_TRUE(taken) << taken.error().text;
  }
  ASSERT_EQ(twin.parts.size(), 4U);
  EXPECT_EQ(stated_faces_of(twin.parts[3]), stated_faces_of(part));
  loop_->close();
  std::size_t logged = 0;
  for (const TickRecord& record : log_.records)
    for (const SolidPtr& solid : record.meshes) logged += solid->mesh().stated != nullptr ? 1 : 0;
  EXPECT_EQ(logged, 1U);
}

TEST_F(UploadTest, WhatIsNoPartOfAStepFileIsRefusedInOneLine) {
  world_ = world_of_shapes();
  begin();
  Person& ada = join("ada");
  std::vector<std::byte> file = brought_bytes(test::ring_and_pins(), 1);
  file.resize(file.size() - 5);
  ada.client->upload(ada.user, "pin.step.mmsh", 1.0, file);
  ASSERT_TRUE(turn_until(
      [&] { return !ada.uploads.empty() && ada.uploads.back().refusal != Refusal::kNone; }));
  EXPECT_EQ(ada.uploads.back().refusal, Refusal::kUnreadableMesh);
  EXPECT_EQ(ada.uploads.back().text.substr(0, 15), "pin.step.mmsh: ");
  EXPECT_EQ(ada.uploads.back().text.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace mortise
