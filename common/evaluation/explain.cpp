#include "common/evaluation/explain.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>

#include "common/evaluation/open_bracket.h"
#include "common/evaluation/threshold_text.h"
#include "common/geometry/plane_faces.h"
#include "common/messages/length_text.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

bool shown(double mm) { return !reads_as_zero(mm); }

std::string overlap_part(const Interval& delta) {
  if (delta.hi < 0.0) return "gap " + range_text(-delta);
  if (delta.lo < 0.0 && shown(delta.lo))
    return "overlap at most " + length_text(delta.hi) + ", gap at most " + length_text(-delta.lo);
  return "overlap " + range_text({std::fmax(delta.lo, 0.0), delta.hi});
}

// Who set the tolerances of both faces together, and whether that is a fit.
struct Source {
  std::string text;
  bool fit = false;
};

// "Ø20 H7, position Ø0.1 mm" said in two.
struct Said {
  std::string size, position;
};

Said split_position(const std::string& source) {
  const std::size_t at = source.find("position Ø");
  if (at == std::string::npos) return {source, ""};
  const std::string size = source.substr(0, at);
  return {size.ends_with(", ") ? size.substr(0, size.size() - 2) : size, source.substr(at)};
}

// "Ø20 H7" and "Ø20 g6" are "Ø20 H7/g6", "8 N9" and "8 h9" are "8 N9/h9": the hole, a capital
// letter, stands first. Nothing when either is more, or other, than a class.
std::string joined_fit(const std::string& a, const std::string& b) {
  const std::size_t blank = a.find(' ');
  if (blank == std::string::npos || a.compare(0, blank + 1, b, 0, blank + 1) != 0) return {};
  const std::string size = a.substr(0, blank + 1), x = a.substr(blank + 1), y = b.substr(blank + 1);
  const auto is_class = [](const std::string& text) {
    return !text.empty() && std::isalpha(static_cast<unsigned char>(text.front())) != 0 &&
           std::isdigit(static_cast<unsigned char>(text.back())) != 0 &&
           text.find(' ') == std::string::npos;
  };
  if (!is_class(x) || !is_class(y)) return {};
  const bool a_is_hole = x[0] >= 'A' && x[0] <= 'Z';
  return a_is_hole ? size + x + "/" + y : size + y + "/" + x;
}

// What two faces say together.
std::string together(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return a + b;
  return a == b ? "twice " + a : a + " and " + b;
}

Source tolerance_source(const ExplainInput& in) {
  if (in.face_a == nullptr || in.face_b == nullptr) return {in.fit, !in.fit.empty()};
  const Said a = split_position(in.face_a->tolerance_source);
  const Said b = split_position(in.face_b->tolerance_source);
  const std::string fit = joined_fit(a.size, b.size);
  const std::string sizes = fit.empty() ? together(a.size, b.size) : fit;
  return {together(sizes, together(a.position, b.position)), !fit.empty()};
}

std::string signed_term(const std::string& so_far, bool negative, const std::string& term) {
  if (so_far.empty()) return negative ? "-" + term : term;
  return so_far + (negative ? " - " : " + ") + term;
}

// Largest distance of the mesh corners from the surfaces of that grade.
double residual_of(const ExplainInput& in, DeviationGrade grade) {
  double residual_mm = 0.0;
  for (const SurfaceBand::Face* face : {in.face_a, in.face_b})
    if (face != nullptr && face->grade == grade) residual_mm += face->residual_mm;
  return residual_mm;
}

bool estimated(const ExplainInput& in) {
  const auto is = [](const SurfaceBand::Face* face) {
    return face != nullptr && face->grade == DeviationGrade::kEstimated;
  };
  return in.estimated || in.grade == DeviationGrade::kEstimated || is(in.face_a) || is(in.face_b);
}

// One face is nominal; what the other one has besides rounding, its surface says.
bool has_surface(const SurfaceBand::Face* face) { return face != nullptr && face->surface; }

