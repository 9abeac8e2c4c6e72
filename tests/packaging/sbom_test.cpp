// The list of what is linked, held against what the loader and dpkg say on their own.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <map>
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

std::set<std::string> libraries_of(const std::string& file) {
  const std::string loader = said_by("ldd " MORTISE_BUILD_DIR "/" + file);
  const std::regex line("(\\S+) => /");
  std::set<std::string> names;
  for (std::sregex_iterator at(loader.begin(), loader.end(), line), end; at != end; ++at)
    names.insert((*at)[1]);
  return names;
}

/// What each of our packages is made of, from the folder of the build.
const std::map<std::string, std::string> kFiles{
    {"mortise-server", "bin/mortise-server"},
    {"mortise-web", "bin/mortise-web"},
    {"mortise-tools", "bin/mortise-import"},
    {"libmortise-engine", "lib/libmortise-engine.so"},
    {"libmortise-io", "lib/libmortise-io.so"},
    {"libmortise-client", "lib/libmortise-client.so"},
    {"python3-mortise", "python/mortise/_mortise.*.so"}};

/// Other elements of this relation of one of our packages.
std::set<std::string> related(const Json& sbom, const std::string& ours, const std::string& type) {
  std::set<std::string> others;
  for (const Json& relation : sbom["relationships"])
    if (relation["relationshipType"] == type && relation["spdxElementId"] == "SPDXRef-" + ours)
      others.insert(relation["relatedSpdxElement"].get<std::string>());
  return others;
}

/// File names that the packages ship which the list says are linked by this one of ours.
std::set<std::string> shipped_by(const Json& sbom, const std::string& ours) {
  std::set<std::string> files;
  const std::set<std::string> linked = related(sbom, ours, "DYNAMIC_LINK");
  for (const Json& package : sbom["packages"]) {
    const std::string name_of = package["name"];
    if (!linked.contains(package["SPDXID"].get<std::string>())) continue;
    if (const auto own = kFiles.find(name_of); own != kFiles.end())
      files.insert(own->second.substr(own->second.find('/') + 1) + "." MORTISE_SOVERSION);
    const std::string list = said_by("dpkg-query -L " + name_of + " 2>/dev/null");
    const std::regex name("/([^/\n]+)(\n|$)");
    for (std::sregex_iterator at(list.begin(), list.end(), name), end; at != end; ++at)
      files.insert((*at)[1]);
  }
  return files;
}

std::set<std::string> not_listed(const Json& sbom) {
  std::set<std::string> missing;
  for (const auto& [ours, file] : kFiles) {
    const std::set<std::string> shipped = shipped_by(sbom, ours);
    for (const std::string& library : libraries_of(file))
      if (!shipped.contains(library)) missing.insert(ours + ": " + library);
  }
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
  for (const auto& [ours, file] : kFiles) EXPECT_GT(libraries_of(file).size(), 3u) << file;
  EXPECT_EQ(not_listed(sbom), std::set<std::string>{});
  Json planted = sbom;
  std::erase_if(planted["packages"].get_ref<Json::array_t&>(),
                [](const Json& package) { return package["name"] == "libfastrtps2.9"; });
  std::set<std::string> missing;
  for (const char* ours : {"libmortise-client", "mortise-server", "mortise-web", "python3-mortise"})
    missing.insert(std::string(ours) + ": libfastrtps.so.2.9");
  EXPECT_EQ(not_listed(planted), missing);
}

TEST_F(Sbom, NamesOurPackagesAndWhatTheyRunWith) {
  const std::set<std::string> ours = related(sbom, "mortise", "CONTAINS");
  for (const auto& [name, file] : kFiles) EXPECT_TRUE(ours.contains("SPDXRef-" + name)) << name;
  EXPECT_TRUE(
      related(sbom, "libmortise-client", "DYNAMIC_LINK").contains("SPDXRef-libmortise-engine"));
  EXPECT_TRUE(related(sbom, "python3-mortise", "DEPENDS_ON").contains("SPDXRef-deb-python3-numpy"));
  EXPECT_TRUE(related(sbom, "libmortise-dev", "DEPENDS_ON").contains("SPDXRef-deb-libeigen3-dev"));
  EXPECT_TRUE(related(sbom, "mortise-web", "CONTAINS").contains("SPDXRef-npm-three"));
}

TEST_F(Sbom, VersionsAreThoseInstalled) {
  std::set<std::string> names;
  for (const Json& package : sbom["packages"]) {
    const std::string name = package["name"],
                      locator = package["externalRefs"][0]["referenceLocator"];
    names.insert(name);
    if (!locator.starts_with("pkg:deb/debian/")) continue;
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
