#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/io/step/step_text.h"

namespace mortise {

/// Levels of a tree of products; the library goes down them by recursion.
inline constexpr std::size_t kMostStepLevels = 200;

/// Why a file is not to be read, as far as its text says so: a tree that is too deep, too large or
/// holds itself, a part that is mirrored or scaled in a way that the library passes over. Empty:
/// nothing. Cheap, so it stands before the library.
std::string step_refusal(const StepText& text);

/// Places in assemblies (NEXT_ASSEMBLY_USAGE_OCCURRENCE) that mirror or scale in a way that the
/// library passes over, and why each is to be left out.
std::map<int, std::string> step_left_out(const StepText& text);

/// What the text alone says is missing: references to entities that are not in the file.
std::vector<std::string> step_missing(const StepText& text);

/// A point or a direction with more numbers than space has, of which the library takes the first.
std::vector<std::string> step_crowded_points(const StepText& text);

/// How many places in assemblies the file states.
std::size_t step_places(const StepText& text);

/// Ends the one note of the importer that tells of nothing lost: names and annotations.
inline constexpr std::string_view kWithoutFaces = " have no faces and were left out";

/// "line 12: #34"
std::string step_place(const StepText& text, int label);

}  // namespace mortise