std::string mesh_error_name(const ExplainInput& in) {
  if (estimated(in)) return " estimated";
  switch (in.grade) {
    case DeviationGrade::kPlanar:
    case DeviationGrade::kDeclaredFeature: {
      const double residual_mm = residual_of(in, DeviationGrade::kDeclaredFeature);
      return shown(residual_mm) ? " ±" + length_text(residual_mm) : " exact";
    }
    case DeviationGrade::kDeclaredChord:
      return " by declared chord error";
    case DeviationGrade::kRecognizedFeature:
      return " recognized";
    case DeviationGrade::kNominal:
      return has_surface(in.face_a) || has_surface(in.face_b) ? "" : " of rounding";
    case DeviationGrade::kEstimated:
    case DeviationGrade::kUnknown:
      break;
  }
  return "";
}

// Plane faces lie where their triangles do, but for the rounding of the file: nullopt for others,
// else that rounding of both.
std::optional<double> rounding_of_planes_mm(const ExplainInput& in) {
  if (in.grade != DeviationGrade::kPlanar && in.grade != DeviationGrade::kNominal)
    return std::nullopt;
  double rounding_mm = 0.0;
  for (const SurfaceBand::Face* face : {in.face_a, in.face_b}) {
    if (face == nullptr || face->surface ||
        (face->grade != DeviationGrade::kPlanar && face->grade != DeviationGrade::kNominal))
      return std::nullopt;
    rounding_mm += face->deviation_mm.hi;
  }
  if (estimated(in)) return std::nullopt;
  return rounding_mm;
}

// What a threshold is made of: fake ends at the upper offsets, real begins at the lower ones. A fit
// that leaves room adds clearance.
enum class End { kFake, kReal };
std::string made_of(const ExplainInput& in, End end, bool name_source) {
  const bool fake = end == End::kFake;
  const double threshold_mm = fake ? in.thresholds.fake_below_mm : in.thresholds.real_above_mm;
  const double tolerance_mm = fake ? in.tolerance_mm.hi : in.tolerance_mm.lo;
  // What the tolerance does not explain of the threshold, so that the terms add up to it.
  const double deviation_mm = -threshold_mm - tolerance_mm;
  std::string text;
  const double size_mm = std::fabs(deviation_mm);
  const std::optional<double> rounding_mm = rounding_of_planes_mm(in);
  // Within the bracket of the overlap it is nothing; beyond, edges travel farther than faces.
  const bool is_edge = rounding_mm && size_mm > 2.0 * *rounding_mm;
  if (shown(rounding_mm ? std::max(0.0, size_mm - in.delta_mm.width()) : size_mm))
    text = signed_term(text, deviation_mm > 0.0,
                       is_edge ? "sharp edge " + length_text(size_mm)
                               : "mesh error " + length_text(size_mm) + mesh_error_name(in));
  const Source source = tolerance_source(in);
  if (source.text.empty()) return text;
  const bool interferes = tolerance_mm > 0.0;
  std::string what;
  if (!source.fit)
    what = "tolerance";
  else if (interferes)
    what = fake ? "largest radial interference" : "least radial interference";
  else
    what = fake ? "least radial clearance" : "largest radial clearance";
  return signed_term(text, interferes,
                     what + " " + length_text(std::fabs(tolerance_mm)) +
                         (name_source ? " of " + source.text : ""));
}

// Each threshold that has to do with the class, and what it is made of.
std::string thresholds_part(const ExplainInput& in) {
  const double fake = in.thresholds.fake_below_mm;
  const double real = in.thresholds.real_above_mm;
  if (made_of(in, End::kFake, true).empty() && !shown(fake) && !shown(real)) {
    const bool nominal =
        in.grade == DeviationGrade::kNominal || in.grade == DeviationGrade::kUnknown;
    return nominal ? "nothing declared, the mesh is taken for the surface (nominal)"
                   : "no tolerance declared, mesh error " + length_text(0.0) + " (" +
                         std::string(name_of(in.grade)) + ")";
  }
  const bool is_real = in.collision_class == CollisionClass::kReal;
  const bool is_fake = in.collision_class == CollisionClass::kFake;
  const std::string why_fake = is_real ? "" : made_of(in, End::kFake, true);
  const std::string why_real = is_fake ? "" : made_of(in, End::kReal, why_fake.empty());
  const auto because = [](const std::string& why) { return why.empty() ? "" : " (" + why + ")"; };
  std::string text;
  if (in.fake_known || is_fake) text = fake_text(fake) + because(why_fake);
  if (in.real_known || is_real)
    text += (text.empty() ? "" : ", ") + real_text(real) + because(why_real);
  return text;
}

