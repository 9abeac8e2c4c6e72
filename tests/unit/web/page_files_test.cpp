// The files of the page, and nothing else of the disk.
#include "client/web/page_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/test_folder.h"

namespace mortise::web {
namespace {

namespace fs = std::filesystem;

struct PageFolder : testing::Test {
  const test::TestFolder own;
  const fs::path folder = own.path();

  void SetUp() override {
    write("secret.html", "secret");
    write("page/index.html", "<script type=\"importmap\">{}</script>");
    write("page/view/scene.js", "let x;");
    write("page/.hidden.js", "hidden");
    write("page/notes.md", "notes");
    write("page/package.json", "{}");
    write("page/node_modules/three/build/three.module.js", "three");
    write("page/node_modules/three/examples/jsm/controls/Orbit.js", "orbit");
    write("page/node_modules/three/src/x.js", "source");
    write("page/node_modules/other/x.js", "other");
    fs::create_symlink(folder / "secret.html", folder / "page/link.html");
    fs::create_symlink(folder, folder / "page/up");
  }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << text;
  }
};

TEST_F(PageFolder, AreServedByNameAndKind) {
  const auto page = PageFiles::open(folder / "page");
  ASSERT_TRUE(page);
  const auto index = page->find("/");
  ASSERT_TRUE(index);
  EXPECT_TRUE(index->is_page);
  EXPECT_EQ(index->type, "text/html; charset=utf-8");
  const auto script = page->find("/view/scene.js?v=2");
  ASSERT_TRUE(script);
  EXPECT_EQ(*script->bytes, "let x;");
  EXPECT_EQ(script->type, "text/javascript; charset=utf-8");
  EXPECT_FALSE(script->is_page);
  EXPECT_EQ(*page->find("/three/build/three.module.js")->bytes, "three");
  EXPECT_EQ(*page->find("/three/examples/jsm/controls/Orbit.js")->bytes, "orbit");
  EXPECT_TRUE(page->has_three());
}

TEST_F(PageFolder, AndNothingElse) {
  const auto page = PageFiles::open(folder / "page");
  ASSERT_TRUE(page);
  for (const char* target : {"",
                             "x",
                             "/../secret.html",
                             "/view/../../secret.html",
                             "/%2e%2e/secret.html",
                             "/..%2fsecret.html",
                             "//secret.html",
                             "/./index.html",
                             "/view//scene.js",
                             "/view/",
                             "/.hidden.js",
                             "/notes.md",
                             "/package.json",
                             "/node_modules/other/x.js",
                             "/three/src/x.js",
                             "/three/build",
                             "/three/build/../../other/x.js",
                             "/link.html",
                             "/up/secret.html",
                             "/view\\scene.js",
                             "/index.html/x",
                             "/nowhere.js",
                             "/view"})
    EXPECT_FALSE(page->find(target)) << target;
  EXPECT_FALSE(page->find(std::string_view("/index.html\0.js", 15)));
}

TEST_F(PageFolder, ChangeTheirTagWithTheirContent) {
  const auto page = PageFiles::open(folder / "page");
  ASSERT_TRUE(page);
  const std::string before = page->find("/view/scene.js")->etag;
  EXPECT_EQ(page->find("/view/scene.js")->etag, before);
  write("page/view/scene.js", "let another;");
  EXPECT_NE(page->find("/view/scene.js")->etag, before);
}

TEST_F(PageFolder, WithoutAPageIsSaid) {
  const auto page = PageFiles::open(folder / "page/view");
  ASSERT_FALSE(page);
  EXPECT_NE(page.error().text.find("--page"), std::string::npos);
  EXPECT_FALSE(PageFiles::open(folder / "nowhere"));
}

TEST(ContentSecurityPolicy, AllowsTheImportMapByItsHash) {
  // openssl dgst -sha256 -binary <<< ... | base64 of "{}"
  const std::string policy = content_security_policy(
      "<script type=\"importmap\">{}</script><script src=x>", "127.0.0.1:80", false);
  EXPECT_NE(policy.find("script-src 'self' 'sha256-RBNvo1WzZ4oRRq0W9+hknpT7T8If536DEMBg9hyq/4o='"),
            std::string::npos)
      << policy;
  EXPECT_NE(policy.find("ws://127.0.0.1:80;"), std::string::npos);
  EXPECT_EQ(policy.find("unsafe"), std::string::npos);
  EXPECT_NE(content_security_policy("", "h", true).find("script-src 'self';"), std::string::npos);
}

}  // namespace
}  // namespace mortise::web
