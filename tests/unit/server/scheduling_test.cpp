#include "server/scheduling.h"

#include <gtest/gtest.h>
#include <pthread.h>

#include <thread>

namespace mortise {
namespace {

int own_policy() {
  sched_param priority{};
  int policy = -1;
  pthread_getschedparam(pthread_self(), &policy, &priority);
  return policy;
}

int policy_of_a_new_thread() {
  int policy = -1;
  std::thread([&] { policy = own_policy(); }).join();
  return policy;
}

// In a thread of its own: the priority ends with it.
TEST(Scheduling, IsInheritedAndGivenBack) {
  std::thread([] {
    const Status first = run_before_others();
    if (!first) {
      EXPECT_EQ(own_policy(), SCHED_OTHER);
      EXPECT_NE(first.error().text.find("LimitRTPRIO"), std::string::npos) << first.error().text;
      GTEST_SKIP() << "not root: " << first.error().text;
    }
    EXPECT_EQ(own_policy(), SCHED_RR);
    EXPECT_EQ(policy_of_a_new_thread(), SCHED_RR);
    run_as_others();
    EXPECT_EQ(own_policy(), SCHED_OTHER);
    EXPECT_EQ(policy_of_a_new_thread(), SCHED_OTHER);
  }).join();
}

}  // namespace
}  // namespace mortise
