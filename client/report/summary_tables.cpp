#include "client/report/summary_tables.h"

#include <algorithm>
#include <cmath>

#include "client/report/cells.h"

namespace mortise {
namespace {

using Type = Table::Type;

// Steps of 1, 2 and 5. To both sides they make a zone wider by IT3 to IT10 of a size of 50 mm.
constexpr double kWidenings_mm[] = {-0.05, -0.02, -0.01, -0.005, -0.002, 0.0,
                                    0.002, 0.005, 0.01,  0.02,   0.05};

struct FaceSum {
  std::size_t real = 0, potential = 0, fake = 0;
  double deepest_mm = -std::numeric_limits<double>::infinity();
  std::uint64_t deepest_clash = 0;
  bool is_a = false;  // of that clash
};

}  // namespace

Table by_face_table(const Table& clashes, const std::map<std::uint64_t, Touch>& touches) {
  std::map<std::pair<std::string, std::string>, FaceSum> sums;
  for (const auto& cells : clashes.rows) {
    const Cells clash(clashes, cells);
    const double overlap_mm = clash.number("overlap_lo_mm");
    const std::string klass = clash.raw("class");
    for (const bool is_a : {true, false}) {
      FaceSum& sum =
          sums[{clash.raw(is_a ? "part_a" : "part_b"), clash.raw(is_a ? "face_a" : "face_b")}];
      sum.real += klass == "real";
      sum.potential += klass == "potential";
      sum.fake += klass == "fake";
      if (!(overlap_mm > sum.deepest_mm)) continue;
      sum.deepest_mm = overlap_mm;
      sum.deepest_clash = clash["clash"].get<std::uint64_t>();
      sum.is_a = is_a;
    }
  }
  Table table{"by_face",
              "clashes by face, and where the deepest was, in the frame of the part",
              {{"part", Type::kText},
               {"face", Type::kText},
               {"real", Type::kInteger},
               {"potential", Type::kInteger},
               {"fake", Type::kInteger},
               {"deepest_overlap_mm", Type::kNumber},
               {"deepest_clash", Type::kInteger},
               {"x_mm", Type::kNumber},
               {"y_mm", Type::kNumber},
               {"z_mm", Type::kNumber}},
              {}};
  for (const auto& [key, sum] : sums) {
    const bool known = std::isfinite(sum.deepest_mm);
    std::vector<Json> row{key.first,
                          key.second,
                          sum.real,
                          sum.potential,
                          sum.fake,
                          known ? Json(sum.deepest_mm) : Json(nullptr),
                          known ? Json(sum.deepest_clash) : Json(nullptr)};
    const auto touch = touches.find(sum.deepest_clash);
    for (int i = 0; i < 3; ++i)
      row.push_back(touch == touches.end()
                        ? Json(nullptr)
                        : Json((sum.is_a ? touch->second.p_A : touch->second.p_B)[i]));
    table.rows.push_back(std::move(row));
  }
  worst_first(table);
  return table;
}

std::string class_when_widened(double overlap_lo_mm, double overlap_hi_mm, double fake_below_mm,
                               double real_above_mm, double widening_mm) {
  const double middle = 0.5 * (fake_below_mm + real_above_mm);
  // Either threshold moves by the widening of two faces.
  const double half = std::max(0.0, 0.5 * (real_above_mm - fake_below_mm) + 2.0 * widening_mm);
  if (overlap_lo_mm > middle + half) return "real";
  if (overlap_hi_mm <= middle - half) return overlap_hi_mm > 0.0 ? "fake" : "none";
  return "potential";
}

Table tolerance_table(const Table& clashes) {
  Table table{"tolerance",
              "clashes by class if the zone of every face were wider (or narrower: negative) by so "
              "much to each side, each at its worst recorded moment",
              {{"widening_mm", Type::kNumber},
               {"real", Type::kInteger},
               {"potential", Type::kInteger},
               {"fake", Type::kInteger},
               {"none", Type::kInteger},
               {"not_known", Type::kInteger}},
              {}};
  for (const double widening_mm : kWidenings_mm) {
    std::map<std::string, std::size_t> count;
    for (const auto& cells : clashes.rows) {
      const Cells clash(clashes, cells);
      const double lo = clash.number("overlap_lo_mm"), hi = clash.number("overlap_hi_mm");
      const double fake = clash.number("fake_below_mm"), real = clash.number("real_above_mm");
      // As it was it keeps its class; an open part has no depth, whatever its tolerance.
      const bool known = std::isfinite(lo) && std::isfinite(fake) && std::isfinite(real) &&
                         clash.raw("explanation").find("has no inside") == std::string::npos;
      const double upper = std::isfinite(hi) ? hi : std::numeric_limits<double>::infinity();
      ++count[widening_mm == 0.0 ? clash.raw("class")
              : known            ? class_when_widened(lo, upper, fake, real, widening_mm)
                                 : "not_known"];
    }
    table.rows.push_back({widening_mm, count["real"], count["potential"], count["fake"],
                          count["none"], count["not_known"]});
  }
  return table;
}

}  // namespace mortise
