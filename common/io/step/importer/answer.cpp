#include "common/io/step/importer/answer.h"

#include <unistd.h>
#include <Standard_Failure.hxx>

#include <array>
#include <new>

#include "common/io/step/importer/common_volume.h"
#include "common/io/step/importer/mesh_part.h"
#include "common/io/step/importer/pmi.h"
#include "common/io/step/importer/step_tree.h"

namespace mortise {
namespace {

constexpr unsigned kSecondsEach = 10;  // of one Boolean operation

StepDocument document_of(const std::filesystem::path& file) {
  StepDocument document;
  StepTree tree;
  read_step_tree(file, tree);
  document.refusal = tree.refusal;
  if (!document.refusal.empty()) return document;
  document.instances = std::move(tree.instances);
  document.not_solid = std::move(tree.not_solid);
  document.notes = std::move(tree.notes);
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < tree.solids.size(); ++i) {
    StepPart part = mesh_part(tree.solids[i], {});
    part.name = tree.parts[i].name;
    part.loose_faces = tree.parts[i].loose_faces;
    part.mirrored = tree.parts[i].mirrored;
    triangles += part.mesh.triangles.size();
    if (triangles > kMostStepTriangles) {
      StepDocument refused;
      refused.refusal = "it needs more than " + std::to_string(kMostStepTriangles) + " triangles";
      return refused;
    }
    document.parts.push_back(std::move(part));
  }
  read_pmi(file, tree, document);
  return document;
}

std::vector<std::byte> refuse(const std::string& why) {
  StepDocument document;
  document.refusal = why;
  return encode(document);
}

std::vector<std::byte> read_all(int file) {
  std::vector<std::byte> bytes;
  std::array<std::byte, 4096> piece;
  for (ssize_t n; (n = read(file, piece.data(), piece.size())) > 0;)
    bytes.insert(bytes.end(), piece.begin(), piece.begin() + n);
  return bytes;
}

}  // namespace

std::vector<std::byte> answer_document(const std::filesystem::path& file) {
  try {
    return encode(document_of(file));
  } catch (const std::bad_alloc&) {
    return refuse("std::bad_alloc");
  } catch (const Standard_Failure& failure) {
    return refuse(std::string("the reader failed on it (") + failure.DynamicType()->Name() +
                  "); export it again from CAD");
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}

std::vector<std::byte> answer_commons(const std::filesystem::path& file, int queries) {
  const auto asked = decode_step_queries(read_all(queries));
  if (!asked) return {};
  try {
    StepTree tree;
    read_step_tree(file, tree);
    return encode(std::span<const StepCommon>(common_volumes(tree, *asked, kSecondsEach)));
  } catch (...) {
    return {};
  }
}

}  // namespace mortise
