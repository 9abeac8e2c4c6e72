// The list of what is linked, held against what the loader and dpkg say on their own.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

namespace mortise::test {
namespace {

using Json = nlohmann::json;

std::string said_by(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string said;
  std::array<char, 4096> part{};
  while (pipe && std::fgets(part.data(), static_cast<int>(part.size()), pipe.get()))
    said += part.data();
  return said;
}

std::set<std::string> libraries_of(const std::string& program) {
  const std::string loader = said_by("ldd " MORTISE_BIN_DIR "/" + program);
  const std::regex line("(\\S+) => /");
  std::set<std::string> names;
  for (std::sregex_iterator at(loader.begin(), loader.end(), line), end; at != end; ++at)
    names.insert((*at)[1]);
  return names;
}

/// File names that the packages ship which the list says are linked.
std::set<std::string> shipped_by(const Json& sbom) {
  std::set<std::string> linked, files;
  for (const Json& relation : sbom["relationships"])
    if (relation["relationshipType"] == "DYNAMIC_LINK")
      linked.insert(relation["relatedSpdxElement"].get<std::string>());
  for (const Json& package : sbom["packages"]) {
    if (!linked.contains(package["SPDXID"].get<std::string>())) continue;
    const std::string list = said_by("dpkg-query -L " + package["name"].get<std::string>());
    const std::regex name("/([^/\n]+)(\n|$)");
    for (std::sregex_iterator at(list.begin(), list.end(), name), end; at != end; ++at)
      files.insert((*at)[1]);
  }
  return files;
}

std::set<std::string> not_listed(const Json& sbom) {
  const std::set<std::string> shipped = shipped_by(sbom);
  std::set<std::string> missing;
  for (const char* program : {"mortise-server", "mortise-web"})
    for (const std::string& library : libraries_of(program))
      if (!shipped.contains(library)) missing.insert(library);
  return missing;
}

struct Sbom : testing::Test {
  Json sbom;
  void SetUp() override {
    if (said_by("dpkg-query --version 2>/dev/null").empty()) GTEST_SKIP() << "program absent: dpkg";
    std::ifstream in(MORTISE_SBOM);
    sbom = Json::parse(in, nullptr, false);
    ASSERT_TRUE(sbom.is_object()) << MORTISE_SBOM;
  }
};

TEST_F(Sbom, NamesEveryLibraryThatTheLoaderTakes) {
  EXPECT_GT(libraries_of("mortise-web").size(), 10u);
  EXPECT_EQ(not_listed(sbom), std::set<std::string>{});
  Json planted = sbom;
  std::erase_if(planted["packages"].get_ref<Json::array_t&>(),
                [](const Json& package) { return package["name"] == "libfastrtps2.9"; });
  EXPECT_EQ(not_listed(planted), std::set<std::string>{"libfastrtps.so.2.9"});
}

TEST_F(Sbom, VersionsAreThoseInstalled) {
  std::set<std::string> names;
  for (const Json& package : sbom["packages"]) {
    const std::string name = package["name"],
                      locator = package["externalRefs"][0]["referenceLocator"];
    names.insert(name);
    if (!locator.starts_with("pkg:deb/")) continue;
    const std::string installed =
        said_by("dpkg-query -W -f '${Version}\n' " + name + " | head -n 1");
    EXPECT_EQ(package["versionInfo"].get<std::string>() + "\n", installed) << name;
  }
  // Header-only libraries are in no binary's list of libraries.
  for (const char* name :
       {"libboost1.74-dev", "libeigen3-dev", "libcli11-dev", "nlohmann-json3-dev", "three"})
    EXPECT_TRUE(names.contains(name)) << name;
}

TEST_F(Sbom, IsSpdx) {
  EXPECT_EQ(sbom["spdxVersion"], "SPDX-2.3");
  EXPECT_EQ(sbom["dataLicense"], "CC0-1.0");
  std::set<std::string> ids{"SPDXRef-DOCUMENT"};
  const std::regex form("SPDXRef-[A-Za-z0-9.-]+");
  for (const Json& package : sbom["packages"]) {
    const std::string id = package["SPDXID"];
    EXPECT_TRUE(std::regex_match(id, form)) << id;
    EXPECT_TRUE(ids.insert(id).second) << id << " twice";
    EXPECT_FALSE(package["downloadLocation"].get<std::string>().empty());
  }
  for (const Json& relation : sbom["relationships"]) {
    EXPECT_TRUE(ids.contains(relation["spdxElementId"].get<std::string>())) << relation;
    EXPECT_TRUE(ids.contains(relation["relatedSpdxElement"].get<std::string>())) << relation;
  }
}

}  // namespace
}  // namespace mortise::test
