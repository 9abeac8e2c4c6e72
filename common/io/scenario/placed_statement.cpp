#include "common/io/scenario/placed_statement.h"

#include <algorithm>

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

Result<PlacedStatement> width_of(const Scenario::FeatureSpec& plane,
                                 const Scenario::FeatureSpec& opposite, double residual_mm) {
  Result<FaceStatement> width = width_statement(plane.iso_class, plane.nominal_mm, plane.surface,
                                                opposite.surface, residual_mm);
  if (!width)
    return fail(width.error().code, "width_to " + opposite.name + ": " + width.error().text);
  return PlacedStatement{std::move(width).value(), plane.at};
}

Result<PlacedStatement> class_of(const Scenario::FeatureSpec& declared,
                                 std::span<const Scenario::FeatureSpec> all, double residual_mm) {
  if (declared.width_to.empty()) {
    Result<FaceStatement> size =
        iso_statement(declared.iso_class, declared.nominal_mm, declared.surface, residual_mm);
    if (!size) return size.error();
    return PlacedStatement{std::move(size).value(), declared.at};
  }
  const auto other = std::find_if(all.begin(), all.end(),
                                  [&](const auto& f) { return f.name == declared.width_to; });
  if (other == all.end())
    return fail(Code::kInvalidInput, "width_to: the part has no feature '" + declared.width_to +
                                         "'; name the opposite plane");
  return width_of(declared, *other, residual_mm);
}

Result<PlacedStatement> own_statement(const Scenario::FeatureSpec& declared,
                                      std::span<const Scenario::FeatureSpec> all,
                                      double residual_mm) {
  PlacedStatement own{{}, declared.at};
  if (!declared.iso_class.empty()) {
    Result<PlacedStatement> size = class_of(declared, all, residual_mm);
    if (!size) return size;
    own = std::move(size).value();
  } else if (declared.tolerance) {
    own = {{declared.tolerance->offset_mm, declared.tolerance->text}, declared.tolerance->at};
  }
  if (declared.position.zone_mm <= 0.0) return own;
  if (!has_size(declared.surface))
    return fail(Code::kInvalidInput,
                "position needs a feature of size (cylinder or sphere); use profile");
  if (declared.position.condition != MaterialCondition::kRegardless && own.statement.source.empty())
    return fail(Code::kInvalidInput,
                "position at mmc or lmc counts from the limits of size; add iso: or tolerance:");
  own.statement.position = declared.position;
  own.statement.position.size_offset_mm = own.statement.offset_mm;
  return own;
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
                                             std::span<const Scenario::FeatureSpec> all,
                                             double residual_mm, const PlacedStatement& part) {
  Result<PlacedStatement> statement = own_statement(declared, all, residual_mm);
  for (const Scenario::FeatureSpec& other : all)
    if (statement && !other.width_to.empty() && other.width_to == declared.name) {
      const Result<PlacedStatement> width = width_of(other, declared, residual_mm);
      statement = width ? both_hold(*statement, *width) : width;
    }
  if (!statement) return statement;
  return both_hold(part, *statement);
}

FaceStatement for_band(const PlacedStatement& placed) { return with_position(placed.statement); }

std::vector<FaceStatement> for_band(const std::vector<PlacedStatement>& placed) {
  std::vector<FaceStatement> statements;
  for (const PlacedStatement& p : placed) statements.push_back(for_band(p));
  return statements;
}

}  // namespace mortise
