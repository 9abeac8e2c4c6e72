// A PLY file is held to its header, row by row, before assimp counts to what that says.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <string>

#include "common/io/mesh/mesh_import.h"
#include "tests/support/effort.h"
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
    if (test::timed()) {
      EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(8)) << bytes;
    }
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
  static std::string binary() {
    std::string bytes = "ply\nformat binary_big_endian 1.0\n" + kPlyHead;
    const std::string one = "\x3f\x80", zero(2, '\0');  // halves of 1.0F and of all else
    for (const int axis : {-1, 0, 1, 2})
      for (int k = 0; k < 3; ++k) bytes += (k == axis ? one : zero) + zero;
    for (const auto& face : {"\0\2\1", "\0\1\3", "\0\3\2", "\1\2\3"}) {
      bytes += '\3';
      for (int k = 0; k < 3; ++k) bytes += std::string(3, '\0') + face[k];
    }
    return bytes;
  }
  const std::string binary_ = binary();
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
  expect(with(good_, "\n1 0 0\n", "\n\n \ncomment x\n +1 0\t0 \r\n"), "imported");
  expect(good_ + std::string("\n\x1a\0\0", 4), "imported");
  expect(binary_ + std::string(100, '\0'), "imported");
  expect(binary_ + "more", "imported");
  expect(with(binary_, "end_header\n", "element edge 0\nproperty int vertex1\nend_header\n"),
         "imported");
}

TEST_F(PlyHeader, WithOtherRowsThanItAnnouncesIsRefused) {
  const std::string cut = "rows of 'face', the file has 2: it is damaged or was cut off";
  expect(good_.substr(0, good_.size() - 16), cut);
  expect(good_.substr(0, good_.size() - 17), cut);  // no end of the last line
  expect(good_.substr(0, good_.size() - 3), "line 17: a row of 'face' has 3 numbers, not 4");
  expect(with(good_, "face 4", "face 3"), "line 17: more rows than the header announces");
  expect(with(good_, "vertex 4", "vertex 5"), "line 14: a row of 'vertex' has 4 numbers, not 3");
  expect(with(good_, "vertex 4", "vertex 3"), "line 13: a row of 'face'");
  expect(with(good_, "\n1 0 0\n", "\n1 0\n"), "line 11: a row of 'vertex' has 2 numbers, not 3");
  expect(with(good_, "\n1 0 0\n", "\n1 0 0 7\n"), "line 11: a row of 'vertex' has 4 numbers");
  expect(with(good_, "\n1 0 0\n", "\n1.000,5 0 0\n"),
         "line 11: '1.000,5' is no number (decimals have a point)");
  expect(with(good_, "3 0 2 1", "3 0 2.0 1"), "line 14: '2.0' is no whole number of its type");
  expect(with(good_, "3 0 2 1", "3 0 4294967298 1"), "'4294967298' is no whole number");
  expect(with(good_, "3 0 2 1", "-3 0 2 1"), "line 14: a row of 'face' has no list of '-3'");

  expect(with(binary_, "face 4", "face 3"), "the file has 13 bytes behind the rows");
  expect(with(binary_, "vertex 4", "vertex 3"), "the file ");
  expect(binary_.substr(0, binary_.size() - 1), "ends before the last row");
  expect(with(binary_, std::string("\3\0", 2), std::string("\xff\0", 2)),
         "ends before the last row");
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

TEST_F(PlyHeader, ACornerHasThreeAxes) {
  const std::string text = "ply\nformat ascii 1.0\n" + kPlyHead + kPlyBody;
  expect(text, "imported");
  for (const std::string axis : {"x", "y", "z"}) {
    expect(with(text, "float " + axis + "\n", "float w\n"), "its vertices have no " + axis);
    expect(with(binary(), "float " + axis + "\n", "float w\n"), "its vertices have no " + axis);
  }
}

}  // namespace
}  // namespace mortise
