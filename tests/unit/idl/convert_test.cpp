// The door: what we send comes back as it was; what nobody of us sends is refused.
#include "idl/convert.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/base/constants.h"
#include "common/math/rotation.h"
#include "tests/support/numbers.h"
#include "tests/unit/idl/samples.h"

namespace mortise {
namespace {

TEST(Convert, IncrementGoesRound) {
  const Increment sent = test::some_increment();
  Increment next = sent;
  ++next.seq;
  const auto got = from_wire(to_wire(IncrementBatch{3, next.seq, {{sent, 123}, {next, 124}}}));
  ASSERT_TRUE(got);
  ASSERT_EQ(got->size(), 2u);
  const ReceivedIncrement& first = got->front();
  EXPECT_EQ(first.at_door, Refusal::kNone);
  EXPECT_EQ(first.sent_ns, 123);
  EXPECT_EQ(first.kept_from, 3u);
  EXPECT_TRUE(first.repeated);
  EXPECT_EQ(first.increment.user, sent.user);
  EXPECT_EQ(first.increment.part, sent.part);
  EXPECT_EQ(first.increment.seq, sent.seq);
  EXPECT_EQ(first.increment.translation_mm, sent.translation_mm);
  EXPECT_EQ(first.increment.rotation_rad, sent.rotation_rad);
  EXPECT_EQ(got->back().increment.seq, next.seq);
  EXPECT_FALSE(got->back().repeated);
}

TEST(Convert, ABatchThatIsNoneIsRefusedAsAWhole) {
  const auto passes = [](std::vector<std::uint64_t> sequence, std::uint64_t kept_from = 1) {
    IncrementBatch batch{kept_from, 1, {}};
    for (const std::uint64_t seq : sequence) {
      batch.increments.push_back({test::some_increment(), 1});
      batch.increments.back().increment.seq = seq;
    }
    return bool(from_wire(to_wire(batch)));
  };
  EXPECT_FALSE(passes({}));
  EXPECT_TRUE(passes({1, 2, 9}));
  EXPECT_FALSE(passes({1, 1}));
  EXPECT_FALSE(passes({2, 1}));
  EXPECT_TRUE(passes({7}, 7));
  EXPECT_FALSE(passes({7}, 8)) << "it says that it does not keep what it sends";
  std::vector<std::uint64_t> many;
  while (many.size() < kMaxBatchIncrements) many.push_back(many.size() + 1);
  EXPECT_TRUE(passes(many));
  many.push_back(many.size() + 1);
  EXPECT_FALSE(passes(many));
}

TEST(Convert, IncrementIsRefusedWithItsReason) {
  const auto refusal_of = [](auto change) {
    Increment increment = test::some_increment();
    change(increment);
    const auto got = from_wire(to_wire(batch_of(increment, 1)));
    EXPECT_TRUE(got);
    EXPECT_EQ(got->front().increment.user, increment.user);
    EXPECT_EQ(got->front().increment.seq, increment.seq);
    return got->front().at_door;
  };
  for (const double bad : {kNan, kInf, -kInf}) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(refusal_of([&](Increment& i) { i.translation_mm[axis] = bad; }),
                Refusal::kNotFinite);
      EXPECT_EQ(refusal_of([&](Increment& i) { i.rotation_rad[axis] = bad; }), Refusal::kNotFinite);
    }
  }
  EXPECT_EQ(refusal_of([](Increment& i) { i.rotation_rad = Vec3(0, 3.2, 0); }),
            Refusal::kRotationTooLarge);
  EXPECT_EQ(refusal_of([](Increment& i) { i.rotation_rad = Vec3(1e300, 1e300, 0); }),
            Refusal::kRotationTooLarge);
  EXPECT_EQ(refusal_of([](Increment& i) { i.rotation_rad = Vec3(0, 0, kMaxRotationPerTick_rad); }),
            Refusal::kNone);
  EXPECT_EQ(refusal_of([](Increment& i) { i.translation_mm = Vec3(0, 2e9, 0); }),
            Refusal::kJumpTooLarge);
  EXPECT_EQ(refusal_of([](Increment& i) { i.translation_mm = Vec3(1e300, 1e300, 1e300); }),
            Refusal::kJumpTooLarge);
  EXPECT_EQ(refusal_of([](Increment& i) { i.part = PartId{}; }), Refusal::kUnknownPart);
  EXPECT_EQ(refusal_of([](Increment& i) { i.seq = 0; }), Refusal::kStale);
  Increment nobody = test::some_increment();
  nobody.user = UserId{};
  EXPECT_FALSE(from_wire(to_wire(batch_of(nobody, 1))));
}

