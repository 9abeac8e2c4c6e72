#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/io/log/log_chain.h"
#include "common/io/log/replay.h"
#include "tests/network/guest.h"
#include "tests/network/knowledge.h"

/// After a fault: do all know the same clashes and poses, and is all there that was accepted?
namespace mortise::test {

/// What all of them know, once they have heard the last of it.
inline Knowledge agreed_by(const std::vector<Guest*>& guests) {
  EXPECT_GE(guests.size(), 2u) << "one alone is always right";
  std::string off;
  guests.front()->until(kPatience_s, [&] {
    off.clear();
    for (Guest* guest : guests) guest->listen();
    const Knowledge first = knowledge_of(*guests.front()->client);
    for (std::size_t i = 1; i < guests.size() && off.empty(); ++i) {
      off = difference(first, knowledge_of(*guests[i]->client));
      if (!off.empty()) off = "participant " + std::to_string(i) + ": " + off;
    }
    return off.empty();
  });
  EXPECT_EQ(off, "") << "they know differently";
  return knowledge_of(*guests.front()->client);
}

/// The server says the same at its end.
inline void expect_told_at_end(const Knowledge& known, const nlohmann::json& closing) {
  std::set<std::uint32_t> told, open;
  for (const auto& clash : closing["statistics"]["clashes"])
    if (clash["open"].get<bool>()) told.insert(clash["clash"].get<std::uint32_t>());
  for (const auto& [id, clash] : known.open) open.insert(id.value);
  EXPECT_EQ(told, open) << "the server knows other clashes";
}

/// The log whose first file this is, computed again, ends with what all of them know, and holds all
/// that they were told to be taken.
inline void expect_in_log(const Knowledge& known, const std::filesystem::path& first_file,
                          const std::vector<Guest*>& guests) {
  const auto log = read_session(first_file);
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_TRUE(log->gaps.empty());
  auto scene = scene_of(*log);
  ASSERT_TRUE(scene) << scene.error().text;
  const auto played = replay(scene->world, *log, 1);
  ASSERT_TRUE(played) << played.error().text;
  ASSERT_FALSE(played->difference) << played->difference->what;
  EXPECT_EQ(played->not_verifiable, "");
  EXPECT_EQ(difference(knowledge_of(snapshot_of(scene->world)), known), "")
      << "the log ends otherwise";
  for (const Guest* guest : guests) {
    std::set<std::uint64_t> lost = guest->taken;
    for (const TickRecord& tick : log->ticks)
      for (const Increment& increment : tick.increments)
        if (increment.user == guest->id) lost.erase(increment.seq);
    for (const RefusedIncrement& refused : guest->refused) lost.erase(refused.seq);
    EXPECT_EQ(lost.size(), 0u) << "of " << guest->taken.size() << " of user " << guest->id.value
                               << ", the first " << (lost.empty() ? 0 : *lost.begin());
  }
}

/// Is all that this participant was told to be taken with the server that has ended, and is what
/// the server says of it in itself whole? Of one who was with no other server.
inline void expect_nothing_lost(const Guest& guest, const std::string& name,
                                const nlohmann::json& closing) {
  for (const auto& user : closing["users"]) {
    if (user["name"] != name) continue;
    const auto count = [&](const char* what) { return user[what].template get<std::uint64_t>(); };
    EXPECT_EQ(count("lost"), 0u) << name;
    EXPECT_EQ(count("accepted") + count("refused"), count("received")) << name;
    EXPECT_GE(count("received"), guest.taken.size()) << name << " was told of more";
    return;
  }
  ADD_FAILURE() << "the server does not know " << name;
}

}  // namespace mortise::test
