#include "common/io/step/importer/answer.h"

#include <unistd.h>
#include <Standard_Failure.hxx>

#include <array>
#include <new>

#include "common/io/step/importer/common_volume.h"
#include "common/io/step/importer/mesh_together.h"
#include "common/io/step/importer/pmi.h"

namespace mortise {
namespace {

// Of one Boolean operation; most take some hundredths of a second.
constexpr unsigned kSecondsEach = 10;

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

StepDocument StepAnswers::read(const std::filesystem::path& file) {
  StepDocument document;
  read_step_tree(file, tree_);
  document.refusal = tree_.refusal;
  if (!document.refusal.empty()) return document;
  document.instances = std::move(tree_.instances);
  document.not_solid = std::move(tree_.not_solid);
  document.notes = std::move(tree_.notes);
  document.parts = mesh_together(tree_.solids, {});
  if (document.parts.empty()) {
    StepDocument refused;
    refused.refusal = "it needs more than " + std::to_string(kMostStepTriangles) + " triangles";
    return refused;
  }
  for (std::size_t i = 0; i < document.parts.size(); ++i) {
    StepPart& part = document.parts[i];
    part.name = tree_.parts[i].name;
    part.loose_faces = tree_.parts[i].loose_faces;
    part.mirrored = tree_.parts[i].mirrored;
  }
  read_pmi(tree_, document);
  return document;
}

std::vector<std::byte> StepAnswers::document(const std::filesystem::path& file) {
  try {
    return encode(read(file));
  } catch (const std::bad_alloc&) {
    return refuse("std::bad_alloc");
  } catch (const Standard_Failure& failure) {
    return refuse(std::string("the reader failed on it (") + failure.DynamicType()->Name() +
                  "); export it again from CAD");
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}

std::vector<std::byte> StepAnswers::commons(int queries) const {
  const auto asked = decode_step_queries(read_all(queries));
  if (!asked) return {};
  try {
    return encode(
        std::span<const StepCommon>(common_volumes(tree_, *asked, {kSecondsEach, kCommons_s})));
  } catch (...) {
    return {};
  }
}

}  // namespace mortise
