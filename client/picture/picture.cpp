#include "client/picture/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "client/picture/draw.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

// One region on the sheet.
constexpr double kWidth = 860.0, kHeight = 560.0, kMargin = 18.0;
constexpr double kOverviewSide = 196.0;
constexpr Box2 kDetail{kMargin + kOverviewSide + 8.0, 50.0,
                       kWidth - 2.0 * kMargin - kOverviewSide - 8.0, 400.0};
constexpr Box2 kThresholds{kMargin, 454.0, kWidth - 2.0 * kMargin, 60.0};

// More pixels than units: text stays sharp on fine screens. Less for several regions, which are
// shown smaller.
constexpr double kPixelsPerUnit = 1.5, kPixelsPerUnitOfMany = 1.2;

void draw_wrapped(Canvas& canvas, const Vec2& at, double width, const std::string& text,
                  const Canvas::Font& font) {
  std::istringstream words(text);
  std::string line, word;
  double y = at.y();
  const auto put = [&] {
    canvas.text({at.x(), y}, line, font);
    y += 1.3 * font.size;
    line.clear();
  };
  while (words >> word) {
    const std::string longer = line.empty() ? word : line + " " + word;
    if (!line.empty() && canvas.text_width(longer, font) > width) put();
    line = line.empty() ? word : line + " " + word;
  }
  if (!line.empty()) put();
}

// Does the section show both parts?
bool shows_both(const DetailView& view) {
  return !view.parts[0].meshes.empty() && !view.parts[1].meshes.empty();
}

// The deepest point is often at the very end of a face, where a section across passes by one of the
// parts or through it by the last bit of a pose. Then it is cut somewhat beside.
struct CutBeside {
  DetailView view;
  double beside_mm = 0.0;
};
CutBeside detail_showing_both(const RegionQuery& query, double aspect) {
  CutBeside at{detail_view(query, aspect)};
  if (shows_both(at.view)) return at;
  for (const double beside_mm : {0.05, -0.05, 0.5, -0.5}) {
    Verdict moved = *query.verdict;
    moved.point_W += beside_mm * at.view.axis_W;
    CutBeside other{detail_view({query.world, query.a, query.b, &moved}, aspect), beside_mm};
    if (shows_both(other.view)) return other;
  }
  return at;
}

void draw_region(Canvas& canvas, const RegionQuery& query, double left) {
  const World& world = *query.world;
  const Verdict& verdict = *query.verdict;
  const PairRule* rule = world.rule(query.a, query.b);
  std::string title = world.find(query.a)->name + " × " + world.find(query.b)->name;
  if (rule != nullptr && !rule->fit.empty()) title += "   " + rule->fit;
  const Color color = color_of(verdict.collision_class);
  canvas.text({left + kMargin, 32.0}, title, {17.0, true, kInk, Canvas::Align::kLeft});
  canvas.text({left + kWidth - kMargin, 32.0}, std::string(name_of(verdict.collision_class)),
              {20.0, true, color, Canvas::Align::kRight});

  const auto moved = [&](Box2 box) {
    box.x += left;
    return box;
  };
  const double aspect = (kDetail.width - 46.0) / (kDetail.height - 52.0);
  const CutBeside cut = detail_showing_both(query, aspect);
  const DetailView& detail = cut.view;
  CutPlane along = detail.plane;
  along.right_W = detail.axis_W;
  const Overview views[2] = {
      overview(query, detail.plane,
               cut.beside_mm == 0.0 ? "section across, to scale"
                                    : fmt::format("section across, {} mm beside the point",
                                                  std::fabs(cut.beside_mm))),
      overview(query, along, "section along, to scale")};
  for (int i = 0; i < 2; ++i)
    draw_overview(canvas,
                  moved({kMargin, 50.0 + i * (kOverviewSide + 4.0), kOverviewSide, kOverviewSide}),
                  views[i]);
  draw_detail(canvas, moved(kDetail), detail, verdict);
  draw_thresholds(canvas, moved(kThresholds), verdict);
  draw_wrapped(canvas, {left + kMargin, kThresholds.bottom() + 14.0}, kWidth - 2.0 * kMargin,
               verdict.explanation, {12.0, false, kInk, Canvas::Align::kLeft});
}

}  // namespace

std::vector<NumberedRegion> numbered_regions(const JudgeReport& report) {
  std::vector<NumberedRegion> regions;
  for (const PairVerdicts& pair : report.pairs)
    for (const Verdict& verdict : pair.verdicts)
      regions.push_back({regions.size() + 1, &pair, &verdict});
  return regions;
}

Result<std::string> region_picture(const RegionQuery& query, Canvas::Format format) {
  Canvas canvas(format, kWidth, kHeight, kPixelsPerUnit);
  draw_region(canvas, query, 0.0);
  return canvas.finish();
}

Status draw_regions(const World& world, const JudgeReport& report,
                    const std::vector<std::size_t>& numbers, const std::string& file) {
  const bool is_png = file.ends_with(".png");
  if (!is_png && !file.ends_with(".svg"))
    return fail(Code::kInvalidInput, file + ": a picture is written as .svg or .png");
  const std::vector<NumberedRegion> regions = numbered_regions(report);
  if (regions.empty())
    return fail(Code::kNotFound, file + ": not drawn, no pair has a region to draw");
  std::vector<NumberedRegion> drawn;
  for (const std::size_t number : numbers) {
    if (number < 1 || number > regions.size())
      return fail(Code::kInvalidInput,
                  fmt::format("--region {}: there are regions 1 to {}", number, regions.size()));
    drawn.push_back(regions[number - 1]);
  }
  if (drawn.empty())
    drawn.push_back(*std::max_element(
        regions.begin(), regions.end(), [](const NumberedRegion& x, const NumberedRegion& y) {
          const auto rank = [](const NumberedRegion& r) {
            return std::pair(static_cast<int>(r.verdict->collision_class),
                             r.verdict->delta_mm.lo - r.verdict->real_above_mm);
          };
          return rank(x) < rank(y);
        }));
  Canvas canvas(is_png ? Canvas::Format::kPng : Canvas::Format::kSvg,
                kWidth * static_cast<double>(drawn.size()), kHeight,
                drawn.size() > 1 ? kPixelsPerUnitOfMany : kPixelsPerUnit);
  for (std::size_t i = 0; i < drawn.size(); ++i)
    draw_region(canvas, {&world, drawn[i].pair->a, drawn[i].pair->b, drawn[i].verdict},
                kWidth * static_cast<double>(i));
  const auto bytes = canvas.finish();
  if (!bytes) return fail(bytes.error().code, file + ": " + bytes.error().text);
  std::ofstream out(file, std::ios::binary);
  out << *bytes;
  return out.flush() ? ok() : Status(fail(Code::kRuntime, file + ": cannot be written"));
}

}  // namespace mortise
