#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "tests/network/program.h"

namespace mortise::test {

/// A site with keys of its own, made by the script that people use.
class KeyRing {
 public:
  explicit KeyRing(const std::string& folder, const std::string& site = "mortise")
      : site_(folder_.path() / folder) {
    run({"init", "--site", site});
  }

  void issue(const std::string& name, const std::string& role,
             const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"issue", name, "--role", role};
    words.insert(words.end(), more.begin(), more.end());
    run(words);
  }
  void revoke(const std::string& name) { run({"revoke", name}); }
  const std::string& trouble() const { return trouble_; }  ///< empty: all went well
  std::string operator[](const std::string& name) const { return (site_ / name).string(); }

  /// A copy of somebody's keys: what is kept by who has to give them back.
  std::string copy_of(const std::string& name, const std::string& kept) {
    const std::filesystem::path elsewhere = folder_.path() / kept;  // no new list gets there
    std::filesystem::copy(site_ / name, elsewhere, std::filesystem::copy_options::recursive);
    return elsewhere.string();
  }

 private:
  void run(std::vector<std::string> words) {
    words.insert(words.end(), {"--keys", site_.string()});
    Program keys(folder_.path(), "mortise-keys", words);
    if (keys.wait(60) != 0) trouble_ += keys.errors();
  }

  TestFolder folder_;
  std::filesystem::path site_;
  std::string trouble_;
};

}  // namespace mortise::test
