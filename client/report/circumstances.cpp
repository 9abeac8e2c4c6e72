#include "client/report/circumstances.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <sstream>

#include "common/evaluation/iso286.h"
#include "common/session/tick/judgement.h"

namespace mortise {
namespace {

std::string holder_of(const World& world, const Part& part) {
  const User* user = part.holder ? world.find(part.holder) : nullptr;
  return user ? user->name : "";
}

// The face that a verdict names; without a name the rest of the part.
const SurfaceBand::Face* face_of(const SurfaceBand& band, const std::string& name) {
  if (band.faces.empty()) return nullptr;
  const auto found = std::find_if(band.faces.begin(), band.faces.end(),
                                  [&](const auto& face) { return face.name == name; });
  return found == band.faces.end() ? &band.faces.front() : &*found;
}

// Of "Ø20 H7/g6".
std::optional<Interval> clearance_of(const std::string& fit) {
  const std::string sign = "Ø";
  const auto space = fit.find(' ');
  if (!fit.starts_with(sign) || space == std::string::npos) return std::nullopt;
  const double nominal_mm = std::strtod(fit.c_str() + sign.size(), nullptr);
  const auto stated = iso286_fit(fit.substr(space + 1), nominal_mm);
  if (!stated) return std::nullopt;
  return stated->clearance_mm;
}

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

}  // namespace

bool is_of_fit(const std::string& fit, const std::string& source_a, const std::string& source_b) {
  const std::size_t slash = fit.find('/');
  if (slash == std::string::npos) return false;
  const auto is_of_class = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  const auto from =
      std::find_if_not(fit.rend() - static_cast<std::ptrdiff_t>(slash), fit.rend(), is_of_class);
  const auto until = std::find_if_not(fit.begin() + static_cast<std::ptrdiff_t>(slash) + 1,
                                      fit.end(), is_of_class);
  const std::string hole(from.base(), fit.begin() + static_cast<std::ptrdiff_t>(slash));
  const std::string shaft(fit.begin() + static_cast<std::ptrdiff_t>(slash) + 1, until);
  const auto says = [](const std::string& source, const std::string& name) {
    std::istringstream words(source);
    return std::find(std::istream_iterator<std::string>(words), {}, name) !=
           std::istream_iterator<std::string>();
  };
  return !hole.empty() && !shaft.empty() &&
         ((says(source_a, hole) && says(source_b, shaft)) ||
          (says(source_a, shaft) && says(source_b, hole)));
}

Circumstances circumstances_at(const Moment& moment) {
  const ClashEvent& event = moment.event;
  JudgementQuery query;
  query.a = moment.world.find(event.part_a);
  query.b = moment.world.find(event.part_b);
  query.rule = moment.world.rule(event.part_a, event.part_b);
  const SurfaceBand::Face* face_a = face_of(band_a_of(query), event.verdict.face_a);
  const SurfaceBand::Face* face_b = face_of(band_b_of(query), event.verdict.face_b);
  Circumstances found;
  found.holder_a = holder_of(moment.world, *query.a);
  found.holder_b = holder_of(moment.world, *query.b);
  if (face_a) found.eps_a_mm = face_a->deviation_mm;
  if (face_b) found.eps_b_mm = face_b->deviation_mm;
  // The pair has a fit, but only between the faces that have a size of it.
  const bool has_fit =
      query.rule && face_a && face_b &&
      is_of_fit(query.rule->fit, face_a->tolerance_source, face_b->tolerance_source);
  if (!has_fit) return found;
  found.fit = query.rule->fit;
  found.clearance_mm = clearance_of(found.fit);
  return found;
}

void add_circumstances(Table& clashes, const std::map<std::uint64_t, Circumstances>& known) {
  using Type = Table::Type;
  for (const char* name : {"holder_a", "holder_b", "fit"})
    clashes.columns.push_back({name, Type::kText});
  for (const char* name : {"eps_a_lo_mm", "eps_a_hi_mm", "eps_b_lo_mm", "eps_b_hi_mm",
                           "clearance_lo_mm", "clearance_hi_mm"})
    clashes.columns.push_back({name, Type::kNumber});
  for (std::vector<Json>& row : clashes.rows) {
    const auto at = known.find(row.front().get<std::uint64_t>());
    if (at == known.end()) {
      row.resize(clashes.columns.size());
      continue;
    }
    const Circumstances& found = at->second;
    for (const std::string& text : {found.holder_a, found.holder_b, found.fit}) row.push_back(text);
    for (const Interval& mm : {found.eps_a_mm, found.eps_b_mm}) {
      row.push_back(number(mm.lo));
      row.push_back(number(mm.hi));
    }
    row.push_back(found.clearance_mm ? number(found.clearance_mm->lo) : Json(nullptr));
    row.push_back(found.clearance_mm ? number(found.clearance_mm->hi) : Json(nullptr));
  }
}

}  // namespace mortise
