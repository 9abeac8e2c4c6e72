// Of two servers one has its certificate revoked while the other works with it.
#include "tests/network/security_fixture.h"

namespace mortise::test {
namespace {

class SecurityStandby : public ::testing::Test {
 protected:
  void SetUp() override {
    keys_.issue("hall", "server");
    keys_.issue("spare", "server");
    keys_.issue("anna", "designer");
    hall_ = keys_.copy_of("hall", "kept_by_hall");
    spare_ = keys_.copy_of("spare", "kept_by_spare");
    annas_ = keys_.copy_of("anna", "kept_by_anna");
    ASSERT_EQ(keys_.trouble(), "");
    std::filesystem::create_directories(logs());
  }
  void begin() {
    const auto start = [&](std::vector<std::string> words, const std::string& keys) {
      words.insert(words.end(),
                   {"--log", logs(), "--domain", std::to_string(own_domain()), "--keys", keys});
      return std::make_unique<Program>(folder_.path(), "mortise-server", words);
    };
    first_ = start({folder_.write("blocks.yaml", blocks_yaml(kBlocks))}, hall_);
    second_ = start({"--standby-of", "default", "--restore", logs()}, spare_);
    ASSERT_TRUE(says(*second_, "in step")) << second_->errors();
    DdsOptions options;
    options.domain = own_domain();
    options.keys = annas_;
    anna_.enter(options, "anna");
    ASSERT_TRUE(is_served());
  }
  void sleep_and_turn(double seconds) {
    (void)until(
        seconds, [] { return false; }, [&] { turn(); });
  }
  void turn() {
    anna_.listen();
    sleep_s(0.004);
  }
  bool says(const Program& server, const std::string& words) {
    return until(
        20.0, [&] { return server.errors().find(words) != std::string::npos; }, [&] { turn(); });
  }
  /// The new list reaches only some.
  void revoke(const std::string& name, const std::vector<std::string>& told) {
    keys_.revoke(name);
    ASSERT_EQ(keys_.trouble(), "");
    for (const std::string& kept : told) tell(kept);
  }
  void tell(const std::string& kept) const {
    std::filesystem::copy_file(keys_["anna"] + "/crl.pem", kept + "/crl.pem",
                               std::filesystem::copy_options::overwrite_existing);
  }
  bool is_served() {
    return until(
        kPatience_s, [&] { return anna_.is_in(); }, [&] { turn(); });
  }
  bool loses_its_server() {
    return until(
        kPatience_s, [&] { return !anna_.is_in(); }, [&] { turn(); });
  }
  std::string logs() const { return folder_.path().string() + "/logs"; }

  TestFolder folder_;
  KeyRing keys_{"site"};
  std::string hall_, spare_, annas_;
  std::unique_ptr<Program> first_, second_;
  Person anna_;
};

/// What it says to have is no reason to tell clients of it. It does not know, and leads as the
/// first is gone; nobody who knows is led by it.
TEST_F(SecurityStandby, OneThatIsRevokedIsNotCountedOnNorFollowed) {
  begin();
  ASSERT_FALSE(HasFailure());
  revoke("spare", {hall_, annas_});
  EXPECT_TRUE(says(*first_, "'spare' (server) was not let in: it has been revoked"))
      << first_->errors();
  EXPECT_TRUE(says(*first_, "it is not waited for any more")) << first_->errors();
  EXPECT_TRUE(anna_.is_in());
  first_->signal(SIGKILL);
  EXPECT_TRUE(says(*second_, "is gone: taken over at tick")) << second_->errors();
  EXPECT_TRUE(loses_its_server());
  sleep_and_turn(kRefused_s);
  EXPECT_FALSE(anna_.is_in()) << "led by one that is revoked";
  tell(spare_);
  EXPECT_EQ(second_->wait(kPatience_s), 1) << second_->errors();
}

/// One that learns of it ends, and does not take over.
TEST_F(SecurityStandby, OneThatIsRevokedEnds) {
  begin();
  ASSERT_FALSE(HasFailure());
  revoke("spare", {spare_});
  EXPECT_EQ(second_->wait(kPatience_s), 1);
  EXPECT_NE(second_->errors().find("the certificate of 'spare' (server) has been revoked: this "
                                   "server ends"),
            std::string::npos)
      << second_->errors();
  sleep_and_turn(1.0);
  EXPECT_TRUE(anna_.is_in());
  EXPECT_EQ(second_->errors().find("taken over"), std::string::npos) << second_->errors();
}

/// It looks at the list while it follows: what a leader says that is revoked is not taken, and who
/// works with that one does not any more.
TEST_F(SecurityStandby, OneWhoseLeaderIsRevokedFollowsItNoMore) {
  begin();
  ASSERT_FALSE(HasFailure());
  revoke("hall", {spare_, annas_});
  EXPECT_TRUE(loses_its_server());
  EXPECT_TRUE(says(*first_, "going on without them")) << first_->errors();
  EXPECT_TRUE(second_->running());
  EXPECT_EQ(second_->errors().find("taken over"), std::string::npos) << second_->errors();
  first_->signal(SIGKILL);
  EXPECT_TRUE(says(*second_, "is gone: taken over at tick")) << second_->errors();
  EXPECT_TRUE(is_served());
}

/// One that leads and learns of it leaves the session to the one that stands by. That one had the
/// list first, and has been with it to the end: nothing was told that is not with both.
TEST_F(SecurityStandby, OneThatLeadsAndIsRevokedEndsAndTheOtherGoesOn) {
  begin();
  ASSERT_FALSE(HasFailure());
  revoke("hall", {spare_});
  sleep_and_turn(2.5);
  tell(hall_);
  EXPECT_EQ(first_->wait(kPatience_s), 1);
  EXPECT_EQ(first_->errors().find("it is not waited for"), std::string::npos) << first_->errors();
  EXPECT_NE(first_->errors().find("the certificate of 'hall' (server) has been revoked"),
            std::string::npos)
      << first_->errors();
  EXPECT_TRUE(says(*second_, "is gone: taken over at tick")) << second_->errors();
  EXPECT_TRUE(is_served());
}

}  // namespace
}  // namespace mortise::test
