#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "common/geometry/given_part.h"
#include "common/io/step/step_document.h"

namespace mortise {

/// Faces of one part; a band counts them in 16 bits.
inline constexpr std::size_t kMostPartFaces = 50'000;

/// A part of a STEP file as the scene takes it, and where its faces went.
struct StepPartGiven {
  std::shared_ptr<const GivenPart> part;
  std::vector<std::int32_t> feature_of_face;  ///< by face of the file; -1: freeform or no triangles
};

/// Faces of one surface (round faces come split in up to four) become one feature: with the same
/// axis, size and side, and lengths along the axis that meet. Features are named as recognized ones
/// are (bore_1, shaft_1, cone_1, ...), in an order that comes from their geometry alone, so that
/// faces renumbered by another export keep their names.
/// `group_of_face`: planes of different groups stay apart, because something else is stated of
/// them; empty: all are of one group.
StepPartGiven given_part(const StepPart& part, const std::string& file,
                         const std::vector<std::uint32_t>& group_of_face = {});

/// Faces of a part of which the same statements speak are of one group.
std::vector<std::uint32_t> groups_of_faces(const StepDocument& document, std::uint32_t part);

/// Pairs of instances whose boxes meet; each is to be judged.
inline constexpr std::size_t kMostStepPairs = 2'000'000;
/// Has it more than kMostStepPairs? An assembly has some ten of each part; a file that says little
/// and puts everything into one place has the square of its parts.
bool is_crowded(const StepDocument& document);

}  // namespace mortise
