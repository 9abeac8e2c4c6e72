#include "client/tools/judge/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "client/tools/judge/draw.h"
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

void draw_region(Canvas& canvas, const World& world, const NumberedRegion& region, double left) {
  const Verdict& verdict = *region.verdict;
  const RegionQuery query{&world, region.pair->a, region.pair->b, &verdict};
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
  const DetailView detail = detail_view(query, aspect);
  CutPlane along = detail.plane;
  along.right_W = detail.axis_W;
  const Overview views[2] = {overview(query, detail.plane, "section across, to scale"),
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

Status draw_regions(const World& world, const JudgeReport& report,
                    const std::vector<std::size_t>& numbers, const std::string& file) {
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
  auto canvas = Canvas::open(file, kWidth * static_cast<double>(drawn.size()), kHeight,
                             drawn.size() > 1 ? kPixelsPerUnitOfMany : kPixelsPerUnit);
  if (!canvas) return canvas.error();
  for (std::size_t i = 0; i < drawn.size(); ++i)
    draw_region(*canvas, world, drawn[i], kWidth * static_cast<double>(i));
  return canvas->finish();
}

}  // namespace mortise
