// Mutated meshes of every format, as the importer meets them: each is refused in one line, or what
// is imported says of itself what is wrong with it, and holds no number that is not in the file.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>
#include <set>

#include "common/io/mesh/mesh_import.h"
#include "tests/fuzz/mutated.h"
#include "tests/support/effort.h"
#include "tests/support/test_folder.h"

namespace mortise::test {
namespace {

constexpr double kMost_s = 15.0;

// A box with numbers of its own.
constexpr float kX[] = {0.0F, 30.25F}, kY[] = {-4.5F, 12.0F}, kZ[] = {1.125F, 7.75F};
constexpr int kTriangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                   {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                   {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

std::string text_of(float value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", static_cast<double>(value));
  return text;
}
std::string corner(int i, const char* between = " ") {
  return text_of(kX[i & 1]) + between + text_of(kY[i >> 1 & 1]) + between + text_of(kZ[i >> 2]);
}
template <class Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}
std::string corners_in_binary() {
  std::string bytes;
  for (int i = 0; i < 8; ++i)
    for (const float value : {kX[i & 1], kY[i >> 1 & 1], kZ[i >> 2]}) append(bytes, value);
  return bytes;
}

std::string stl_text() {
  std::string text = "solid box\n";
  for (const auto& triangle : kTriangles) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (const int i : triangle) text += "  vertex " + corner(i) + "\n";
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}
std::string stl_binary() {
  std::string bytes(80, ' ');
  append(bytes, std::uint32_t{12});
  const std::string corners = corners_in_binary();
  for (const auto& triangle : kTriangles) {
    bytes.append(12, '\0');
    for (const int i : triangle) bytes += corners.substr(12 * static_cast<std::size_t>(i), 12);
    bytes.append(2, '\0');
  }
  return bytes;
}
std::string obj() {
  std::string text = "o box\n";
  for (int i = 0; i < 8; ++i) text += "v " + corner(i) + "\n";
  for (const auto& t : kTriangles)
    text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " +
            std::to_string(t[2] + 1) + "\n";
  return text;
}
std::string ply_head(const char* format) {
  return std::string("ply\nformat ") + format +
         " 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement "
         "face 12\nproperty list uchar int vertex_indices\nend_header\n";
}
std::string ply_text() {
  std::string text = ply_head("ascii");
  for (int i = 0; i < 8; ++i) text += corner(i) + "\n";
  for (const auto& t : kTriangles)
    text += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) +
            "\n";
  return text;
}
std::string ply_binary() {
  std::string bytes = ply_head("binary_little_endian") + corners_in_binary();
  for (const auto& triangle : kTriangles) {
    append(bytes, std::uint8_t{3});
    for (const int i : triangle) append(bytes, std::int32_t{i});
  }
  return bytes;
}
std::string gltf_json(const std::string& buffer) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":)"
         R"([{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[0,-4.5,1.125],)"
         R"("max":[30.25,12,7.75]},{"bufferView":1,"componentType":5123,"count":36,"type":)"
         R"("SCALAR"}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":96},{"buffer":0,)"
         R"("byteOffset":96,"byteLength":72}],"buffers":[{"byteLength":168)" +
         buffer + "}]}";
}
std::string gltf_buffer() {
  std::string bytes = corners_in_binary();
  for (const auto& triangle : kTriangles)
    for (const int i : triangle) append(bytes, static_cast<std::uint16_t>(i));
  return bytes;
}
std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i + 2 < bytes.size(); i += 3) {
    const auto at = [&](std::size_t k) { return static_cast<std::uint8_t>(bytes[i + k]); };
    const unsigned three = at(0) << 16U | at(1) << 8U | at(2);
    for (const unsigned shift : {18U, 12U, 6U, 0U}) text += kDigits[three >> shift & 63U];
  }
  return text;
}
std::string gltf() {  // 168 bytes are 56 times three
  return gltf_json(R"(,"uri":"data:application/octet-stream;base64,)" + base64(gltf_buffer()) +
                   "\"");
}
std::string glb() {
  std::string json = gltf_json("");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string binary = gltf_buffer();
  std::string bytes = "glTF";
  append(bytes, std::uint32_t{2});
  append(bytes, static_cast<std::uint32_t>(28 + json.size() + binary.size()));
  append(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append(bytes, static_cast<std::uint32_t>(binary.size()));
  return bytes + std::string("BIN\0", 4) + binary;
}
std::string dae() {
  std::string numbers, indices;
  for (int i = 0; i < 8; ++i) numbers += corner(i) + " ";
  for (const auto& triangle : kTriangles)
    for (const int i : triangle) indices += std::to_string(i) + " ";
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit name="u"
meter="0.001"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="24">)" +
         numbers +
         R"(</float_array><technique_common><accessor source="#pa" count="8" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/>
</vertices><triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
         indices + R"(</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>
<visual_scene id="s"><node id="a"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

struct Format {
  const char* name;
  const char* ending;
  std::string (*seed)();
  bool places = false;   ///< it can state transforms: numbers are computed
  double unit_mm = 1.0;  ///< another than it states would be told
};
constexpr Format kFormats[] = {{"StlText", "stl", stl_text},
                               {"StlBinary", "stl", stl_binary},
                               {"Obj", "obj", obj},
                               {"PlyText", "ply", ply_text},
                               {"PlyBinary", "ply", ply_binary},
                               {"Gltf", "gltf", gltf, true, 1000.0},
                               {"Glb", "glb", glb, true, 1000.0},
                               {"Dae", "dae", dae, true}};

/// All numbers that may be read at any place of the file, as text or as bytes of any kind.
class NumbersIn {
 public:
  explicit NumbersIn(const std::string& bytes) {
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      const double number = std::strtod(bytes.c_str() + at, nullptr);
      numbers_.insert(number);
      numbers_.insert(static_cast<double>(static_cast<float>(number)));
      std::string here = bytes.substr(at, 8);
      as_bytes(here);
      for (const std::size_t size : {8U, 4U, 2U}) {  // of the other end first
        std::string turned = here.substr(0, size);
        std::reverse(turned.begin(), turned.end());
        as_bytes(turned);
      }
    }
  }
  bool hold(double number) const { return numbers_.contains(number); }

 private:
  template <class Number>
  void as(const std::string& bytes) {
    if (bytes.size() < sizeof(Number)) return;
    Number number;
    std::memcpy(&number, bytes.data(), sizeof number);
    const auto value = static_cast<double>(number);
    if (std::isfinite(value)) {
      numbers_.insert(value);
      numbers_.insert(static_cast<double>(static_cast<float>(value)));
    }
  }
  void as_bytes(const std::string& bytes) {
    as<float>(bytes), as<double>(bytes), as<std::int8_t>(bytes), as<std::uint8_t>(bytes);
    as<std::int16_t>(bytes), as<std::uint16_t>(bytes), as<std::int32_t>(bytes);
    as<std::uint32_t>(bytes);
  }
  std::set<double> numbers_;
};

