#include "client/bot/load_report.h"

#include <gtest/gtest.h>

#include <numeric>

#include "client/bot/event_delay.h"
#include "client/bot/load_text.h"
#include "client/bot/stream_digest.h"
#include "common/messages/memory_channel.h"

namespace mortise {
namespace {

using Json = nlohmann::ordered_json;

ClashEvent event(std::uint64_t seq) {
  ClashEvent e;
  e.kind = ClashEvent::Kind::kBegin;
  e.seq = seq;
  e.clash = ClashId{static_cast<std::uint32_t>(seq)};
  e.verdict.collision_class = CollisionClass::kReal;
  return e;
}

StreamDigest digest(std::uint64_t first, std::uint64_t last, std::uint64_t changed = 0,
                    std::uint64_t left_out = 0) {
  StreamDigest digest;
  for (std::uint64_t seq = first; seq <= last; ++seq) {
    if (seq == left_out) continue;
    ClashEvent e = event(seq);
    if (seq == changed) e.verdict.collision_class = CollisionClass::kFake;
    digest.add(e);
  }
  return digest;
}

TEST(StreamDigestTest, BlocksAreTheSameForWhoeverCameWhen) {
  const StreamDigest all = digest(1, 300), late = digest(100, 300);
  EXPECT_EQ(all.blocks().size(), 4U);   // 1-64, 65-128, 129-192, 193-256
  EXPECT_EQ(late.blocks().size(), 2U);  // 129-192, 193-256
  for (const auto& [block, hash] : late.blocks()) EXPECT_EQ(all.blocks().at(block), hash);
  EXPECT_NE(all.hash(), late.hash());
  EXPECT_EQ(digest(1, 300).hash(), all.hash());
  // A block with a hole is not told.
  EXPECT_EQ(digest(1, 300, 0, 70).blocks().size(), 3U);
  EXPECT_FALSE(digest(1, 300, 0, 70).blocks().contains(1));
}

TEST(StreamDigestTest, OneOtherClassIsADifference) {
  using Blocks = std::map<std::uint64_t, std::uint64_t>;
  std::vector<Blocks> seen = {digest(1, 200).blocks(), digest(65, 300).blocks()};
  StreamComparison c = compare_streams(seen);
  EXPECT_EQ(c.blocks, 2U);
  EXPECT_EQ(c.differing, 0U);
  seen.push_back(digest(1, 200, 150).blocks());
  c = compare_streams(seen);
  EXPECT_EQ(c.blocks, 3U);
  EXPECT_EQ(c.differing, 1U);
}

TEST(EventDelayTest, FindsTheIncrementInEitherOrderOfArrival) {
  MemoryHub hub;
  auto server = hub.open_server();
  auto channel = hub.open_client();
  Client client(*channel);
  const LocalUser anna = client.add_user("anna", "bot");
  client.poll();
  for (const JoinRequest& join : server->take().joins)
    server->publish_join_reply({join.client, join.nonce, UserId{7}, Refusal::kNone, {}});
  client.poll();
  ASSERT_EQ(client.user_id(anna), UserId{7});

  EventDelay delay;
  ClientUpdate update;
  const auto at = [&](std::int64_t ms) { update.at_ns = ms * 1'000'000; };
  ClashEvent ours = event(1), other = event(2), silent = event(3);
  ours.user = silent.user = UserId{7};
  other.user = UserId{8};
  ours.tick = other.tick = 5;
  silent.tick = 6;
  at(30);
  update.events = {ours, other};
  EXPECT_TRUE(delay.add(update, client).empty()) << "its acknowledgement has not come";
  update.events.clear();
  update.acks = {{anna, 3, 5, 10'000'000}};
  at(34);
  EXPECT_EQ(delay.add(update, client), std::vector<double>{20.0}) << "until the event came";
  update.events = {ours};
  update.acks.clear();
  at(40);
  EXPECT_EQ(delay.add(update, client), std::vector<double>{30.0});
  update.events = {silent};
  delay.add(update, client);
  EXPECT_EQ(delay.unmatched(), 0U);
  update.events.clear();
  at(5000);
  delay.add(update, client);
  EXPECT_EQ(delay.unmatched(), 1U);
}

TEST(LoadReportTest, PercentilesAreNearestRank) {
  EXPECT_EQ(percentiles({})["p99"], 0.0);
  std::vector<double> values(100);
  std::iota(values.rbegin(), values.rend(), 1.0);
  const Json p = percentiles(values);
  EXPECT_EQ(p["count"], 100);
  EXPECT_EQ(p["p50"], 50.0);
  EXPECT_EQ(p["p90"], 90.0);
  EXPECT_EQ(p["p99"], 99.0);
  EXPECT_EQ(p["max"], 100.0);
}

ProcessReport report(const char* name, std::vector<double> latency_ms, std::uint64_t changed = 0) {
  ProcessReport r;
  r.latency_ms = std::move(latency_ms);
  r.event_latency_ms = {1.0};
  r.stream_blocks = digest(1, 200, changed).blocks();
  r.document = {{"names", {name}},
                {"seconds", 2.0},
                {"sent", 10},
                {"not_sent", 0},
                {"refused", {{"not the holder", 2}}},
                {"commands_sent", 4},
                {"replies", 4},
                {"commands_accepted", 3},
                {"commands_refused", 1},
                {"commands_refused_by", {{"held by another user", 1}}},
                {"unanswered_commands", 0},
                {"unacknowledged_increments", 1},
                {"lost", {{"events", 0}, {"pose_batches", 3}, {"event_gaps", 1}}},
                {"repaired", {{"resyncs", 1}, {"events_by_snapshot", 5}}},
                {"insertions", {{"tries", 5}, {"inserted", 4}, {"not_aligned", 0}, {"stuck", 1}}},
                {"latency_ms", percentiles(r.latency_ms)},
                {"events", {{"count", 200}}},
                {"worst_classes", {{"bore, peg", changed == 0 ? "potential" : "real"}}},
                {"server", {{"not_examined", 7}, {"missed_deadlines", 1}}},
                {"state", {{"pose_hash", "a"}, {"clash_hash", "b"}}}};
  return r;
}

TEST(LoadReportTest, ReportsOfProcessesAreAddedUp) {
  std::vector<ProcessReport> reports;
  for (const ProcessReport& sent : {report("a", {1, 2, 3}), report("b", {10, 20})}) {
    ASSERT_TRUE(from_bytes(to_bytes(sent), reports.emplace_back()));
  }
  EXPECT_EQ(reports[1].latency_ms, (std::vector<double>{10, 20}));
  EXPECT_EQ(reports[1].stream_blocks, digest(1, 200).blocks());
  const Json all = merged(reports);
  EXPECT_EQ(all["users"], 2);
  EXPECT_EQ(all["sent"], 20);
  EXPECT_EQ(all["refused"]["not the holder"], 4);
  EXPECT_EQ(all["commands_refused_by"]["held by another user"], 2);
  EXPECT_EQ(all["lost"]["pose_batches"], 6);
  EXPECT_NE(load_text(all).find("2 users in 2 processes"), std::string::npos);
  EXPECT_NE(load_text(all).find("8 of 10"), std::string::npos) << load_text(all);
  EXPECT_EQ(all["repaired"]["resyncs"], 2);
  EXPECT_EQ(all["latency_ms"]["count"], 5);
  EXPECT_EQ(all["latency_ms"]["max"], 20.0);
  EXPECT_EQ(all["streams"]["blocks_compared"], 3);
  EXPECT_EQ(all["streams"]["differing_blocks"], 0);
  reports.push_back(report("c", {}, 130));
  EXPECT_EQ(merged(reports)["streams"]["differing_blocks"], 1);
  ProcessReport none;
  EXPECT_FALSE(from_bytes({}, none));
  EXPECT_FALSE(from_bytes({1, 2, 3}, none));
}

/// A behaviour that has tried so often.
struct Tried : Behaviour {
  explicit Tried(Insertions counted) : done(std::move(counted)) {}
  Wish beat(const View&) override { return {}; }
  const Insertions* insertions() const override { return &done; }
  Insertions done;
};
struct Idle : Behaviour {
  Wish beat(const View&) override { return {}; }
};

TEST(LoadReportTest, InsertionsOfAllUsersAreAddedUp) {
  std::vector<std::unique_ptr<Behaviour>> behaviours;
  behaviours.push_back(std::make_unique<Idle>());
  EXPECT_TRUE(insertions_json(behaviours).is_null());
  behaviours.push_back(std::make_unique<Tried>(Insertions{3, 2, 1, 0, {0.5, 0.7}}));
  behaviours.push_back(std::make_unique<Tried>(Insertions{4, 3, 0, 1, {0.1, 0.2, 0.9}}));
  const Json all = insertions_json(behaviours);
  EXPECT_EQ(all["tries"], 7);
  EXPECT_EQ(all["inserted"], 5);
  EXPECT_EQ(all["not_aligned"], 1);
  EXPECT_EQ(all["stuck"], 1);
  EXPECT_EQ(all["seconds"]["p50"], 0.5);
}

TEST(LoadReportTest, EveryLimitReadsItsFigure) {
  const Json document = merged({report("a", {1, 2, 30}), report("b", {10, 20}, 130)});
  const std::map<std::string, double> expected = {
      {"p50_ms", 10.0},       {"p90_ms", 30.0},         {"p99_ms", 30.0},      {"max_ms", 30.0},
      {"event_p50_ms", 1},    {"event_p99_ms", 1},      {"event_max_ms", 1},   {"refused", 4},
      {"lost_events", 0},     {"unanswered", 0},        {"unacknowledged", 2}, {"resyncs", 2},
      {"missed_poses", 6},    {"differing_streams", 1}, {"not_inserted", 2},   {"not_examined", 7},
      {"missed_deadlines", 1}};
  ASSERT_EQ(expected.size(), limit_names().size());
  for (const auto& [name, meaning] : limit_names()) {
    const double figure = expected.at(name);
    const auto results = check_limits(document, {{name, figure}, {name, figure - 0.5}});
    EXPECT_EQ(results[0].figure, figure) << name;
    EXPECT_TRUE(results[0].holds) << name;
    EXPECT_FALSE(results[1].holds) << name;
    EXPECT_EQ(results[0].meaning, meaning);
  }
  Json untried = document;
  untried.erase("insertions");
  EXPECT_FALSE(check_limits(untried, {{"not_inserted", 0.0}})[0].holds) << "nobody tried";
  Json unheard = document;
  unheard.erase("server");
  EXPECT_FALSE(check_limits(unheard, {{"not_examined", 1000.0}})[0].holds) << "no pulse came";
  const Json nothing = merged({report("a", {})});
  EXPECT_FALSE(check_limits(nothing, {{"p99_ms", 1000.0}})[0].holds) << "nothing was measured";
}

TEST(LoadReportTest, AnExpectedClashIsTheWorstThatAnybodySaw) {
  const Json document = merged({report("a", {1.0}), report("b", {1.0}, 130)});
  const auto holds = [&](const char* a, const char* b, const char* expected) {
    return check_limits(document, {{kExpectClash, 0.0, a, b, expected}})[0].holds;
  };
  EXPECT_TRUE(holds("peg", "bore", "real"));
  EXPECT_TRUE(holds("bore", "peg", "real"));
  EXPECT_FALSE(holds("bore", "peg", "potential"));
  EXPECT_TRUE(holds("peg", "lid", "none"));
  EXPECT_FALSE(holds("peg", "lid", "fake"));
}

TEST(LoadReportTest, JUnitNamesWhatFailed) {
  const Json document = merged({report("a", {1, 2, 30})});
  const std::string xml =
      junit(check_limits(document, {{"p99_ms", 22.0}, {"lost_events", 0.0}}), 2.0);
  EXPECT_NE(xml.find("tests=\"2\" failures=\"1\""), std::string::npos) << xml;
  EXPECT_NE(
      xml.find("<testcase classname=\"limit\" name=\"p99_ms\"><failure message=\"increment to "
               "pose, 99th percentile: 30 is above the limit of 22\"/><system-out>"),
      std::string::npos)
      << xml;
  EXPECT_NE(
      xml.find("name=\"lost_events\"><system-out>events that neither arrived nor were covered by a "
               "snapshot: 0, at most 0</system-out></testcase>"),
      std::string::npos)
      << xml;
}

}  // namespace
}  // namespace mortise
