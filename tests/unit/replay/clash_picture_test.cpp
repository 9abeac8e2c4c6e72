// One clash of a log as a picture: that of the last judgement up to a tick.
#include "client/report/clash_picture.h"

#include <gtest/gtest.h>

#include "client/report/log_so_far.h"
#include "tests/unit/replay/played.h"

namespace mortise {
namespace {

int times(const std::string& text, const std::string& word) {
  int count = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

class ClashPicture : public testing::Test {
 protected:
  void SetUp() override {
    auto read = played("thin_wall");
    ASSERT_TRUE(read) << read.error().text;
    log_ = std::move(*read);
    for (const TickRecord& record : log_.ticks)
      for (const ClashEvent& event : record.report.events) events_.push_back(event);
    ASSERT_FALSE(events_.empty());
  }
  SessionLog log_;
  std::vector<ClashEvent> events_;
};

TEST_F(ClashPicture, SaysTheClassOfTheLastJudgement) {
  const ClashEvent& first = events_.front();
  ClashEvent later = first;
  later.kind = ClashEvent::Kind::kChange;
  later.tick = log_.ticks.back().tick;
  later.verdict.collision_class = CollisionClass::kFake;
  ClashEvent end = later;
  end.kind = ClashEvent::Kind::kEnd;
  ASSERT_GT(later.tick, first.tick);
  for (const ClashEvent& event : {later, end}) log_.ticks.back().report.events.push_back(event);
  const auto begun = clash_picture(log_, {first.clash, first.tick});
  ASSERT_TRUE(begun) << begun.error().text;
  EXPECT_EQ(begun->find("<svg"), 0u) << begun->substr(0, 40);
  const auto last = clash_picture(log_, {first.clash});
  ASSERT_TRUE(last) << last.error().text;
  // The scale of thresholds names each class once, the title that of the verdict.
  EXPECT_EQ(times(*begun, ">real<"), 2);
  EXPECT_EQ(times(*last, ">real<"), 1);
  EXPECT_EQ(times(*last, ">fake<"), times(*begun, ">fake<") + 1);
}

TEST_F(ClashPicture, HasNoneOfAClashThatIsNotThereYetOrNotAtAll) {
  const ClashEvent& first = events_.front();
  const auto before = clash_picture(log_, {first.clash, first.tick - 1});
  ASSERT_FALSE(before);
  EXPECT_EQ(before.error().code, Code::kNotFound);
  const auto none = clash_picture(log_, {ClashId{4711}});
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().text.find("no clash 4711"), std::string::npos) << none.error().text;
}

TEST_F(ClashPicture, ALogIsReadAgainOnlyForAMomentBehindWhatWasRead) {
  const ClashEvent& first = events_.front();
  int reads = 0;
  log_.complete = false;  // as while its server writes it
  LogSoFar so_far([&] {
    ++reads;
    return log_;
  });
  const auto draw = [&](const ClashMoment& moment) {
    return so_far.answer(moment.until_tick,
                         [&](const SessionLog& log) { return clash_picture(log, moment); });
  };
  const auto begun = draw({first.clash, first.tick});
  ASSERT_TRUE(begun) << begun.error().text;
  EXPECT_EQ(*draw({first.clash, first.tick}), *begun);
  EXPECT_FALSE(draw({first.clash, first.tick - 1}));
  EXPECT_EQ(reads, 1);
  EXPECT_TRUE(draw({first.clash, log_.ticks.back().tick + 1}));
  EXPECT_TRUE(draw({first.clash}));
  EXPECT_EQ(reads, 3);
  log_.complete = true;
  EXPECT_TRUE(draw({first.clash}));
  EXPECT_TRUE(draw({first.clash}));
  EXPECT_EQ(reads, 4) << "it has ended: nothing more comes";
}

}  // namespace
}  // namespace mortise
