// Who is not heard for its lease is in doubt for a moment: where this process stood still, its
// datagrams wait to be read.
#include "idl/doorman.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

rtps::GUID_t some_writer(rtps::octet number) {
  rtps::GUID_t guid;
  guid.guidPrefix.value[0] = number;
  guid.entityId.value[3] = 2;
  return guid;
}

dds::LivelinessChangedStatus liveliness(const rtps::GUID_t& writer, int alive, int not_alive) {
  dds::LivelinessChangedStatus status;
  status.alive_count_change = alive;
  status.not_alive_count_change = not_alive;
  status.last_publication_handle = writer;
  return status;
}

TEST(Doorman, WhoIsHeardAgainAtOnceHasNotGone) {
  Doorman doorman;
  const rtps::GUID_t ann = some_writer(1), ben = some_writer(2);
  doorman.on_liveliness_changed(nullptr, liveliness(ann, -1, 1));
  doorman.on_liveliness_changed(nullptr, liveliness(ben, -1, 1));
  for (int i = 1; i < Doorman::kTakesInDoubt; ++i) EXPECT_TRUE(doorman.take().empty());
  doorman.on_liveliness_changed(nullptr, liveliness(ann, 1, -1));
  EXPECT_TRUE(doorman.take().empty());
  EXPECT_EQ(doorman.take(), std::vector{client_key(ben)});
  EXPECT_TRUE(doorman.take().empty());
}

// A writer that is taken away is no longer alive, and was not lost.
TEST(Doorman, WhoTakesItsWriterAwayHasGoneAtOnce) {
  Doorman doorman;
  const rtps::GUID_t ann = some_writer(1);
  doorman.on_liveliness_changed(nullptr, liveliness(ann, -1, 0));
  EXPECT_EQ(doorman.take(), std::vector{client_key(ann)});
}

}  // namespace
}  // namespace mortise
