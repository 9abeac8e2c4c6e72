#include "client/bot/waiting_lines.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

constexpr double kRate_hz = 60.0;

std::map<PartId, KnownPart> parts() {
  std::map<PartId, KnownPart> parts;
  parts[PartId{1}].info.name = "wall";
  parts[PartId{2}].info.name = "peg";
  return parts;
}

SessionPulse pulse(std::uint32_t ticks, Unexamined why = Unexamined::kWaitsForDepth) {
  SessionPulse pulse;
  if (ticks > 0) {
    UnexaminedRow row;
    row.a = PartId{1};
    row.b = PartId{2};
    row.why = why;
    row.ticks = ticks;
    pulse.unexamined.push_back(row);
  }
  return pulse;
}

TEST(WaitingLines, TellsOnceAndInWordsAfterMoreThanHalfASecond) {
  WaitingLines waiting(false);
  EXPECT_TRUE(waiting.after_pulse(pulse(30), parts(), kRate_hz).empty());  // 0.5 s, not more
  EXPECT_EQ(waiting.after_pulse(pulse(1), parts(), kRate_hz),
            std::vector<std::string>{"wall × peg waits for its turn, until its depth is worked "
                                     "out; it is not reported as clear before it is judged"});
  for (int i = 0; i < 10; ++i)
    EXPECT_TRUE(waiting.after_pulse(pulse(60), parts(), kRate_hz).empty());
}

TEST(WaitingLines, TellsOfTheNextWaitAndItsReason) {
  WaitingLines waiting(false);
  EXPECT_EQ(waiting.after_pulse(pulse(60), parts(), kRate_hz).size(), 1U);
  EXPECT_TRUE(waiting.after_pulse(pulse(0), parts(), kRate_hz).empty());
  EXPECT_TRUE(waiting.after_pulse(pulse(20), parts(), kRate_hz).empty());
  const auto lines = waiting.after_pulse(pulse(20, Unexamined::kGivenUp), parts(), kRate_hz);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].starts_with("wall × peg was given up at the most work")) << lines[0];
}

TEST(WaitingLines, IsSilentWhenQuiet) {
  WaitingLines waiting(true);
  EXPECT_TRUE(waiting.after_pulse(pulse(60), parts(), kRate_hz).empty());
}

}  // namespace
}  // namespace mortise
