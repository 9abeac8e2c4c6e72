#pragma once
#include <cstddef>
#include <filesystem>
#include <vector>

namespace mortise {

/// The document of a STEP file, or its refusal, as bytes.
std::vector<std::byte> answer_document(const std::filesystem::path& file);

/// Answers to the queries that stand in an open file; empty when they cannot be read.
std::vector<std::byte> answer_commons(const std::filesystem::path& file, int queries);

}  // namespace mortise