TEST(Convert, RequestsGoRound) {
  Request join;
  join.kind = Request::Kind::kJoin;
  join.nonce = 7;
  join.name = "Ännchen";
  join.role = "observer";
  const Result<Request> got = from_wire(to_wire(join));
  ASSERT_TRUE(got);
  EXPECT_EQ(got->name, join.name);
  EXPECT_EQ(got->role, join.role);
  EXPECT_EQ(got->nonce, 7u);
  Request command;
  command.kind = Request::Kind::kCommand;
  command.command = {UserId{3}, PartId{4}, 5, CommandKind::kUndo};
  const Result<Request> back = from_wire(to_wire(command));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->kind, Request::Kind::kCommand);
  EXPECT_EQ(back->command.user, UserId{3});
  EXPECT_EQ(back->command.part, PartId{4});
  EXPECT_EQ(back->command.seq, 5u);
  EXPECT_EQ(back->command.kind, CommandKind::kUndo);
  Request leave;
  leave.kind = Request::Kind::kLeave;
  leave.command.user = UserId{3};
  const Result<Request> gone = from_wire(to_wire(leave));
  ASSERT_TRUE(gone);
  EXPECT_EQ(gone->kind, Request::Kind::kLeave);
  EXPECT_EQ(gone->command.user, UserId{3});
  Request snapshot;
  snapshot.kind = Request::Kind::kSnapshot;
  const Result<Request> wanted = from_wire(to_wire(snapshot));
  ASSERT_TRUE(wanted);
  EXPECT_EQ(wanted->kind, Request::Kind::kSnapshot);
}

TEST(Convert, EditsOfPartsGoRoundAndAreRefused) {
  Request request;
  request.kind = Request::Kind::kCommand;
  request.command = {UserId{3}, PartId{}, 5, CommandKind::kAddPart};
  const PartEdit edit{"bracket", "feed", Pose{Quat(0.6, 0.8, 0, 0), Vec3(1, 2, 3)}, true, 0.5};
  request.command.details.edit = edit;
  const auto back = from_wire(to_wire(request));
  ASSERT_TRUE(back && back->command.details.edit);
  EXPECT_EQ(*back->command.details.edit, edit);
  const auto refused = [&](auto change) {
    wire::Request wire = to_wire(request);
    change(wire.command()[0].details().edit());
    return !from_wire(wire);
  };
  EXPECT_TRUE(refused([](auto& e) { e.push_back(e[0]); }));
  EXPECT_TRUE(refused([](auto& e) { e[0].name("a\nb"); }));
  EXPECT_TRUE(refused([](auto& e) { e[0].quantum_mm(kNan); }));
  EXPECT_TRUE(refused([](auto& e) { e[0].pose().q()[0] = 2.0; }));
  EXPECT_TRUE(refused([](auto& e) { e[0].pose().p_mm()[1] = kInf; }));
}

TEST(Convert, UploadsGoRoundAndAreRefused) {
  Request request;
  request.kind = Request::Kind::kUpload;
  request.piece = {UserId{3}, 7, "bracket.stl", 25.4, "feed", 10, 4, std::vector<std::byte>(6)};
  const auto back = from_wire(to_wire(request));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->kind, Request::Kind::kUpload);
  EXPECT_EQ(back->piece.user, UserId{3});
  EXPECT_EQ(back->piece.upload, 7U);
  EXPECT_EQ(back->piece.name, "bracket.stl");
  EXPECT_EQ(back->piece.unit_mm, 25.4);
  EXPECT_EQ(back->piece.hash, "feed");
  EXPECT_EQ(back->piece.length, 10U);
  EXPECT_EQ(back->piece.offset, 4U);
  EXPECT_EQ(back->piece.bytes.size(), 6U);
  const auto refused = [&](auto change) {
    wire::Request wire = to_wire(request);
    change(wire.upload()[0]);
    return !from_wire(wire);
  };
  EXPECT_TRUE(refused([](auto& u) { u.user(0); }));
  EXPECT_TRUE(refused([](auto& u) { u.upload(0); }));
  EXPECT_TRUE(refused([](auto& u) { u.unit_mm(0.0); }));
  EXPECT_TRUE(refused([](auto& u) { u.unit_mm(kInf); }));
  EXPECT_TRUE(refused([](auto& u) { u.offset(5); })) << "beyond its end";
  EXPECT_TRUE(refused([](auto& u) { u.offset(~std::uint64_t{0}); }));
  EXPECT_TRUE(refused([](auto& u) { u.bytes().clear(); }));
  EXPECT_TRUE(refused([](auto& u) {
    u.length(1'000'000);
    u.bytes().resize(kUploadPiece_bytes + 1);
  }));
  const UploadState state{UserId{3}, 7, 10, true, "feed", "open", Refusal::kNone};
  const auto answers = from_wire(to_wire({}, {}, {}, {}, {}, std::span(&state, 1)));
  ASSERT_TRUE(answers && answers->uploads.size() == 1);
  EXPECT_EQ(answers->uploads[0].mesh_hash, "feed");
  EXPECT_TRUE(answers->uploads[0].ready);
  EXPECT_EQ(answers->uploads[0].received, 10U);
}

