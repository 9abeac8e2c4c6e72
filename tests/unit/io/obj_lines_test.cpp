// An OBJ file is held to its lines, and assimp is given them plain: it passes over some.
#include <gtest/gtest.h>

#include <string>

#include "common/io/mesh/mesh_import.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

std::string obj_with(const std::string& line) {
  return "o tetra\nv 0 0 0\nv 1 0 0\nv 0 1 0\n" + line + "v 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n" +
         "f 2 3 4\n";
}

class ObjLines : public testing::Test {
 protected:
  std::string said_of(const std::string& bytes) const {
    const auto mesh = import_mesh(folder_.write("part.obj", bytes), 1.0);
    if (!mesh) return mesh.error().text;
    EXPECT_TRUE(mesh->report.closed);
    return "imported";
  }
  test::TestFolder folder_;
};

TEST_F(ObjLines, OfEveryDialectAreTaken) {
  for (const char* line : {"", "# v nonsense\n", "\r\n", "  \t\n", "vt 0 0\nvn 0 0 1\n", "s off\n",
                           "usemtl J\xe4ger\n", "mtllib none of these.mtl\n", "v 9 9 9 1\n",
                           "v 9 9 9 0.5 0.5 0.5\n", "v +9 9e0 \\\n 9\n", "g a b c\n", "l 1 2\n"})
    EXPECT_EQ(said_of(obj_with(line)), "imported") << line;
  EXPECT_EQ(said_of("\xef\xbb\xbf" + obj_with("")), "imported");
  EXPECT_EQ(said_of("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nv 0 0 1\r\nvt 0 0\r\nvn 0 0 1\r\nf 1/1/1 "
                    "3/1/1 2/1/1\r\n"
                    "f -4 -3 -1\r\nf 1 4 3\r\nf 2 3 4"),
            "imported");
}

TEST_F(ObjLines, AreReadAsTheyAreWritten) {
  // The last vertex is of no face: were another one lost, every index would name the next.
  const std::string good = "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 4\nv 9 9 9\n" +
                           std::string("f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const auto with = [&](const std::string& what, const std::string& by) {
    std::string text = good;
    return text.replace(text.find(what), what.size(), by);
  };
  const std::pair<const char*, std::string> written[] = {
      {"plain", good},
      {"mark of UTF-8", "\xef\xbb\xbf" + good},
      {"indented vertex", " \t" + good},
      {"indented face", with("f 2", "\t f 2")},
      {"comment that ends with a backslash", "# C:\\parts\\\n" + good},
      {"the same with two line ends", "# C:\\parts\\\r\n" + good},
      {"comment behind a vertex", with("2 0 0", "2 0 0 # here \\")},
      {"continued line", with("2 0 0\n", "2 0\\\r\n0\r\n")},
      {"colour of four", with("2 0 0", "2 0 0 1 0 0 1")},
      {"odd normals", "vn 1 2\nvt\nvt a b c d e\n" + good},
      {"corners with more", with("f 2 3 4", "f 2/1/7 3//2 4/9")},
      {"padding", good + std::string("\x1a\0\0", 3)}};
  for (const auto& [name, bytes] : written) {
    SCOPED_TRACE(name);
    const auto mesh = import_mesh(folder_.write("part.obj", bytes), 1.0);
    ASSERT_TRUE(mesh) << mesh.error().text;
    EXPECT_TRUE(mesh->report.closed);
    EXPECT_DOUBLE_EQ(mesh->report.volume_mm3, 4.0);
    EXPECT_TRUE(mesh->report.notes.empty()) << mesh->report.notes.front();
  }
}

TEST_F(ObjLines, ThatAreNoneAreRefusedWithTheirNumber) {
  const std::pair<const char*, const char*> bad[] = {
      {"v 9 9\n", "line 5: a vertex has 2 numbers, not three"},
      {"v 9 9 9 9 9\n", "line 5: a vertex has 5 numbers"},
      {"v 9 9 9 0.5\n", "line 5: a vertex has a weight of 0.5"},
      {"v 9 -4.50.25 9\n", "line 5: '-4.50.25' is no finite number"},
      {"v 9 nan 9\n", "line 5: 'nan' is no finite number"},
      {"v 9 1e999 9\n", "line 5: '1e999' is no finite number"},
      {"h 9 9 9\n", "line 5: 'h' is no statement of OBJ"},
      {"\n# x\nf 1 2\n", "line 7: a face has fewer than three corners"},
      {"f 1 2 3a\n", "line 5: '3a' is no corner of a face"},
      {"o C:\\parts\\\n", "line 5: 'o' ends with a backslash, which joins the next statement"},
      {"f 1 2 0\n", "line 5: '0' is no corner of a face"},
      {"f 1 2 3/\xc3\xa4\n", "is no corner of a face"}};
  for (const auto& [line, words] : bad) {
    const std::string said = said_of(obj_with(line));
    EXPECT_NE(said.find(words), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace mortise