/// Processor time of all imports that have ended.
double children_s() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

class MeshFuzz : public testing::TestWithParam<Format> {
 protected:
  /// Of a file with these bytes. Empty: it is refused, or told, or true.
  std::string what_is_wrong(const std::string& bytes) {
    const auto file = folder_.write(std::string("fuzz.") + GetParam().ending, bytes);
    const double begun_s = children_s();
    const auto mesh = import_mesh(file, GetParam().unit_mm);
    slowest_s_ = std::max(slowest_s_, children_s() - begun_s);
    if (!mesh) {
      ++refused_;
      const std::string& why = mesh.error().text;
      if (slowest_s_ > kMost_s) return "it took " + std::to_string(slowest_s_) + " s: " + why;
      if (why.find('\n') != std::string::npos) return "refused in several lines: " + why;
      return why.find("fuzz.") == std::string::npos ? "refused without a name: " + why : "";
    }
    const std::vector<std::string> notes = notes_of(mesh->report);
    ++(notes.empty() ? silent_ : told_);
    const auto& points = mesh->mesh.points_mm;
    for (const auto& triangle : mesh->mesh.triangles)
      for (const auto i : triangle)
        if (static_cast<std::size_t>(i) >= points.size()) return "a triangle of no points";
    if (notes.empty() && !mesh->report.closed) return "open, and nothing is said";
    const NumbersIn numbers(GetParam().places ? std::string() : bytes);
    for (const Vec3& point : points)
      for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(point[axis])) return "not finite";
        if (!GetParam().places && !numbers.hold(point[axis]))
          return "a number that is not in the file: " + std::to_string(point[axis]);
      }
    return "";
  }
  void keep(const std::string& bytes) const {
    if (const char* folder = std::getenv("MORTISE_KEEP"))
      std::ofstream(std::string(folder) + "/" + GetParam().name + "." + GetParam().ending,
                    std::ios::binary)
          << bytes;
  }

  TestFolder folder_;
  double slowest_s_ = 0.0;
  int refused_ = 0, told_ = 0, silent_ = 0;
};

TEST_P(MeshFuzz, MutatedFilesAreRefusedOrSayWhatIsWrong) {
  const std::string seed = GetParam().seed();
  ASSERT_EQ(what_is_wrong(seed), "");
  ASSERT_EQ(silent_, 1) << "the seed is good";
  std::mt19937_64 random(31);
  const int count = effort(50);
  for (int i = 0; i < count; ++i) {
    const std::string bytes = mutated(seed, random);
    const std::string wrong = what_is_wrong(bytes);
    if (!wrong.empty()) keep(bytes);
    EXPECT_EQ(wrong, "") << "mutation " << i;
    ASSERT_TRUE(!timed() || slowest_s_ < kMost_s) << "mutation " << i;
  }
  std::printf("%s: %d mutations, %d refused, %d told, %d imported without a word; at most %.2f s\n",
              GetParam().name, count, refused_, told_, silent_ - 1, slowest_s_);
  EXPECT_GT(refused_ + told_, count / 5) << "the mutations are too mild";
}

/// A file that was cut short is never taken for the whole.
TEST_P(MeshFuzz, OneThatIsCutShortIsRefusedOrToldOrWhole) {
  const std::string seed = GetParam().seed();
  const auto whole =
      import_mesh(folder_.write(std::string("w.") + GetParam().ending, seed), GetParam().unit_mm);
  ASSERT_TRUE(whole) << whole.error().text;
  const std::size_t every = plays(1, 2) ? 1 : seed.size() / 12;
  for (std::size_t size = 1; size < seed.size(); size += every) {
    const std::string cut = seed.substr(0, size);
    EXPECT_EQ(what_is_wrong(cut), "") << "after " << size << " bytes";
    const auto mesh = import_mesh(folder_.path() / (std::string("fuzz.") + GetParam().ending),
                                  GetParam().unit_mm);
    if (mesh && notes_of(mesh->report).empty()) {
      EXPECT_EQ(mesh->mesh.triangles.size(), whole->mesh.triangles.size()) << size << " bytes";
      EXPECT_EQ(mesh->mesh.points_mm.size(), whole->mesh.points_mm.size()) << size << " bytes";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, MeshFuzz, testing::ValuesIn(kFormats),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace mortise::test
