#include "common/io/mesh/importer/gltf_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "common/base/in_quotes.h"
#include "common/io/mesh/importer/nesting.h"

namespace mortise {
namespace {

using nlohmann::json;

/// Of every number of bytes and things: products of two and sums of those fit into 64 bits, and a
/// GLB is not longer.
constexpr std::uint64_t kMostOfGltf = 0xffffffffU;
/// How far the length of a rotation may be off 1: it is written with four digits, and the part
/// grows by twice as much.
constexpr double kRotationSlack = 5e-5;

/// What assimp applies or what changes no shape; the others must be understood by who reads it.
constexpr std::array<std::string_view, 5> kKnownExtensions = {
    "KHR_draco_mesh_compression", "KHR_mesh_quantization", "KHR_lights_punctual", "KHR_xmp",
    "KHR_xmp_json_ld"};
constexpr std::array<std::string_view, 4> kKnownKinds = {"KHR_materials_", "KHR_texture_",
                                                         "EXT_texture_", "MSFT_texture_"};

struct GltfFault {
  std::string text;
};

struct GltfParts {
  std::string_view text;
  std::optional<std::string_view> binary;
};

std::uint64_t little_number(std::string_view bytes, std::uint64_t at, unsigned size) {
  std::uint64_t number = 0;
  for (unsigned i = 0; i < size; ++i)
    number |= std::uint64_t{static_cast<unsigned char>(bytes[at + i])} << 8 * i;
  return number;
}

// A header of magic, version and length; chunks of length, kind and bytes.
GltfParts parts_of_glb(std::string_view bytes) {
  // Sizes in bytes, and the kinds "JSON" and "BIN" as little endian numbers.
  constexpr std::uint64_t kHead = 12, kChunkHead = 8, kText = 0x4e4f534a, kBinary = 0x004e4942;
  const GltfFault cut{"is no whole binary glTF: it was cut off; export it again"};
  if (!bytes.starts_with("glTF"))
    throw GltfFault{"is no binary glTF: it does not begin with 'glTF'; is its ending right?"};
  if (bytes.size() < kHead) throw cut;
  if (const std::uint64_t version = little_number(bytes, 4, 4); version != 2)
    throw GltfFault{"is a binary glTF of version " + std::to_string(version) +
                    "; export it as version 2"};
  const std::uint64_t length = little_number(bytes, 8, 4);
  if (length > bytes.size()) throw cut;
  bytes = bytes.substr(0, length);
  GltfParts parts;
  for (std::uint64_t at = kHead; at + kChunkHead <= bytes.size();) {
    const std::uint64_t size = little_number(bytes, at, 4), kind = little_number(bytes, at + 4, 4);
    at += kChunkHead;
    if (size > bytes.size() - at) throw cut;
    if (parts.text.empty() && kind != kText) break;
    if (kind == kText)
      parts.text = bytes.substr(at, size);
    else if (kind == kBinary && !parts.binary)
      parts.binary = bytes.substr(at, size);
    at += size;
  }
  if (parts.text.empty()) throw GltfFault{"is a binary glTF without its description"};
  return parts;
}

GltfParts parts_of_gltf(std::string_view bytes, bool binary) {
  if (binary) return parts_of_glb(bytes);
  if (bytes.starts_with("glTF")) throw GltfFault{"is a binary glTF; give it the ending .glb"};
  if (bytes.starts_with("\xef\xbb\xbf"))
    throw GltfFault{"begins with a mark of UTF-8, which glTF forbids; save it without"};
  return {bytes, {}};
}

/// Looks at a text as it is read: how deep it goes, and for two members with one name, of which
/// assimp takes the first and others the last. The parser itself, where it is watched, walks each
/// list again after each of its objects.
class GltfMembers final : public nlohmann::json_sax<json> {
 public:
  const std::string& twice() const { return twice_; }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return opened(); }
  bool start_array(std::size_t) override { return opened(); }
  bool end_object() override { return closed(); }
  bool end_array() override { return closed(); }
  bool key(string_t& name) override {
    if (!open_.back().insert(name).second) twice_ = name;
    return true;
  }
  /// The parser that makes the document says it.
  bool parse_error(std::size_t, const std::string&, const json::exception&) override {
    return false;
  }

 private:
  bool opened() {
    open_.emplace_back();
    if (open_.size() > kMostLevels) throw GltfFault{too_deep("lists")};
    return true;
  }
  bool closed() {
    open_.pop_back();
    return true;
  }