TEST(Convert, RequestsAreRefused) {
  const auto passes = [](auto change) {
    wire::Request request;
    wire::Command command;
    command.user(1);
    command.kind(1);
    request.command().push_back(command);
    change(request);
    return static_cast<bool>(from_wire(request));
  };
  EXPECT_TRUE(passes([](wire::Request&) {}));
  EXPECT_FALSE(passes([](wire::Request& r) { r.command()[0].user(0); }));
  EXPECT_FALSE(passes([](wire::Request& r) { r.command()[0].kind(0); }));
  EXPECT_FALSE(passes([](wire::Request& r) { r.command()[0].kind(kCommandKindCount); }));
  // Exactly one thing is asked for.
  EXPECT_FALSE(passes([](wire::Request& r) { r.command().clear(); }));
  EXPECT_FALSE(passes([](wire::Request& r) { r.command().push_back(r.command()[0]); }));
  EXPECT_FALSE(passes([](wire::Request& r) { r.snapshot(true); }));
  EXPECT_FALSE(passes([](wire::Request& r) { r.leave().emplace_back().user(1); }));
  const auto leaves = [&](std::uint32_t user) {
    return passes([&](wire::Request& r) {
      r.command().clear();
      r.leave().emplace_back().user(user);
    });
  };
  EXPECT_TRUE(leaves(1));
  EXPECT_FALSE(leaves(0));
  const auto joins = [&](const std::string& name, const std::string& role) {
    return passes([&](wire::Request& r) {
      r.command().clear();
      r.join().emplace_back();
      r.join()[0].name(name);
      r.join()[0].role(role);
    });
  };
  EXPECT_TRUE(joins("anna", "designer"));
  EXPECT_FALSE(joins("", "designer"));
  EXPECT_FALSE(joins("a\nb", "designer"));
  EXPECT_FALSE(joins("J\xe4ger", "designer")) << "Latin-1";
  EXPECT_FALSE(
      joins("a\xc2\x85"
            "b",
            "designer"))
      << "next line, of C1";
  EXPECT_FALSE(joins(std::string(kMaxName_bytes + 1, 'a'), "designer"));
  EXPECT_FALSE(joins("anna", "emperor"));
  EXPECT_FALSE(joins("anna", ""));
}

TEST(Convert, AnswersGoRound) {
  const JoinReply joins[] = {{"00ff", 9, UserId{2}, Refusal::kNone, ""},
                             {"00ff", 10, UserId{}, Refusal::kSessionFull, "full"}};
  const Reply replies[] = {
      {UserId{2}, PartId{3}, 4, Refusal::kHeldByOther, UserId{5}, "held by bert"}};
  const RefusedIncrement refused[] = {{UserId{2}, PartId{3}, 6, Refusal::kNotHolder}};
  const Result<Answers> got = from_wire(to_wire(joins, replies, refused));
  ASSERT_TRUE(got) << got.error().text;
  ASSERT_EQ(got->joins.size(), 2u);
  EXPECT_EQ(got->joins[1].refusal, Refusal::kSessionFull);
  EXPECT_EQ(got->joins[0].user, UserId{2});
  ASSERT_EQ(got->replies.size(), 1u);
  EXPECT_EQ(got->replies[0].text, "held by bert");
  EXPECT_EQ(got->replies[0].holder, UserId{5});
  ASSERT_EQ(got->refused.size(), 1u);
  EXPECT_EQ(got->refused[0].reason, Refusal::kNotHolder);
}

