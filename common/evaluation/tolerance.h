#pragma once
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/evaluation/iso286.h"
#include "common/geometry/feature.h"
#include "common/math/interval.h"

namespace mortise {

/// What is stated of a face: where its real surface may lie, outward of the modelled surface, and
/// who says so ("Ø20 H7", "±0.05", "" when nothing is stated of size or profile).
struct FaceStatement {
  Interval offset_mm;
  std::string source;
  /// Diameter of the zone in which the real axis or centre may lie (position, RFS); 0: at its
  /// modelled place. Not part of offset_mm, see with_position.
  double position_mm = 0.0;
};

/// Two statements of one face hold both: the offsets that satisfy both. The source is that of the
/// tighter one (of b when they are alike), or of both when each bounds another end. Nothing when
/// they exclude each other by more than a nanometre.
std::optional<FaceStatement> both_hold(const FaceStatement& a, const FaceStatement& b);

/// The statement as a band needs it: a feature of size whose axis may lie anywhere in a zone of
/// diameter T moves its surface by up to T/2 either way, in addition to its size (ALG 5.2).
FaceStatement with_position(const FaceStatement& statement);

/// Limits of size as offsets of the modelled surface of radius R (collision.md section 4):
/// shaft [(D+ei)/2 - R, (D+es)/2 - R], hole, outward of its material, [R - (D+ES)/2, R - (D+EI)/2].
Interval size_offset_mm(const SizeLimits& limits, double modelled_radius_mm);

/// One feature under an ISO 286 class. An error when the surface has no size (only cylinders and
/// spheres have), when a hole class is put on a shaft or the reverse, or when the modelled size is
/// neither the nominal one nor within the limits, up to residual_mm of the radius. nominal_mm 0:
/// twice the modelled radius.
Result<FaceStatement> iso_statement(const std::string& code, double nominal_mm,
                                    const Surface& surface, double residual_mm);

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