// Nothing is known but the meshes, and their corners are no closer than that: at an edge by as many
// times more as it travels.
bool within_rounding(const ExplainInput& in) {
  const std::optional<double> rounding_mm = rounding_of_planes_mm(in);
  return in.collision_class == CollisionClass::kPotential && !in.no_inside && !in.at_crack &&
         rounding_mm && tolerance_source(in).text.empty() && in.thresholds.real_above_mm > 0.0 &&
         in.delta_mm.lo <=
             std::min(in.thresholds.real_above_mm, PlaneFaces::kMostTravel * *rounding_mm);
}

// What the verdict rests on where that is less than a declared surface.
std::string grade_note(const ExplainInput& in) {
  if (estimated(in)) return "; mesh error estimated, not guaranteed";
  const auto recognized = [](const SurfaceBand::Face* face) {
    return face != nullptr && face->grade == DeviationGrade::kRecognizedFeature;
  };
  if (recognized(in.face_a) || recognized(in.face_b)) {
    const double residual_mm = residual_of(in, DeviationGrade::kRecognizedFeature);
    return "; surfaces recognized in the mesh, residual " +
           (shown(residual_mm) ? length_text(residual_mm) : std::string("below 0.1 µm"));
  }
  const bool nominal = in.grade == DeviationGrade::kNominal;
  return nominal && !tolerance_source(in).text.empty() ? "; mesh taken for the surface (nominal)"
                                                       : "";
}

std::string conclusion(const ExplainInput& in) {
  const std::string name =
      std::string(name_of(in.collision_class)) + (estimated(in) ? " by estimate" : "");
  switch (in.collision_class) {
    case CollisionClass::kReal:
      return name + ", " + length_text(in.margin_mm) + " beyond";
    case CollisionClass::kFake:
      return name + ", " + length_text(in.margin_mm) + " to spare";
    case CollisionClass::kPotential:
      if (in.no_inside) return name + ", a part is open and has no inside";
      if (in.at_crack) return name + ", a part is open here and its inside not known";
      return name + (in.probability ? ", " + probability_text(*in.probability) : "");
    case CollisionClass::kNone:
      break;
  }
  return name;
}

// The lazy answer: on which side of which threshold, no more.
std::string explain_open_bracket(const ExplainInput& in) {
  const Source source = tolerance_source(in);
  // Planes without a tolerance have nothing to say for themselves.
  const bool plain = source.text.empty() && in.grade == DeviationGrade::kPlanar;
  const std::string of = plain ? ""
                               : " (" + source.text + (source.text.empty() ? "" : ", ") +
                                     "mesh error: " + std::string(name_of(in.grade)) + ")";
  const Interval& delta = in.delta_mm;
  if (in.collision_class == CollisionClass::kFake)
    return "overlap at most " + length_text(delta.hi) + "; " +
           fake_text(in.thresholds.fake_below_mm) + of + ": " + conclusion(in);
  if (in.collision_class == CollisionClass::kPotential && !in.real_known)
    return overlap_part(delta) + of + ": " + conclusion(in);
  const std::string least = delta.lo >= 0.0 ? "overlap at least " + length_text(delta.lo)
                                            : "gap at most " + length_text(-delta.lo);
  return least + "; " + real_text(in.thresholds.real_above_mm) + of + ": " + conclusion(in);
}

}  // namespace

std::string explain(const ExplainInput& in) {
  if (in.no_inside && in.delta_mm.hi > 0.0)
    return "the surfaces cross, but a part is open and has no inside, so the depth is not known: " +
           std::string(name_of(in.collision_class));
  if (in.at_crack && in.delta_mm.hi > 0.0)
    return "a part is open here, so what is inside it is not known: " +
           std::string(name_of(in.collision_class));
  const std::string why = thresholds_part(in);
  std::string text =
      is_open(in.delta_mm)
          ? explain_open_bracket(in)
          : overlap_part(in.delta_mm) + (why.empty() ? "" : "; " + why) + ": " + conclusion(in);
  text += grade_note(in);
  if (within_rounding(in)) text += "; within the rounding of the files";
  if (in.collision_class == CollisionClass::kPotential && in.witnesses_refused > 0)
    text += "; " + std::to_string(in.witnesses_refused) +
            " points taken for inside both are not inside the meshes";
  if (in.capped) text += "; work limit reached, brackets are wide";
  return text;
}

}  // namespace mortise