TEST(Convert, AnswersAreRefused) {
  wire::Answers answers;
  answers.replies().resize(1);
  EXPECT_TRUE(from_wire(answers));
  answers.replies()[0].refusal(kRefusalCount);
  EXPECT_FALSE(from_wire(answers));
  answers.replies()[0].refusal(0);
  answers.replies()[0].text("bell \a");
  EXPECT_FALSE(from_wire(answers));
  answers.replies().clear();
  answers.joins().resize(1);  // says yes without a user
  EXPECT_FALSE(from_wire(answers));
  answers.joins().clear();
  answers.refused().resize(1);  // a refusal without a reason
  EXPECT_FALSE(from_wire(answers));
  answers.refused().clear();
  answers.replies().resize(kMaxSequence + 1);
  EXPECT_FALSE(from_wire(answers));
}

TEST(Convert, PosesGoRoundBitwise) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 200; ++i) {
    const PartPose sent = test::some_pose(random);
    wire::PoseBatch batch;
    batch.tick(5);
    batch.event_seq(6);
    batch.parts().push_back(to_wire(sent));
    batch.acks().push_back(to_wire(Ack{UserId{1}, 2, 3}));
    const Result<PoseBatch> got = from_wire(batch);
    ASSERT_TRUE(got) << got.error().text;
    EXPECT_TRUE(identical(got->parts[0].X_WP, sent.X_WP));
    EXPECT_EQ(got->parts[0].holder, sent.holder);
    EXPECT_EQ(got->tick, 5u);
    EXPECT_EQ(got->event_seq, 6u);
    EXPECT_EQ(got->acks[0].sent_ns, 3);
  }
}

TEST(Convert, PosesAreRefused) {
  std::mt19937_64 random(8);
  const auto passes = [&](auto change) {
    wire::PoseBatch batch;
    batch.parts().push_back(to_wire(test::some_pose(random)));
    change(batch.parts()[0]);
    return static_cast<bool>(from_wire(batch));
  };
  EXPECT_TRUE(passes([](wire::PartPose&) {}));
  EXPECT_TRUE(passes([](wire::PartPose& p) { p.pose().q({0, 0, 0, 1.0 + 0.9e-6}); }));
  EXPECT_FALSE(passes([](wire::PartPose& p) { p.pose().q({0, 0, 0, 1.0 + 1.1e-6}); }));
  EXPECT_FALSE(passes([](wire::PartPose& p) { p.pose().q({0, 0, 0, 0}); }));
  EXPECT_FALSE(passes([](wire::PartPose& p) { p.pose().q({kNan, 0, 0, 1}); }));
  EXPECT_FALSE(passes([](wire::PartPose& p) { p.pose().q({kInf, 0, 0, 1}); }));
  EXPECT_FALSE(passes([](wire::PartPose& p) { p.pose().p_mm({0, kNan, 0}); }));
  EXPECT_FALSE(passes([](wire::PartPose& p) { p.pose().p_mm({0, 0, -1.1e9}); }));
  EXPECT_FALSE(passes([](wire::PartPose& p) { p.part(0); }));
}

TEST(Convert, EventsGoRound) {
  const ClashEvent sent = test::some_clash();
  const Result<ClashEvent> got = from_wire(to_wire(sent));
  ASSERT_TRUE(got) << got.error().text;
  test::expect_same(*got, sent);
}

wire::Interval interval(double lo, double hi) {
  wire::Interval made;
  made.lo(lo);
  made.hi(hi);
  return made;
}

