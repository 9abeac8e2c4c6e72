// The keys of a site as people make them: what is given out, taken back, and who may read it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <memory>
#include <set>

#include "idl/identity.h"
#include "tests/network/program.h"

namespace mortise::test {
namespace {

namespace fs = std::filesystem;

constexpr double kPatience_s = 60.0;

struct Keys : testing::Test {
  void SetUp() override { ASSERT_EQ(run({"init"}), 0) << said; }

  std::unique_ptr<Program> start(std::vector<std::string> words) {
    words.insert(words.end(), {"--keys", ring.string()});
    fs::create_directory(folder.path() / std::to_string(++runs));
    return std::make_unique<Program>(folder.path() / std::to_string(runs), "mortise-keys", words);
  }
  int run(const std::vector<std::string>& words) {
    const auto program = start(words);
    const int code = program->wait(kPatience_s);
    said = program->errors();
    return code;
  }
  /// Empty: they are good.
  static std::string trouble_with(const fs::path& keys) {
    const auto identity = check_keys(keys);
    return identity ? "" : identity.error().text;
  }
  std::string text_of(const char* name) const {
    std::ifstream in(ring / "site" / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  TestFolder folder;
  fs::path ring = folder.path() / "keys of a hall";
  std::string said;
  int runs = 0;
};

TEST_F(Keys, IssuedAtOnceEachHasASerialOfItsOwn) {
  const std::vector<std::string> names = {"anna", "ben", "carl", "dora", "eva", "finn"};
  std::vector<std::unique_ptr<Program>> at_once;
  for (const std::string& name : names) at_once.push_back(start({"issue", name, "--role", "bot"}));
  std::set<std::string> serials;
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(at_once[i]->wait(kPatience_s), 0) << at_once[i]->errors();
    const auto identity = check_keys(ring / names[i]);
    ASSERT_TRUE(identity) << identity.error().text;
    EXPECT_EQ(identity->name, names[i]);
    EXPECT_TRUE(serials.insert(identity->serial).second) << identity->serial << " twice";
  }
}

TEST_F(Keys, TheAuthorityIsMadeOnce) {
  fs::remove_all(ring);
  std::vector<std::unique_ptr<Program>> at_once;
  for (int i = 0; i < 3; ++i) at_once.push_back(start({"init"}));
  int made = 0;
  for (const auto& one : at_once) made += one->wait(kPatience_s) == 0;
  EXPECT_EQ(made, 1);
  EXPECT_EQ(run({"issue", "anna", "--role", "designer"}), 0) << said;
  EXPECT_EQ(trouble_with(ring / "anna"), "");
}

TEST_F(Keys, ACertificateWithTheSerialOfAnotherIsRefused) {
  ASSERT_EQ(run({"issue", "anna", "--role", "designer"}), 0) << said;
  std::string serial = text_of("serial").substr(0, 16);
  serial.back() = serial.back() == '0' ? '1' : '0';
  const std::string quoted = std::string("'") + ring.string() + "'";
  const std::string commands =
      "{ cd " + quoted +
      "/anna && openssl req -new -key identity.key -subj /O=mortise/OU=designer/serialNumber=" +
      serial +
      "/CN=anna -out csr && MORTISE_SITE=../site openssl ca -batch -notext -config ../site/ca.cnf"
      " -in csr -out identity.crt; } >/dev/null 2>&1";
  ASSERT_EQ(std::system(commands.c_str()), 0);
  EXPECT_NE(trouble_with(ring / "anna").find("and says " + serial + ": it could not be taken back"),
            std::string::npos)
      << trouble_with(ring / "anna");
}

TEST_F(Keys, WhatWasHandedOverIsTakenBack) {
  const fs::path handed_over = folder.path() / "annas";
  std::vector<fs::path> all = {handed_over / "first", handed_over / "second"};
  fs::create_directory(handed_over);
  for (const fs::path& elsewhere : all) {
    ASSERT_EQ(run({"issue", "anna", "--role", "designer"}), 0) << said;
    fs::rename(ring / "anna", elsewhere);
  }
  ASSERT_EQ(run({"issue", "ann", "--role", "designer"}), 0) << said;
  EXPECT_EQ(run({"revoke", "anna"}), 0) << said;
  for (const fs::path& elsewhere : all) {
    EXPECT_EQ(trouble_with(elsewhere), "") << "the old list is beside it still";
    fs::copy_file(ring / "site/crl.pem", elsewhere / "crl.pem",
                  fs::copy_options::overwrite_existing);
    EXPECT_NE(trouble_with(elsewhere).find("has been revoked"), std::string::npos)
        << trouble_with(elsewhere);
  }
  EXPECT_EQ(trouble_with(ring / "ann"), "");
  EXPECT_EQ(run({"revoke", "nobody"}), 1);
  EXPECT_NE(said.find("nobody was issued keys as nobody"), std::string::npos) << said;
}

TEST_F(Keys, ARevocationThatFailedIsDoneAgain) {
  ASSERT_EQ(run({"issue", "anna", "--role", "designer"}), 0) << said;
  const std::string number = text_of("crlnumber"), before = text_of("crl.pem");
  std::ofstream(ring / "site/crlnumber") << "no number\n";
  EXPECT_EQ(run({"revoke", "anna"}), 1);
  EXPECT_NE(said.find("openssl ca failed"), std::string::npos) << said;
  EXPECT_TRUE(fs::exists(ring / "anna/identity.crt")) << "deleted, and no list says so";
  EXPECT_EQ(text_of("crl.pem"), before);
  std::ofstream(ring / "site/crlnumber") << number;
  fs::copy(ring / "anna", folder.path() / "kept", fs::copy_options::recursive);
  EXPECT_EQ(run({"revoke", "anna"}), 0) << said;
  EXPECT_FALSE(fs::exists(ring / "anna"));
  fs::copy_file(ring / "site/crl.pem", folder.path() / "kept/crl.pem",
                fs::copy_options::overwrite_existing);
  EXPECT_NE(trouble_with(folder.path() / "kept").find("has been revoked"), std::string::npos);
}

TEST_F(Keys, NoNameLeadsOutOfTheFolder) {
  fs::create_directory(folder.path() / "precious");
  for (const char* name : {"../precious", "a/../../precious", "/tmp/precious", "..", ".", ".hidden",
                           "-x", "a b", "a\nb", "a*", "site", "", "ä"}) {
    for (const char* command : {"issue", "revoke", "token"}) {
      EXPECT_EQ(run({command, name, "--role", "designer"}), 2) << command << " " << name;
      EXPECT_FALSE(said.empty()) << command << " " << name;
    }
  }
  EXPECT_TRUE(fs::exists(folder.path() / "precious"));
  EXPECT_TRUE(fs::exists(ring / "site/ca.key"));
  for (const auto& entry : fs::directory_iterator(ring)) EXPECT_EQ(entry.path().filename(), "site");
}

TEST_F(Keys, OnlyTheirOwnerReadsKeys) {
  ASSERT_EQ(run({"issue", "hall", "--role", "server"}), 0) << said;
  const auto mode = [&](const char* file) { return fs::status(ring / file).permissions(); };
  using fs::perms;
  const perms own = perms::owner_read | perms::owner_write;
  EXPECT_EQ(mode("site/ca.key"), own);
  EXPECT_EQ(mode("hall/identity.key"), own);
  EXPECT_EQ(mode("site"), perms::owner_all);
  EXPECT_EQ(mode("."), perms::owner_all);
  // A service without an account reads the rest of a folder that was copied for it, also a new
  // list.
  ASSERT_EQ(run({"issue", "anna", "--role", "designer"}), 0) << said;
  ASSERT_EQ(run({"revoke", "anna"}), 0) << said;
  const perms all = own | perms::group_read | perms::others_read;
  for (const char* file : {"hall/ca.crt", "hall/identity.crt", "hall/crl.pem",
                           "hall/governance.p7s", "hall/permissions.p7s"})
    EXPECT_EQ(mode(file), all) << file;
}

TEST_F(Keys, AServiceIsHandedItsKey) {
  ASSERT_EQ(run({"issue", "hall", "--role", "server"}), 0) << said;
  const fs::path credentials = folder.path() / "credentials", copy = folder.path() / "hall.keys";
  fs::create_directory(credentials);
  fs::copy(ring / "hall", copy);
  fs::rename(copy / "identity.key", credentials / "identity.key");
  EXPECT_NE(trouble_with(copy), "");
  setenv("CREDENTIALS_DIRECTORY", credentials.c_str(), 1);
  EXPECT_EQ(trouble_with(copy), "");
  std::ofstream(credentials / "identity.key") << "none";  // of a unit that was given none
  EXPECT_EQ(trouble_with(ring / "hall"), "");
  unsetenv("CREDENTIALS_DIRECTORY");
}

TEST_F(Keys, ASiteMayBeMoved) {
  ASSERT_EQ(run({"issue", "anna", "--role", "designer"}), 0) << said;
  const fs::path before = ring;
  ring = folder.path() / "elsewhere";
  fs::rename(before, ring);
  EXPECT_EQ(run({"issue", "ben", "--role", "designer"}), 0) << said;
  EXPECT_EQ(trouble_with(ring / "ben"), "");
  EXPECT_EQ(run({"revoke", "anna"}), 0) << said;
}

}  // namespace
}  // namespace mortise::test
