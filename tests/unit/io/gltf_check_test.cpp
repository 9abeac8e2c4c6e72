// A glTF file is looked at before assimp drops, or takes for nothing, what it does not understand.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>

#include "common/io/mesh/mesh_import.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

// A tetrahedron: four points of three floats, twelve corners of two bytes.
std::string gltf_buffer() {
  const float points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::uint16_t corners[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  std::string bytes(sizeof points + sizeof corners, '\0');
  std::memcpy(bytes.data(), points, sizeof points);
  std::memcpy(bytes.data() + sizeof points, corners, sizeof corners);
  return bytes;
}

const std::string kGltf =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
    R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[)"
    R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},)"
    R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],"bufferViews":[)"
    R"({"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],)"
    R"("buffers":[{"byteLength":72,"uri":"part.bin"}]})";

std::string gltf_with(const std::string& what, const std::string& by, std::string text = kGltf) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

std::string node_with(const std::string& more) {
  return gltf_with(R"("mesh":0)", R"("mesh":0,)" + more);
}

std::string little(std::uint32_t number) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(number >> 8 * i & 0xffU);
  return bytes;
}

std::string glb(std::uint32_t version = 2) {
  std::string text = gltf_with(R"(,"uri":"part.bin")", "");
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto size = [](const std::string& of) { return static_cast<std::uint32_t>(of.size()); };
  const std::string chunks =
      little(size(text)) + "JSON" + text + little(72) + std::string("BIN\0", 4) + gltf_buffer();
  return "glTF" + little(version) + little(12 + size(chunks)) + chunks;
}

class GltfCheck : public testing::Test {
 protected:
  void SetUp() override {
    folder_.write("part.bin", gltf_buffer());
    folder_.write("the part.bin", gltf_buffer());
  }
  std::string said_of(const std::string& bytes, const std::string& name = "part.gltf") const {
    const auto mesh = import_mesh(folder_.write(name, bytes), 1000.0);
    if (!mesh) return mesh.error().text;
    EXPECT_TRUE(mesh->report.closed);
    EXPECT_NEAR(mesh->report.volume_mm3, 1e9 / 6.0, 1e5);
    return "imported";
  }
  void expect(const std::string& bytes, const std::string& words,
              const std::string& name = "part.gltf") const {
    const std::string said = said_of(bytes, name);
    EXPECT_NE(said.find(words), std::string::npos) << "wanted '" << words << "' in: " << said;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  }
  test::TestFolder folder_;
};

TEST_F(GltfCheck, WhatAssimpReadsAsItIsMeantIsTaken) {
  expect(kGltf, "imported");
  expect(gltf_with("part.bin", "the%20part.bin"), "imported");
  expect(gltf_with("part.bin", "the part.bin"), "imported");
  expect(glb(), "imported", "part.glb");
  expect(node_with(R"("rotation":[0,0,0.7071,0.7071],"translation":[1,2,3])"), "imported");
  expect(node_with(R"("matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,5,6,7,1])"), "imported");
  expect(gltf_with("\"scene\":0", R"("extensionsRequired":["KHR_materials_unlit"],"scene":0)"),
         "imported");
}

TEST_F(GltfCheck, WhatItWouldDropIsRefused) {
  expect(gltf_with(R"("count":4)", R"("count":3)"), "primitives[0] names vertex 3 of 3");
  expect(gltf_with(R"("count":12)", R"("count":13)"), "accessors[1] reaches beyond its view");
  expect(gltf_with(R"("count":12)", R"("count":11)"), "11 corners, which make no whole triangles");
  expect(gltf_with(R"("count":4)", R"("byteOffset":18446744073709551604,"count":4)"),
         "accessors[0]: byteOffset is no whole number");
  expect(gltf_with(R"("byteOffset":48)", R"("byteOffset":"48")"), "byteOffset is no whole number");
  expect(gltf_with(R"("byteOffset":48)", R"("byteOffset":52)"), "reaches beyond its buffer");
  expect(gltf_with(R"("byteLength":48)", R"("byteLength":48,"byteStride":4)"), "stride");
  expect(gltf_with("VEC3", "VEC2"), "positions that are not three floats");
  expect(gltf_with("5123", "5122"), "accessors[1] are no indices");
  expect(gltf_with("\"scene\":0", R"("extensionsRequired":["EXT_mesh_gpu_instancing"],"scene":0)"),
         "requires the extension 'EXT_mesh_gpu_instancing', which is not read");
  expect(gltf_with(R"("primitives")", R"("weights":[0.5],"primitives")"), "bent by weights");
  expect(gltf_with(R"("nodes":[0])", R"("nodes":["0",0])"), "scenes[0]: nodes is no whole number");
  expect(node_with(R"("children":[-1])"), "nodes[0]: children is no whole number");
  expect(node_with(R"("children":[7])"), "names nodes[7], and there are 1");
}