TEST(Convert, EventsAreRefused) {
  const auto passes = [](auto change) {
    wire::ClashEvent event = to_wire(test::some_clash());
    change(event);
    return static_cast<bool>(from_wire(event));
  };
  using E = wire::ClashEvent;
  EXPECT_TRUE(passes([](E&) {}));
  EXPECT_FALSE(passes([](E& e) { e.kind(0); }));
  EXPECT_FALSE(passes([](E& e) { e.kind(5); }));
  EXPECT_FALSE(passes([](E& e) { e.seq(0); }));
  EXPECT_FALSE(passes([](E& e) { e.clash(0); }));
  EXPECT_FALSE(passes([](E& e) { e.part_a(0); }));
  EXPECT_FALSE(passes([](E& e) { e.part_b(e.part_a()); }));
  EXPECT_FALSE(passes([](E& e) { e.t_contact(kNan); }));
  EXPECT_FALSE(passes([](E& e) { e.t_contact(1.5); }));
  EXPECT_FALSE(passes([](E& e) { e.t_potential(kNan); }));
  EXPECT_FALSE(passes([](E& e) { e.t_potential(-0.1); }));
  EXPECT_FALSE(passes([](E& e) { e.t_real(-kInf); }));
  EXPECT_FALSE(passes([](E& e) { e.t_real(1.5); }));
  EXPECT_TRUE(passes([](E& e) { e.t_real(kInf); }));
  EXPECT_FALSE(passes([](E& e) { e.begin_tick(e.tick() + 1); }));
  EXPECT_FALSE(passes([](E& e) { e.worst_class(4); }));
  EXPECT_FALSE(passes([](E& e) { e.worst_delta_mm().lo(kNan); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().collision_class(4); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().delta_mm(interval(2, 1)); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().gpd_mm(interval(kNan, 0)); }));
  EXPECT_TRUE(passes([](E& e) { e.verdict().delta_mm(interval(-kInf, kInf)); }));
  EXPECT_FALSE(passes([](E& e) { e.cause(kDecisionKindCount); }));
  EXPECT_FALSE(passes([](E& e) { e.review().status(kReviewStatusCount); }));
  EXPECT_FALSE(passes([](E& e) { e.review().comment("a\nb"); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().probability(-0.1); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().probability(1.1); }));
  EXPECT_TRUE(passes([](E& e) { e.verdict().probability(-1.0); }));  // not known
  EXPECT_FALSE(passes([](E& e) { e.verdict().probability(kNan); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().fake_below_mm(kNan); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().point_mm({kInf, 0, 0}); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().normal({0, kNan, 0}); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().area_mm2(-1); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().separation_way(6); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().shape_b(6); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().grade(7); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().face_a(std::string(129, 'x')); }));
  EXPECT_FALSE(passes([](E& e) { e.verdict().explanation(std::string(1025, 'x')); }));
}

TEST(Convert, PulseGoesRoundAndIsRefused) {
  SessionPulse sent;
  sent.tick = 4;
  sent.clashes_open[3] = 2;
  sent.clashes_total[1] = 9;
  sent.tick_p99_us = 12.5;
  sent.users = 3;
  sent.draining = true;
  sent.unexamined = {{PartId{2}, PartId{7}, Unexamined::kWaitsForDepth, 5}};
  sent.unexamined_left_out = 3;
  const Result<SessionPulse> got = from_wire(to_wire(sent, 11));
  ASSERT_TRUE(got);
  EXPECT_EQ(got->clashes_open[3], 2u);
  EXPECT_EQ(got->clashes_total[1], 9u);
  EXPECT_EQ(got->tick_p99_us, 12.5);
  EXPECT_EQ(got->users, 3u);
  EXPECT_TRUE(got->draining);
  EXPECT_EQ(got->unexamined, sent.unexamined);
  EXPECT_EQ(got->unexamined_left_out, 3u);
  wire::Pulse bad = to_wire(sent, 11);
  for (const std::uint32_t a : {0u, 7u}) {
    wire::Pulse of_no_pair = bad;
    of_no_pair.unexamined()[0].part_a(a);
    EXPECT_FALSE(from_wire(of_no_pair)) << a;
  }
  wire::Pulse of_no_reason = bad;
  of_no_reason.unexamined()[0].why(kUnexaminedCount);
  EXPECT_FALSE(from_wire(of_no_reason));
  EXPECT_EQ(bad.pose_serial(), 11u);
  bad.tick_max_us(-1.0);
  EXPECT_FALSE(from_wire(bad));
  bad.tick_max_us(kNan);
  EXPECT_FALSE(from_wire(bad));
}

TEST(Convert, TextsAreClippedAtWholeCharacters) {
  EXPECT_EQ(clip("abc", 8), "abc");
  EXPECT_EQ(clip("a\tb", 8), "a?b");
  EXPECT_EQ(clip("\xe4", 8), "\xef\xbf\xbd");
  EXPECT_EQ(clip("\xe4", 2), "");
  EXPECT_EQ(clip("ab\xc3\xa4", 3), "ab");  // half of an umlaut is none
  EXPECT_EQ(clip("ab\xc3\xa4", 4), "ab\xc3\xa4");
  Verdict verdict;
  verdict.explanation = std::string(5000, 'x');
  EXPECT_TRUE(from_wire(to_wire(verdict)));  // what we send passes our own door
}

