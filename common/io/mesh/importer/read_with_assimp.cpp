#include "common/io/mesh/importer/read_with_assimp.h"

#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <system_error>
#include <vector>

#include "common/base/in_quotes.h"
#include "common/io/mesh/importer/dae_check.h"
#include "common/io/mesh/importer/folder_files.h"
#include "common/io/mesh/importer/gltf_check.h"
#include "common/io/mesh/importer/obj_lines.h"
#include "common/io/mesh/importer/ply_header.h"
#include "common/io/mesh/importer/stl_dialect.h"
#include "common/io/mesh/importer/written_digits.h"

namespace mortise {
namespace {

/// Leaves only the readers that name the extension: the content of a file must not choose the
/// parser.
void keep_reader_of(const std::string& extension, Assimp::Importer& importer) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    std::istringstream known(importer.GetImporterInfo(i)->mFileExtensions);
    const bool wanted = std::find(std::istream_iterator<std::string>(known), {},
                                  extension.substr(1)) != std::istream_iterator<std::string>();
    if (!wanted) importer.UnregisterLoader(importer.GetImporter(i));
  }
}

/// Metres per unit that a DAE states, 1 when it states none.
double stated_metres(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text(1 << 16, '\0');  // <asset> stands at the top
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  const std::size_t unit = text.find("<unit");
  const std::size_t end = text.find('>', unit);
  const std::size_t meter = text.find("meter", unit);
  if (unit == std::string::npos || end == std::string::npos || meter > end) return 1.0;
  const std::size_t quote = text.find_first_of("\"'", meter);
  if (quote > end) return 1.0;
  const double metres = std::strtod(text.c_str() + quote + 1, nullptr);
  return std::isfinite(metres) && metres > 0.0 ? metres : 1.0;
}

/// A row-major 3x4 matrix in double: nothing is rounded to float again on the way.
struct Affine {
  double m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  bool identity = true;
  double entry_ulp = 0.0;  ///< relative rounding that the matrices of the file brought in
};

Affine operator*(const Affine& a, const aiMatrix4x4& b) {
  if (b.IsIdentity() && a.identity) return a;
  Affine c;
  c.identity = false;
  c.entry_ulp = a.entry_ulp + 0.5 * static_cast<double>(std::numeric_limits<float>::epsilon());
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) {
      c.m[i][j] = j == 3 ? a.m[i][3] : 0.0;
      for (unsigned k = 0; k < 3; ++k)
        c.m[i][j] += a.m[i][k] * static_cast<double>(b[k][static_cast<unsigned>(j)]);
    }
  return c;
}

/// assimp writes the unit of a DAE into the scale of the root node; taken out again, so that the
/// scenario's unit means the same for every format.
void undo_unit(aiNode& root, double metres) {
  const auto scale = static_cast<float>(metres);
  if (scale == 1.0F) return;
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 3; ++j) root.mTransformation[i][j] /= scale;
}

std::string check(const aiMesh* mesh) {
  if (mesh == nullptr) return "a mesh is missing";
  if (mesh->mNumVertices > 0 && mesh->mVertices == nullptr) return "a mesh has no vertices";
  for (unsigned f = 0; f < mesh->mNumFaces; ++f) {
    const aiFace& face = mesh->mFaces[f];
    if (face.mNumIndices > 0 && face.mIndices == nullptr) return "a face has no corners";
    for (unsigned k = 0; k < face.mNumIndices; ++k)
      if (face.mIndices[k] >= mesh->mNumVertices)
        return "face " + std::to_string(f) + " names vertex " + std::to_string(face.mIndices[k]) +
               " of " + std::to_string(mesh->mNumVertices);
  }
  for (unsigned v = 0; v < mesh->mNumVertices; ++v)
    for (unsigned k = 0; k < 3; ++k)
      if (!std::isfinite(mesh->mVertices[v][k]))
        return "vertex " + std::to_string(v) + " has a coordinate that is not a number";
  return {};
}

/// A mirrored placement turns the surface inside out.
bool mirrors(const Affine& X) {
  const auto& m = X.m;
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
         0.0;
}

/// The places of a mesh, with all digits of its file where they are found, and how far they may be
/// off.
struct Places {
  std::vector<Triple> at;
  double largest = 0.0, quantum = 0.0;
};

Places places_of(const aiMesh& mesh, const WrittenDigits& digits) {
  Places places;
  places.at.resize(mesh.mNumVertices);
  bool all = true;
  for (unsigned v = 0; v < mesh.mNumVertices && all; ++v) {
    const aiVector3D& x = mesh.mVertices[v];
    const Triple* written = digits.find(x.x, x.y, x.z);
    all = written != nullptr;
    if (all) places.at[v] = *written;
  }
  if (!all)
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& x = mesh.mVertices[v];
      places.at[v] = {x.x, x.y, x.z};
    }
  for (const Triple& triple : places.at)
    for (const double x : triple) places.largest = std::max(places.largest, std::abs(x));
  // What assimp makes of a text is off by up to two ulps.
  constexpr double kOfDoubles = 1e-15, kOfFloats = 1.8e-7;
  places.quantum = written_quantum(places.at, all ? kOfDoubles : kOfFloats);
  if (!all) places.quantum = std::max(places.quantum, half_ulp(places.largest));
  return places;
}