  std::vector<std::set<std::string>> open_;  ///< the names of each list and object that is open
  std::string twice_;
};

json parsed_gltf(std::string_view text) {
  GltfMembers members;
  json::sax_parse(text, &members);
  try {
    json gltf = json::parse(text);
    if (!members.twice().empty())
      throw GltfFault{"has " + in_quotes(members.twice()) + " twice; keep one"};
    return gltf;
  } catch (const json::parse_error& error) {
    throw GltfFault{"its JSON is damaged or was cut off, at byte " + std::to_string(error.byte)};
  } catch (const json::exception&) {
    throw GltfFault{"its JSON has a number that no program can hold"};
  }
}

std::string decoded_base64(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  unsigned held = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos)
      throw GltfFault{"has a buffer in base64 with " + in_quotes(std::string(1, c)) + " in it"};
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += static_cast<char>(bits >> held & 0xffU);
  }
  return bytes;
}

std::string place(std::string_view list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

/// The bytes of the buffers, each read once.
class GltfBuffers {
 public:
  GltfBuffers(std::optional<std::string_view> binary, std::filesystem::path folder,
              FolderFiles& files)
      : binary_(binary), folder_(std::move(folder)), files_(files) {}

  std::string_view bytes(std::size_t index, const json& buffer, std::uint64_t size) {
    const bool inside = index == 0 && binary_ && !buffer.contains("uri");
    const auto [kept, fresh] = kept_.try_emplace(index);
    if (!inside && !buffer.contains("uri"))
      throw GltfFault{place("buffers", index) + " says not where its bytes are"};
    if (fresh && !inside) kept->second = read(buffer["uri"].get<std::string>(), size);
    const std::string_view bytes = inside ? *binary_ : std::string_view(kept->second);
    if (bytes.size() < size)
      throw GltfFault{place("buffers", index) + " announces " + std::to_string(size) +
                      " bytes and holds " + std::to_string(bytes.size()) + ": it was cut off"};
    return bytes;
  }

 private:
  std::string read(std::string uri, std::uint64_t most) {
    constexpr std::string_view kBase64 = ";base64,";
    if (uri.starts_with("data:")) {
      const std::size_t mark = uri.find(kBase64);
      if (mark == std::string::npos) throw GltfFault{"has a buffer of data that is not base64"};
      return decoded_base64(std::string_view(uri).substr(mark + kBase64.size()));
    }
    std::replace(uri.begin(), uri.end(), '\\', '/');
    Assimp::IOStream* const file = files_.Open((folder_ / uri).c_str(), "rb");
    if (file == nullptr)
      throw GltfFault{"names " + in_quotes(uri) + ", which " +
                      (files_.refused().empty() ? "cannot be read" : "lies outside of its folder") +
                      "; put it beside the mesh"};
    std::string bytes(std::min<std::uint64_t>(file->FileSize(), most), '\0');
    bytes.resize(file->Read(bytes.data(), 1, bytes.size()));
    files_.Close(file);
    return bytes;
  }

  std::optional<std::string_view> binary_;
  std::filesystem::path folder_;
  FolderFiles& files_;
  std::map<std::size_t, std::string> kept_;
};

class GltfCheck {
 public:
  GltfCheck(const json& gltf, GltfBuffers& buffers) : gltf_(gltf), buffers_(buffers) {}

  /// Throws GltfFault.
  void check() {
    if (!gltf_.is_object()) throw GltfFault{"is no glTF: its JSON is no object"};
    check_version();
    check_extensions();
    for (std::size_t i = 0; i < list(gltf_, "nodes").size(); ++i)
      check_node(entry("nodes", i), place("nodes", i));
    check_nesting();
    for (std::size_t i = 0; i < list(gltf_, "scenes").size(); ++i)
      check_names(entry("scenes", i), "nodes", place("scenes", i));
    if (gltf_.contains("scene")) entry("scenes", whole(gltf_, "scene", "it"));
    for (std::size_t i = 0; i < list(gltf_, "meshes").size(); ++i) {
      const json& mesh = entry("meshes", i);
      check_weights(mesh, place("meshes", i));
      const json& primitives = list(mesh, "primitives");
      for (std::size_t k = 0; k < primitives.size(); ++k)
        check_primitive(object(primitives[k], "primitive"),
                        place("meshes", i) + "." + place("primitives", k));
    }
  }

 private:
  /// Where the numbers of an accessor lie in its buffer.
  struct Span {
    std::size_t buffer;
    std::uint64_t at, stride, count, of_buffer;
  };

  static const json& object(const json& value, const std::string& where) {
    if (!value.is_object()) throw GltfFault{where + " is no JSON object"};
    return value;
  }

  static const json& list(const json& owner, const char* key) {
    static const json kNone = json::array();
    const auto found = owner.find(key);
    if (found == owner.end()) return kNone;
    if (!found->is_array()) throw GltfFault{"its " + std::string(key) + " are no list"};
    return *found;
  }

  const json& entry(const char* key, std::uint64_t index) const {
    const json& all = list(gltf_, key);
    if (index >= all.size())
      throw GltfFault{"names " + place(key, index) + ", and there are " +
                      std::to_string(all.size())};
    return object(all[index], place(key, index));
  }

  static std::uint64_t whole_number(const json& value, const std::string& what) {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() > kMostOfGltf)
      throw GltfFault{what + " is no whole number from 0 to 2^32 - 1"};
    return value.get<std::uint64_t>();
  }

  static std::uint64_t whole(const json& owner, const char* key, const std::string& where,
                             std::optional<std::uint64_t> otherwise = {}) {
    const auto found = owner.find(key);
    if (found == owner.end() && otherwise) return *otherwise;
    if (found == owner.end()) throw GltfFault{where + " has no " + key};
    return whole_number(*found, where + ": " + key);
  }

  /// Empty: there are none.
  static std::vector<double> numbers(const json& owner, const char* key, std::size_t count,
                                     const std::string& where) {
    if (!owner.contains(key)) return {};
    const json& all = list(owner, key);
    std::vector<double> out;
    for (const json& one : all)
      if (one.is_number()) out.push_back(one.get<double>());
    if (out.size() != count || all.size() != count)
      throw GltfFault{where + ": " + key + " is not " + std::to_string(count) + " numbers"};
    return out;
  }

  void check_version() const {
    const auto asset = gltf_.find("asset");
    if (asset == gltf_.end() || !asset->is_object() || !asset->contains("version") ||
        !(*asset)["version"].is_string())
      throw GltfFault{"is no glTF: it does not say of which version it is"};
    const auto version = (*asset)["version"].get<std::string>();
    if (!version.starts_with("2."))
      throw GltfFault{"is glTF of version " + in_quotes(version) + "; export it as 2.0"};
  }

  void check_extensions() const {
    for (const json& one : list(gltf_, "extensionsRequired")) {
      const std::string name = one.is_string() ? one.get<std::string>() : one.dump();
      if (std::find(kKnownExtensions.begin(), kKnownExtensions.end(), name) ==
              kKnownExtensions.end() &&
          std::none_of(kKnownKinds.begin(), kKnownKinds.end(),
                       [&](std::string_view kind) { return name.starts_with(kind); }))
        throw GltfFault{"requires the extension " + in_quotes(name) +
                        ", which is not read; export it without"};
    }
  }

  void check_names(const json& owner, const char* key, const std::string& where) const {
    for (const json& one : list(owner, key)) entry("nodes", whole_number(one, where + ": " + key));
  }

  static void check_weights(const json& owner, const std::string& where) {
    for (const json& weight : list(owner, "weights"))
      if (!weight.is_number() || weight.get<double>() != 0.0)
        throw GltfFault{where + " is bent by weights, which are not applied; export it bent"};
  }

  void check_nesting() const {
    std::vector<std::vector<std::size_t>> holds;
    for (const json& node : list(gltf_, "nodes")) {
      holds.emplace_back();
      for (const json& child : list(node, "children")) holds.back().push_back(child);
    }
    if (const std::string wrong = wrong_with_nesting(holds, "nodes"); !wrong.empty())
      throw GltfFault{wrong};
  }

  void check_node(const json& node, const std::string& where) const {
    numbers(node, "translation", 3, where);
    numbers(node, "scale", 3, where);
    double length = 0.0;
    const std::vector<double> rotation = numbers(node, "rotation", 4, where);
    for (const double x : rotation) length += x * x;
    length = std::sqrt(length);
    if (!rotation.empty() && !(std::abs(length - 1.0) <= kRotationSlack))
      throw GltfFault{where + " has a rotation of length " + std::to_string(length) +
                      ", which must be 1"};
    const std::vector<double> m = numbers(node, "matrix", 16, where);
    if (!m.empty() && (m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] != 1.0))
      throw GltfFault{where + " has a matrix with a perspective"};
    if (!m.empty() && (!rotation.empty() || node.contains("translation") || node.contains("scale")))
      throw GltfFault{where + " has a matrix and another placement; keep one"};
    if (node.contains("mesh")) entry("meshes", whole(node, "mesh", where));
    check_names(node, "children", where);
    check_weights(node, where);
  }

  void check_primitive(const json& primitive, const std::string& where) {
    // Modes of the format: from 0, points, to 6, a fan of triangles.
    constexpr std::uint64_t kTriangles = 4, kTriangleFan = 6;
    const std::uint64_t mode = whole(primitive, "mode", where, kTriangles);
    if (mode > kTriangleFan) throw GltfFault{where + " is of no kind that there is"};
    const auto more = primitive.find("extensions");
    if (more != primitive.end() && more->contains("KHR_draco_mesh_compression")) return;
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end()) throw GltfFault{where + " has no attributes"};
    const std::uint64_t at = whole(object(*attributes, where), "POSITION", where);
    const json& positions = entry("accessors", at);
    if (positions.value("type", json()) != "VEC3" ||
        positions.value("componentType", json()) != 5126)
      throw GltfFault{where + " has positions that are not three floats, which are not read"};
    span_of(positions, place("accessors", at), 12);
    const std::uint64_t vertices = whole(positions, "count", place("accessors", at));
    const std::uint64_t corners =
        primitive.contains("indices")
            ? checked_indices(whole(primitive, "indices", where), vertices, where)
            : vertices;
    if (mode == kTriangles && corners % 3 != 0)
      throw GltfFault{where + " has " + std::to_string(corners) +
                      " corners, which make no whole triangles"};
  }

  std::uint64_t checked_indices(std::uint64_t index, std::uint64_t vertices,
                                const std::string& where) {
    const json& indices = entry("accessors", index);
    const std::string name = place("accessors", index);
    const std::uint64_t type = whole(indices, "componentType", name);
    const unsigned size = type == 5121 ? 1 : type == 5123 ? 2 : type == 5125 ? 4 : 0;
    if (size == 0 || indices.value("type", json()) != "SCALAR" || indices.contains("sparse"))
      throw GltfFault{name + " are no indices, which are plain whole numbers"};
    const auto span = span_of(indices, name, size);
    const std::string_view bytes =
        buffers_.bytes(span->buffer, entry("buffers", span->buffer), span->of_buffer);
    for (std::uint64_t i = 0; i < span->count; ++i)
      if (const std::uint64_t vertex = little_number(bytes, span->at + i * span->stride, size);
          vertex >= vertices)
        throw GltfFault{where + " names vertex " + std::to_string(vertex) + " of " +
                        std::to_string(vertices)};
    return span->count;
  }

  /// Nothing: all of it is in its sparse part.
  std::optional<Span> span_of(const json& accessor, const std::string& where,
                              std::uint64_t size) const {
    if (!accessor.contains("bufferView") && accessor.contains("sparse")) return {};
    const std::uint64_t in = whole(accessor, "bufferView", where);
    const json& view = entry("bufferViews", in);
    const std::string view_name = place("bufferViews", in);
    const std::uint64_t buffer = whole(view, "buffer", view_name);
    const std::uint64_t of_buffer =
        whole(entry("buffers", buffer), "byteLength", place("buffers", buffer));
    const std::uint64_t view_at = whole(view, "byteOffset", view_name, 0);
    const std::uint64_t view_size = whole(view, "byteLength", view_name);
    if (view_at + view_size > of_buffer)
      throw GltfFault{view_name + " reaches beyond its buffer of " + std::to_string(of_buffer) +
                      " bytes"};
    const std::uint64_t given = whole(view, "byteStride", view_name, 0);
    const std::uint64_t stride = given == 0 ? size : given;
    if (stride < size) throw GltfFault{view_name + " has a stride that is too short"};
    const std::uint64_t count = whole(accessor, "count", where);
    const std::uint64_t at = whole(accessor, "byteOffset", where, 0);
    if (count > 0 && at + (count - 1) * stride + size > view_size)
      throw GltfFault{where + " reaches beyond its view of " + std::to_string(view_size) +
                      " bytes"};
    return Span{buffer, view_at + at, stride, count, of_buffer};
  }

  const json& gltf_;
  GltfBuffers& buffers_;
};

}  // namespace

std::string wrong_with_gltf(std::string_view bytes, bool binary,
                            const std::filesystem::path& folder, FolderFiles& files) try {
  const GltfParts parts = parts_of_gltf(bytes, binary);
  const json gltf = parsed_gltf(parts.text);
  GltfBuffers buffers(parts.binary, folder, files);
  GltfCheck(gltf, buffers).check();
  return {};
} catch (const GltfFault& fault) {
  return fault.text;
} catch (const json::exception& error) {
  return "is no glTF: " + std::string(error.what());
}

}  // namespace mortise