// Random values, mostly nasty ones: whatever passes keeps what the door promises, and goes round.
TEST(Convert, RandomValuesPassOnlyInRange) {
  std::mt19937_64 random(20240501);
  const auto number = [&]() -> double {
    constexpr double kNasty[] = {0.0, -0.0, 1.0, -1.0, 1e-320, 1e300, -1e300, 1e9, 3.2, 0.5};
    switch (random() % 12) {
      case 0:
        return kNan;
      case 1:
        return random() % 2 == 0 ? kInf : -kInf;
      case 2:
      case 3:
        return kNasty[random() % std::size(kNasty)];
      default:
        return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0;
    }
  };
  std::size_t passed = 0, refused = 0;
  for (int i = 0; i < 200'000; ++i) {
    wire::IncrementBatch batch;
    batch.user(static_cast<std::uint32_t>(random() % 3));
    wire::Increment increment;
    increment.part(static_cast<std::uint32_t>(random() % 3));
    increment.seq(random() % 3);
    increment.translation_mm({number(), number(), number()});
    increment.rotation_rad({number(), number(), number()});
    batch.increments({increment});
    const auto got = from_wire(batch);
    if (!got || got->front().at_door != Refusal::kNone) {
      ++refused;
      continue;
    }
    ++passed;
    const Increment& passed_on = got->front().increment;
    ASSERT_TRUE(passed_on.user && passed_on.part && passed_on.seq > 0);
    ASSERT_LE(passed_on.rotation_rad.norm(), kMaxRotationPerTick_rad);
    ASSERT_LE(passed_on.translation_mm.norm(), kMaxCoordinate_mm);
    ASSERT_EQ(passed_on.translation_mm[2], increment.translation_mm()[2]);
  }
  EXPECT_GT(passed, 1000u);
  EXPECT_GT(refused, 1000u);
}

// Mutated bytes of real samples through the reader and the door: nothing leaves but a refusal.
TEST(Convert, MutatedSamplesNeverThrow) {
  std::mt19937_64 random(99);
  const test::Fuzzed events = test::fuzz<wire::EventBatchPubSubType>(
      test::some_event_batch(), 30'000, random, [](const wire::EventBatch& batch) {
        std::uint64_t malformed = 0;
        events_from_wire(batch, malformed);
        return malformed == 0;
      });
  const test::Fuzzed requests = test::fuzz<wire::RequestPubSubType>(
      to_wire(test::some_join()), 30'000, random,
      [](const wire::Request& request) { return static_cast<bool>(from_wire(request)); });
  const test::Fuzzed snapshots = test::fuzz<wire::SnapshotPubSubType>(
      test::some_snapshot_chunk(), 30'000, random,
      [](const wire::Snapshot& chunk) { return static_cast<bool>(from_wire(chunk)); });
  Request command;
  command.kind = Request::Kind::kCommand;
  command.command = {UserId{3}, PartId{4}, 5, CommandKind::kReview, test::some_details()};
  const test::Fuzzed commands = test::fuzz<wire::RequestPubSubType>(
      to_wire(command), 30'000, random,
      [](const wire::Request& request) { return static_cast<bool>(from_wire(request)); });
  Decision decision{Decision::Kind::kReview, UserId{2}, PartId{3}, "anna", Role::kBot};
  decision.details = test::some_details();
  const Decision decisions[] = {decision, decision};
  const test::Fuzzed answers = test::fuzz<wire::AnswersPubSubType>(
      to_wire({}, {}, {}, decisions), 30'000, random,
      [](const wire::Answers& answer) { return static_cast<bool>(from_wire(answer)); });
  for (const test::Fuzzed& result : {events, requests, snapshots, commands, answers}) {
    EXPECT_GT(result.unreadable, 100u);  // refused by SafeType, and counted there
    EXPECT_EQ(result.unreadable, result.counted);
    EXPECT_GT(result.refused, 100u);
    EXPECT_GT(result.passed, 100u);
  }
}

}  // namespace
}  // namespace mortise
