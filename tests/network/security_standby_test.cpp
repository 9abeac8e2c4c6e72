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
    ASSERT_EQ(keys_.trouble(), "");
    std::filesystem::create_directories(logs());
  }
  void begin(int domain) {
    const auto start = [&](std::vector<std::string> words, const std::string& keys) {
      words.insert(words.end(),
                   {"--log", logs(), "--domain", std::to_string(domain), "--keys", keys});
      return std::make_unique<Program>(folder_.path(), "mortise-server", words);
    };
    first_ = start({folder_.write("blocks.yaml", blocks_yaml(kBlocks))}, hall_);
    second_ = start({"--standby-of", "default", "--restore", logs()}, spare_);
    ASSERT_TRUE(says(*second_, "in step")) << second_->errors();
    DdsOptions options;
    options.domain = domain;
    options.keys = keys_["anna"];
    anna_.enter(options, "anna");
    ASSERT_TRUE(until(
        kPatience_s, [&] { return anna_.is_in(); }, [&] { turn(); }));
  }
  void turn() {
    anna_.listen();
    sleep_s(0.004);
  }
  bool says(const Program& server, const std::string& words) {
    return until(
        20.0, [&] { return server.errors().find(words) != std::string::npos; }, [&] { turn(); });
  }
  void revoke(const std::string& name) {
    keys_.revoke(name);
    for (const std::string& kept : {hall_, spare_})
      std::filesystem::copy_file(keys_["anna"] + "/crl.pem", kept + "/crl.pem",
                                 std::filesystem::copy_options::overwrite_existing);
  }
  std::string logs() const { return folder_.path().string() + "/logs"; }

  TestFolder folder_;
  KeyRing keys_{"site"};
  std::string hall_, spare_;
  std::unique_ptr<Program> first_, second_;
  Person anna_;
};

/// What it says to have is no reason to tell clients of it.
TEST_F(SecurityStandby, OneThatIsRevokedIsNotCountedOn) {
  begin(221);
  ASSERT_FALSE(HasFailure());
  revoke("spare");
  EXPECT_TRUE(says(*first_, "it is not waited for any more")) << first_->errors();
  EXPECT_NE(first_->errors().find("'spare' (server)"), std::string::npos) << first_->errors();
}

/// It looks at the list while it follows: what a leader says that is revoked is not taken.
TEST_F(SecurityStandby, OneWhoseLeaderIsRevokedFollowsItNoMore) {
  begin(222);
  ASSERT_FALSE(HasFailure());
  revoke("hall");
  EXPECT_TRUE(says(*first_, "it is not waited for any more")) << first_->errors();
  EXPECT_TRUE(second_->running());
  EXPECT_EQ(second_->errors().find("taken over"), std::string::npos) << second_->errors();
  first_->signal(SIGKILL);
  EXPECT_TRUE(says(*second_, "is gone: taken over at tick")) << second_->errors();
}

}  // namespace
}  // namespace mortise::test
