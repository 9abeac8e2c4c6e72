#pragma once
#include <map>
#include <string>
#include <vector>

#include "common/generators/generators.h"

namespace mortise {

/// Parameters of one part, complete and each within its own range.
class Values {
 public:
  explicit Values(std::map<std::string, double> values) : values_(std::move(values)) {}
  double operator[](const std::string& name) const { return values_.at(name); }
  int count(const std::string& name) const { return static_cast<int>(values_.at(name)); }

 private:
  std::map<std::string, double> values_;
};

/// A kind of part: its name and how it is made. make() checks what ranges cannot express.
struct Family {
  GeneratorInfo info;
  Result<GeneratedPart> (*make)(const Values& values);
};

/// Parameters that many kinds have.
inline GeneratorInfo::Parameter length(const std::string& name, const std::string& what,
                                       double fallback_mm, double least_mm = 0.01) {
  return {name + "_mm", what, fallback_mm, least_mm, 10'000.0};
}
inline GeneratorInfo::Parameter facets_parameter(double fallback = 32) {
  return {"facets", "corners of every full circle", fallback, 3, 4096};
}
inline GeneratorInfo::Parameter phase_parameter() {
  return {"phase_rad", "angle of the first corner of every circle", 0.0, -6.3, 6.3};
}

inline Error impossible(const std::string& kind, const std::string& why) {
  return fail(Code::kInvalidInput, "generator " + kind + ": " + why);
}

}  // namespace mortise
