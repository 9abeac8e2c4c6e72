#pragma once
#include <cstddef>
#include <filesystem>
#include <vector>

#include "common/io/step/importer/step_tree.h"

namespace mortise {

/// One STEP file, and what is said of it.
class StepAnswers {
 public:
  /// The document of the file, or its refusal, as bytes.
  std::vector<std::byte> document(const std::filesystem::path& file);

  /// Answers to the queries that stand in an open file, of the document's parts; empty when they
  /// cannot be read.
  std::vector<std::byte> commons(int queries) const;

 private:
  StepDocument read(const std::filesystem::path& file);

  StepTree tree_;
};

}  // namespace mortise
