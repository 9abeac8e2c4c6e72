#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/evaluation/iso286.h"
#include "common/geometry/feature.h"
#include "common/math/interval.h"

namespace mortise {

/// How a position zone grows with the size: not at all (RFS), as the size departs from its maximum
/// material (the largest shaft, the smallest hole), or from its least material.
enum class MaterialCondition : std::uint8_t { kRegardless = 0, kMaximum, kLeast };

/// Diameter of the zone in which the real axis or centre of a feature of size may lie; 0: at its
/// modelled place.
struct Position {
  double zone_mm = 0.0;
  MaterialCondition condition = MaterialCondition::kRegardless;
  Interval size_offset_mm = {};  ///< of the limits of size that the condition counts from
};

/// A statement about a face: where its real surface may lie, outward of the modelled surface, and
/// its source ("Ø20 H7", "±0.05", "" without a statement of size or profile).
struct FaceStatement {
  Interval offset_mm;
  std::string source;
  Position position = {};  ///< part of offset_mm only after with_position
  /// A size in a system of limits is that of a round (or of a width): what recognition only took
  /// for round is round by it.
  bool is_size = false;
};

/// Two statements about one face hold together: the offsets that satisfy both. The source is that
/// of the tighter one (of b when they are equal), or of both when each bounds one end. Nothing when
/// they exclude each other by more than a nanometre.
std::optional<FaceStatement> both_hold(const FaceStatement& a, const FaceStatement& b);

/// The statement as a band needs it: a feature of size whose axis may lie anywhere in a zone of
/// diameter T moves its surface by up to T/2 either way, in addition to its size (README, section
/// 2). Under a material condition the zone grows with the size, so that one end stays at the
/// virtual condition: at maximum material the outer end (pin MMC + T, hole MMC - T), at least
/// material the inner one. Once a statement: its position stays, to be told.
FaceStatement with_position(const FaceStatement& statement);

/// Limits of size as offsets of the modelled surface of radius R (README, section 2):
/// shaft [(D+ei)/2 - R, (D+es)/2 - R], hole, outward of its material, [R - (D+ES)/2, R - (D+EI)/2].
Interval size_offset_mm(const SizeLimits& limits, double modelled_radius_mm);

/// One feature under an ISO 286 class. An error when the surface has no size (only cylinders and
/// spheres have), when a hole class is put on a shaft or the reverse, or when the modelled size is
/// neither the nominal one nor within the limits, up to residual_mm of the radius. nominal_mm 0:
/// twice the modelled radius.
Result<FaceStatement> iso_statement(const std::string& code, double nominal_mm,
                                    const Surface& surface, double residual_mm);

/// Two parallel planes as one feature of size: the width of a key when they face away from each
/// other (small letters), of a slot when they face each other (capitals). Each plane takes half of
/// the deviations, the middle plane stays where it is modelled. An error when they are not parallel
/// and opposite, and otherwise as for iso_statement. nominal_mm 0: the modelled width.
Result<FaceStatement> width_statement(const std::string& code, double nominal_mm,
                                      const Surface& plane, const Surface& opposite,
                                      double residual_mm);

/// A fit between two features, one hole and one shaft, in either order. nominal_mm 0: the modelled
/// diameter when both agree, else an error that asks for it.
struct FitStatement {
  FaceStatement a, b;
  Fit fit;
  double nominal_mm = 0.0;
  std::string text;  ///< "Ø20 H7/g6"
};
struct FitSide {
  const Surface* surface = nullptr;
  double residual_mm = 0.0;
  std::string name;  ///< "plate.bore", for messages
};
Result<FitStatement> fit_statement(const std::string& code, double nominal_mm, const FitSide& a,
                                   const FitSide& b);

/// "20", "8.1", "25.4": a size without trailing zeros, for sentences.
std::string size_text(double mm);

}  // namespace mortise
