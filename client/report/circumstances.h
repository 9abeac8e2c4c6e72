#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "client/report/moments.h"
#include "client/report/session_tables.h"
#include "common/math/interval.h"

namespace mortise {

/// Holders, mesh error and fit of two parts in the worst moment of their clash.
struct Circumstances {
  std::string holder_a, holder_b;  ///< names; empty: the part was free
  /// How far the true surface lies outside of the mesh of the face (negative: inside), mm.
  Interval eps_a_mm, eps_b_mm;
  std::string fit;                       ///< of the two faces, "Ø20 H7/g6"; empty: none
  std::optional<Interval> clearance_mm;  ///< of that fit, of the diameter; negative: interference
};
/// Do the tolerances of these two faces ("Ø20 H7", "Ø20 g6") make the fit "Ø20 H7/g6"?
bool is_of_fit(const std::string& fit, const std::string& source_a, const std::string& source_b);
Circumstances circumstances_at(const Moment& moment);

/// Appends them to the table of clashes: holder_a, holder_b, fit, eps_a_lo_mm ... clearance_hi_mm.
/// The cells of clashes that are missing in `known` are null.
void add_circumstances(Table& clashes, const std::map<std::uint64_t, Circumstances>& known);

}  // namespace mortise
