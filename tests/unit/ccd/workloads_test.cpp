#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "common/ccd/first_contact.h"
#include "tests/support/test_data.h"
#include "tests/unit/ccd/workload.h"

namespace mortise::testing {
namespace {

struct Score {
  int missed = 0, invented = 0, late = 0, undecided = 0, contacts = 0, at_start = 0;
  std::vector<double> error_mm;  // of the contacts, as travel of the fastest point
  double p99_mm() const {
    if (error_mm.empty()) return 0.0;
    std::vector<double> sorted = error_mm;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(0.99 * static_cast<double>(sorted.size() - 1) + 0.5)];
  }
};

constexpr double kLate_mm = 1e-5;

// `answer_late_by` plants a fault: every contact is reported that much later.
Score score(const Workload& workload, const std::vector<FirstContact>& answers,
            double answer_late_by) {
  Score s;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Workload::Row& row = workload.rows[i];
    const FirstContact& answer = answers[i];
    const bool hit = answer.state == ContactState::kContact;
    s.undecided += answer.state == ContactState::kUndecided;
    s.at_start += answer.state == ContactState::kTouchingAtStart ||
                  answer.state == ContactState::kOverlappingAtStart;
    s.missed += row.contact && answer.state == ContactState::kFree;
    s.invented += !row.contact && answer.state != ContactState::kFree;
    if (!row.contact || !hit) continue;
    ++s.contacts;
    const double late_mm = (answer.t_contact + answer_late_by - row.t_contact) * row.max_speed_mm;
    s.late += late_mm > kLate_mm;
    s.error_mm.push_back(std::abs(late_mm));
  }
  return s;
}

class Workloads : public ::testing::TestWithParam<std::string> {};

TEST_P(Workloads, NeitherMissedNorInventedNorLate) {
  Workload workload;
  MORTISE_NEEDS_DATA(test::data_folder() / "ccd-motions" / GetParam());
  ASSERT_TRUE(load_workload(GetParam(), workload));
  CcdScratch scratch;
  std::vector<FirstContact> answers;
  std::vector<double> time_us;
  for (const Workload::Row& row : workload.rows) {
    ContactQuery query;
    query.a = workload.moving.get();
    query.b = workload.fixed.get();
    query.motion_a = row.motion;
    query.motion_b = still_motion({});
    FirstContact answer = first_contact(query, scratch);
    double best_us = 1e30;
    for (int repeat = 0; repeat < 3; ++repeat) {
      const auto start = std::chrono::steady_clock::now();
      const FirstContact again = first_contact(query, scratch);
      best_us = std::min(best_us, std::chrono::duration<double, std::micro>(
                                      std::chrono::steady_clock::now() - start)
                                      .count());
      EXPECT_EQ(again.t_contact, answer.t_contact) << "motion " << row.id;
      EXPECT_EQ(again.work.box_tests, answer.work.box_tests) << "motion " << row.id;
    }
    time_us.push_back(best_us);
    answers.push_back(answer);
  }
  const Score s = score(workload, answers, 0.0);
  std::sort(time_us.begin(), time_us.end());
  std::printf(
      "| %-10s | %zu queries | %d contacts | missed %d | invented %d | late %d | p99 error %.2g mm "
      "| "
      "median %.3f ms | p99 %.3f ms |\n",
      GetParam().c_str(), answers.size(), s.contacts, s.missed, s.invented, s.late, s.p99_mm(),
      1e-3 * time_us[time_us.size() / 2],
      1e-3 * time_us[static_cast<std::size_t>(0.99 * static_cast<double>(time_us.size() - 1))]);
  EXPECT_EQ(s.missed, 0);
  EXPECT_EQ(s.invented, 0);
  EXPECT_EQ(s.late, 0);
  EXPECT_EQ(s.undecided, 0);
  EXPECT_EQ(s.at_start, 0);
  EXPECT_GT(s.contacts, 0);
  EXPECT_LE(s.p99_mm(), kLate_mm);
  // The checker itself: contacts reported a ten-thousandth of a tick late are all found out.
  EXPECT_EQ(score(workload, answers, 1e-4).late, s.contacts);
}

INSTANTIATE_TEST_SUITE_P(Measured, Workloads, ::testing::ValuesIn(workload_names()),
                         [](const auto& test) {
                           std::string name = test.param;
                           for (char& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return name;
                         });

}  // namespace
}  // namespace mortise::testing