TEST_F(GltfCheck, APlacementThatIsNoneIsRefused) {
  expect(node_with(R"("rotation":[0,0,1,1])"), "nodes[0] has a rotation of length 1.41");
  expect(node_with(R"("rotation":[0,0,0,0])"), "nodes[0] has a rotation of length 0.0");
  expect(node_with(R"("translation":["50",0,0])"), "nodes[0]: translation is not 3 numbers");
  expect(node_with(R"("translation":[50,0])"), "nodes[0]: translation is not 3 numbers");
  expect(node_with(R"("matrix":[1,0,0,0,0,1,0,0])"), "nodes[0]: matrix is not 16 numbers");
  expect(node_with(R"("matrix":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1])"), "perspective");
  expect(node_with(R"("matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"scale":[2,2,2])"), "keep one");
}

TEST_F(GltfCheck, WhatIsNoGltfIsSaidToBeNone) {
  expect(kGltf.substr(0, 100), "its JSON is damaged or was cut off, at byte 101");
  expect("\xef\xbb\xbf" + kGltf, "a mark of UTF-8");
  expect(gltf_with("2.0", "1.0"), "is glTF of version '1.0'; export it as 2.0");
  expect(gltf_with("\"scene\":0", R"("scene":0,"scene":0)"), "has 'scene' twice");
  expect(glb(), "give it the ending .glb");
  expect(kGltf, "does not begin with 'glTF'", "part.glb");
  expect(glb(1), "is a binary glTF of version 1; export it as version 2", "part.glb");
  expect(glb().substr(0, 300), "it was cut off", "part.glb");
  expect(gltf_with("part.bin", "no.bin"), "names 'no.bin', which cannot be read");
  expect(gltf_with("part.bin", "..%2f..%2fetc%2fpasswd"), "names '..%2f");
  expect(gltf_with(R"(,"uri":"part.bin")", ""), "buffers[0] says not where its bytes are");
  expect(gltf_with("\"byteLength\":72", "\"byteLength\":80"), "announces 80 bytes and holds 72");
}

TEST_F(GltfCheck, ManyNodesAreReadInTheTimeOfAnImport) {
  std::string nodes;
  for (int i = 0; i < 100'000; ++i) nodes += R"(,{"name":"n"})";
  expect(gltf_with(R"({"mesh":0})", R"({"mesh":0})" + nodes), "imported");
}

// Nodes of which each holds the next one; the last has the mesh.
std::string nodes_in_each_other(int levels) {
  std::string nodes;
  for (int i = 1; i < levels; ++i) nodes += R"({"children":[)" + std::to_string(i) + "]},";
  return gltf_with(R"({"mesh":0})", nodes + R"({"mesh":0})");
}

TEST_F(GltfCheck, WhatIsNestedTooDeepIsRefused) {
  expect(nodes_in_each_other(1000), "imported");
  expect(nodes_in_each_other(1001), "its nodes are nested deeper than 1000 levels");
  expect(nodes_in_each_other(5000), "its nodes are nested deeper than 1000 levels");
  expect(node_with(R"("children":[0])"), "its nodes hold each other");
  const std::string open(200'000, '['), close(200'000, ']');
  expect(gltf_with(R"("scene":0)", R"("extras":)" + open + close + R"(,"scene":0)"),
         "its lists are nested deeper than 1000 levels");
}

}  // namespace
}  // namespace mortise
