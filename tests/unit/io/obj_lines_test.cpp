// An OBJ file is held to its lines before assimp passes over what it does not know.
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
