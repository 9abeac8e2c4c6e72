#pragma once
#include <map>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/feature.h"
#include "common/geometry/mesh.h"

namespace mortise {

/// A part with known exact answers: a closed mesh with every curved corner on the true surface, and
/// the features that it stands for (names are those that scenarios use; triangles are filled in by
/// name later).
struct GeneratedPart {
  TriangleMesh mesh;
  std::vector<Feature> features;
};

struct GeneratorInfo {
  std::string name, what;
  struct Parameter {
    std::string name, what;
    double fallback;
    double least;
    double most;
  };
  std::vector<Parameter> parameters;
};

const std::vector<GeneratorInfo>& generators();

/// Lengths mm, angles rad, counts whole. Unknown generator or parameter, or a value out of range:
/// an error that lists the known ones.
Result<GeneratedPart> generate(const std::string& generator,
                               const std::map<std::string, double>& parameters);

}  // namespace mortise
