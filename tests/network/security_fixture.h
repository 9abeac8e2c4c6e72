#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "idl/identity.h"
#include "tests/network/domain.h"
#include "tests/network/key_ring.h"
#include "tests/network/site.h"
#include "tests/network/small_server.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {

inline constexpr double kRefused_s = 3.0;  // for what must not happen: ten times what a join takes
inline const Blocks kBlocks{"lease_s: 5\n", "[0, 0, 60]", "[500, 0, 20]"};

/// A session with keys, turned by the test; what the server says of who is not let in.
class Security : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    site_keys = std::make_unique<KeyRing>("keys");
    site_keys->issue("hall", "server");
    site_keys->issue("anna", "designer");
    site_keys->issue("otto", "observer");
    ASSERT_EQ(site_keys->trouble(), "");
  }
  static void TearDownTestSuite() {
    EXPECT_EQ(site_keys->trouble(), "");
    site_keys.reset();
  }

  DdsOptions options(const std::string& keys) const {
    DdsOptions o = own_options();
    o.keys = keys;
    return o;
  }
  void open_site() {
    site = std::make_unique<Site>(options((*site_keys)["hall"]), blocks_yaml(kBlocks));
  }
  void turn(Person& person) {
    if (site) {
      site->loop->tick();
      for (const std::string& text : site->loop->last_intake().turned_away) said.push_back(text);
    }
    person.listen();
    sleep_s(0.004);
  }
  bool until_in(Person& person, double limit_s) {
    return until(
        limit_s, [&] { return person.is_in(); }, [&] { turn(person); });
  }
  bool was_said(const std::string& words) const {
    return std::any_of(said.begin(), said.end(),
                       [&](const std::string& s) { return s.find(words) != std::string::npos; });
  }
  /// What is said when keys are looked at before they are used.
  static std::string trouble_with(const std::string& folder) {
    const auto identity = check_keys(folder);
    return identity ? "" : identity.error().text;
  }
  static double x_of(const Person& person, const char* part) {
    return person.client->parts().at(person.client->find_part(part)).info.X_WP.p.x();
  }
  /// Joins, grabs red and moves it by 1 mm.
  void works(Person& person) {
    ASSERT_TRUE(until_in(person, kPatience_s));
    const PartId red = person.client->find_part("red");
    const std::uint64_t seq = person.client->grab(0, red);
    ASSERT_TRUE(until(
        kPatience_s, [&] { return person.answer(seq) != nullptr; }, [&] { turn(person); }));
    ASSERT_EQ(person.answer(seq)->refusal, Refusal::kNone) << person.answer(seq)->text;
    const double before = x_of(person, "red");
    person.client->send(0, red, {1, 0, 0});
    EXPECT_TRUE(until(
        kPatience_s, [&] { return x_of(person, "red") == before + 1.0; }, [&] { turn(person); }));
  }

  inline static std::unique_ptr<KeyRing> site_keys;
  std::unique_ptr<Site> site;
  std::vector<std::string> said;
};
}  // namespace mortise::test
