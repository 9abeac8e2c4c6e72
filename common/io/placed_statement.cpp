#include "common/io/placed_statement.h"

namespace mortise {
namespace {

std::string said(const PlacedStatement& placed) {
  const auto um = [](double mm) { return size_text(mm * 1e3); };
  const Interval& offset = placed.statement.offset_mm;
  const std::string line =
      placed.at.line > 0 ? " (line " + std::to_string(placed.at.line) + ")" : "";
  return placed.statement.source + line + " wants the surface " + um(offset.lo) + " to " +
         um(offset.hi) + " µm outside the modelled one";
}

bool has_size(const Surface& surface) {
  return surface.kind == SurfaceKind::kCylinder || surface.kind == SurfaceKind::kSphere;
}

}  // namespace

Result<PlacedStatement> both_hold(const PlacedStatement& a, const PlacedStatement& b) {
  const std::optional<FaceStatement> both = both_hold(a.statement, b.statement);
  if (!both)
    return fail(Code::kInvalidInput,
                said(a) + ", " + said(b) + "; no surface satisfies both, drop one");
  const bool of_a = both->source == a.statement.source && both->source != b.statement.source;
  return PlacedStatement{*both, of_a ? a.at : b.at};
}

Result<PlacedStatement> statement_of_feature(const Scenario::FeatureSpec& declared,
                                             const Feature& feature, const PlacedStatement& part) {
  PlacedStatement own{{}, declared.at};
  if (!declared.iso_class.empty()) {
    Result<FaceStatement> size = iso_statement(declared.iso_class, declared.nominal_mm,
                                               declared.surface, feature.residual_mm);
    if (!size) return size.error();
    own.statement = std::move(size).value();
  } else if (declared.tolerance) {
    own = {{declared.tolerance->offset_mm, declared.tolerance->text}, declared.tolerance->at};
  }
  if (declared.position_mm > 0.0 && !has_size(declared.surface))
    return fail(Code::kInvalidInput,
                "position needs a feature of size (cylinder or sphere); use profile");
  own.statement.position_mm = declared.position_mm;
  return both_hold(part, own);
}

FaceStatement for_band(const PlacedStatement& placed) { return with_position(placed.statement); }

std::vector<FaceStatement> for_band(const std::vector<PlacedStatement>& placed) {
  std::vector<FaceStatement> statements;
  for (const PlacedStatement& p : placed) statements.push_back(for_band(p));
  return statements;
}

}  // namespace mortise