/// Appends one placed mesh.
void append(const aiMesh& mesh, const Places& places, const Affine& X, RawSoup& soup) {
  double row = 1.0;
  for (const auto& r : X.m) row = std::max(row, std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2]));
  double quantum = row * places.quantum;
  if (!X.identity) {
    for (const auto& r : X.m)
      quantum = std::max(
          quantum, row * places.quantum + X.entry_ulp * (row * places.largest + std::abs(r[3])));
  }
  soup.quantum = std::max(soup.quantum, quantum);
  const bool turned = mirrors(X);
  soup.raw_vertices += mesh.mNumVertices;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) {
      ++soup.points_and_lines;
      continue;
    }
    for (unsigned k = 0; k < 3; ++k) {
      const Triple& x = places.at[face.mIndices[turned ? 2 - k : k]];
      for (std::size_t i = 0; i < 3; ++i)
        soup.coordinates.push_back(
            X.identity ? x[i] : X.m[i][0] * x[0] + X.m[i][1] * x[1] + X.m[i][2] * x[2] + X.m[i][3]);
    }
  }
}

/// Walks all nodes without recursion. Empty text on success.
std::string place_all(const aiScene& scene, const WrittenDigits& digits, RawSoup& soup) {
  std::map<unsigned, Places> known;
  struct Visit {
    const aiNode* node;
    Affine X;
  };
  std::vector<Visit> open{{scene.mRootNode, Affine{}}};
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    if (visit.node == nullptr) return "a node of the scene is missing";
    const Affine X = visit.X * visit.node->mTransformation;
    for (unsigned i = 0; i < visit.node->mNumMeshes; ++i) {
      if (visit.node->mMeshes[i] >= scene.mNumMeshes)
        return "a node names a mesh that is not there";
      const aiMesh& mesh = *scene.mMeshes[visit.node->mMeshes[i]];
      if (soup.coordinates.size() / 9 + mesh.mNumFaces > kMostRawTriangles)
        return "more than " + std::to_string(kMostRawTriangles) + " triangles";
      const auto [places, fresh] = known.try_emplace(visit.node->mMeshes[i]);
      if (fresh) places->second = places_of(mesh, digits);
      append(mesh, places->second, X, soup);
    }
    for (unsigned i = visit.node->mNumChildren; i-- > 0;)
      open.push_back({visit.node->mChildren[i], X});
  }
  return {};
}

Result<std::string> bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in)
    return fail(Code::kRuntime, "cannot be read: " + std::generic_category().message(errno) +
                                    "; check who may read it");
  return std::string(std::istreambuf_iterator<char>(in), {});
}

/// What assimp is to read in place of the file.
struct Text {
  std::optional<std::string> bytes;  ///< none: the file itself
  std::string note;
};

template <class Strict>
Result<Text> text_of(Result<Strict> strict) {
  if (!strict) return strict.error();
  return Text{std::move(strict->bytes), std::move(strict->note)};
}

/// Refuses what assimp would read as something else.
Result<Text> checked_file(const std::filesystem::path& file, const std::string& extension,
                          FolderFiles& files) {
  const Result<std::string> bytes = bytes_of(file);
  if (!bytes) return bytes.error();
  if (extension == ".stl") return text_of(strict_stl(*bytes));
  if (extension == ".ply") return text_of(strict_ply(*bytes));
  if (extension == ".obj") {
    Result<std::string> text = strict_obj(*bytes);
    if (!text) return text.error();
    return Text{std::move(*text), {}};
  }
  if (extension == ".gltf" || extension == ".glb")
    if (const std::string wrong =
            wrong_with_gltf(*bytes, extension == ".glb", file.parent_path(), files);
        !wrong.empty())
      return fail(Code::kInvalidInput, wrong);
  if (extension == ".dae")
    if (const std::string wrong = wrong_with_dae(*bytes); !wrong.empty())
      return fail(Code::kInvalidInput, wrong);
  return Text{};
}

RawSoup refuse(const std::string& why) {
  RawSoup soup;
  soup.refusal = why;
  return soup;
}

}  // namespace

RawSoup read_with_assimp(const std::filesystem::path& file, const std::string& extension) {
  // 1. Read, with nothing done to it: assimp's own steps trust the indices of the file.
  Assimp::Importer importer;
  auto* const files = new FolderFiles(file);
  importer.SetIOHandler(files);  // which owns it
  keep_reader_of(extension, importer);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const Result<Text> text = checked_file(file, extension, *files);
  if (!text) return refuse(text.error().text);
  if (!text->bytes)
    importer.ReadFile(file.string(), 0);
  else
    importer.ReadFileFromMemory(text->bytes->data(), text->bytes->size(), 0, extension.c_str() + 1);
  const aiScene* scene = importer.GetScene();
  if (scene == nullptr && !files->refused().empty())
    return refuse("names " + in_quotes(files->refused()) +
                  ", which lies outside of its folder; put it beside the mesh");
  if (scene == nullptr) return refuse(importer.GetErrorString());
  for (unsigned i = 0; i < scene->mNumMeshes; ++i)
    if (const std::string wrong = check(scene->mMeshes[i]); !wrong.empty()) return refuse(wrong);

  // 2. Polygons to triangles, now that every index is known to be good.
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) return refuse("its polygons are broken");
  for (unsigned i = 0; i < scene->mNumMeshes; ++i)
    if (const std::string wrong = check(scene->mMeshes[i]); !wrong.empty()) return refuse(wrong);

  // 3. Every placed mesh, moved into the frame of the file.
  RawSoup soup;
  soup.note = text->note;
  soup.format = extension.substr(1);
  for (char& c : soup.format) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (extension == ".dae") {
    const double metres = stated_metres(file);
    undo_unit(*const_cast<aiNode*>(scene->mRootNode), metres);
    soup.stated_unit_mm = 1000.0 * metres;
  }
  if (extension == ".gltf" || extension == ".glb") soup.stated_unit_mm = 1000.0;  // by its standard
  if (const std::string wrong =
          place_all(*scene, WrittenDigits(text->bytes.value_or(""), extension), soup);
      !wrong.empty())
    return refuse(wrong);
  return soup;
}

}  // namespace mortise
