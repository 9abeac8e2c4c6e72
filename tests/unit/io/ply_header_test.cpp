// A PLY file is held to its header before assimp counts to what that says.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <string>

#include "common/io/mesh/mesh_import.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

const std::string kPlyHead =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPlyBody = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

std::string with(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

class PlyHeader : public testing::Test {
 protected:
  std::string said_of(const std::string& bytes) const {
    std::ofstream(folder_.path() / "part.ply", std::ios::binary) << bytes;
    const auto begun = std::chrono::steady_clock::now();
    const auto mesh = import_mesh(folder_.path() / "part.ply", 1.0, {10.0, 1ULL << 30U});
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(8)) << bytes;
    if (!mesh) return mesh.error().text;
    EXPECT_EQ(mesh->mesh.triangles.size(), 4U);
    return "imported";
  }
  void expect(const std::string& bytes, const std::string& words) const {
    const std::string said = said_of(bytes);
    EXPECT_NE(said.find(words), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  }
  test::TestFolder folder_;
  const std::string good_ = "ply\nformat ascii 1.0\n" + kPlyHead + kPlyBody;
};

TEST_F(PlyHeader, OfEveryDialectIsTaken) {
  expect(good_, "imported");
  expect(good_.substr(0, good_.size() - 1), "imported");  // no end of the last line
  expect(with(good_, "\n", "\r\n"), "imported");
  expect(with(good_, "1.0\n", "1.0\ncomment by\tanybody \xc3\xa9 4294967295\nobj_info x\n"),
         "imported");
  expect(with(with(good_, "float x", "float32 x"), "list uchar int", "list uint8 int32"),
         "imported");
  expect(with(good_, "end_header\n", "element edge 0\nproperty int vertex1\nend_header\n"),
         "imported");
}

TEST_F(PlyHeader, ThatPromisesTooMuchIsRefusedAtOnce) {
  expect(with(good_, "vertex 4", "vertex 4000000000"), "the header announces");
  expect(with(good_, "face 4", "face 4294967295"), "the header announces");
  expect(with(good_, "face 4", "face 99999999999999999999"), "is no line of a PLY header");
  expect(with(good_, "face 4", "face -1"), "is no line of a PLY header");
  expect(with(good_, "face 4", "face 4e9"), "is no line of a PLY header");
  expect("ply\nformat ascii 1.0\n" +
             with(kPlyHead, "end_header", "element x 4000000000\nend_header") + kPlyBody,
         "the header announces");
  expect(good_.substr(0, good_.size() - 40), "the header announces");
  expect("ply\nformat binary_little_endian 1.0\n" + kPlyHead + std::string(40, '\0'),
         "the header announces 52 bytes or more, the file has 40 behind it");
}

TEST_F(PlyHeader, ThatIsNoneIsRefusedAtOnce) {
  expect(
      "ply\nformat binary_little_endian 1.0\ncomment VCGLIB generated\nelement vertex 8\n"
      "property float x\nproperty float y\nproperty fl",
      "line 7: 'property fl' is no line of a PLY header");
  expect("ply\nformat ascii 1.0 ascii 4294967295\xff         \nply\n", "line 2: ");
  expect(good_.substr(0, 60), "line ");
  expect("ply\nformat ascii 1.0\n", "has no end");
  expect(with(good_, "ply\n", "plx\n"), "does not begin with 'ply'");
  expect(with(good_, "ascii 1.0", "utf8 1.0"), "line 2: ");
  expect(with(good_, "float y", "floaty y"), "line 5: ");
}

}  // namespace
}  // namespace mortise
