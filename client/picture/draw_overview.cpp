#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "client/picture/draw.h"

namespace mortise {

Color color_of_part(int part) {
  return part == 0 ? Color{0.15, 0.39, 0.68} : Color{0.80, 0.38, 0.06};
}

Color color_of(CollisionClass collision_class) {
  switch (collision_class) {
    case CollisionClass::kReal:
      return {0.78, 0.12, 0.13};
    case CollisionClass::kPotential:
      return {0.85, 0.56, 0.02};
    case CollisionClass::kFake:
      return {0.13, 0.52, 0.25};
    case CollisionClass::kNone:
      break;
  }
  return kGrey;
}

std::string um_text(double mm) {
  const double um = mm * 1e3;
  return fmt::format("{:.1f}", std::fabs(um) < 0.05 ? 0.0 : um);
}

void draw_overview(Canvas& canvas, const Box2& box, const Overview& view) {
  const Box2 window{box.x, box.y, box.width, box.height - 18.0};
  const double half = 0.5 * view.x_mm.width() * window.height / window.width;
  const Frame frame{window, view.x_mm, {view.y_mm.middle() - half, view.y_mm.middle() + half}};
  canvas.clip(frame.box);
  for (int i = 0; i < 2; ++i) {
    std::vector<std::vector<Vec2>> outlines;
    for (const auto& outline : view.fills[i]) outlines.push_back(frame(outline));
    canvas.fill(outlines, color_of_part(i).faded(0.28));
    for (const auto& outline : outlines) canvas.line(outline, {color_of_part(i), 1.2});
    for (const auto& line : view.lines[i]) canvas.line(frame(line), {color_of_part(i), 1.2});
  }
  const Vec2 at = frame(Vec2(0.0, 0.0));
  canvas.circle(at, 8.0, {kInk, 1.6});
  draw_scale_bar(canvas, frame, 0.3);
  canvas.unclip();
  const Box2& f = frame.box;
  canvas.line(
      {{f.x, f.y}, {f.right(), f.y}, {f.right(), f.bottom()}, {f.x, f.bottom()}, {f.x, f.y}},
      {kGrey.faded(0.5), 1.0});
  canvas.text({f.x, f.bottom() + 14.0}, view.title, {11.0, false, kGrey, Canvas::Align::kLeft});
}

void draw_thresholds(Canvas& canvas, const Box2& box, const Verdict& verdict) {
  const double fake = verdict.fake_below_mm, real = verdict.real_above_mm;
  const double delta = verdict.delta_mm.middle();
  double lo = std::min({0.0, fake, delta}), hi = std::max({0.0, real, delta});
  const double room = std::max(0.18 * (hi - lo), 1e-3);
  lo -= room;
  hi += room;
  const auto x_of = [&](double mm) { return box.x + (mm - lo) / (hi - lo) * box.width; };
  const double top = box.y + 18.0, bottom = top + 16.0;
  const auto zone = [&](double from, double to, CollisionClass c, const char* name) {
    const Box2 area{x_of(from), top, x_of(to) - x_of(from), bottom - top};
    canvas.rectangle(area, color_of(c).faded(0.32));
    const Canvas::Font font{11.0, true, color_of(c), Canvas::Align::kMiddle};
    if (canvas.text_width(name, font) + 6.0 < area.width)
      canvas.text({area.x + 0.5 * area.width, bottom - 4.0}, name, font);
  };
  zone(lo, fake, CollisionClass::kFake, "fake");
  if (real > fake) zone(fake, real, CollisionClass::kPotential, "potential");
  zone(real, hi, CollisionClass::kReal, "real");
  const auto threshold = [&](double mm, const std::string& text, Canvas::Align align) {
    const double x = x_of(mm);
    canvas.line({{x, top - 4.0}, {x, bottom}}, {kInk, 1.2});
    Canvas::Font font{11.0, false, kInk, align};
    const double width = canvas.text_width(text, font);
    if (align == Canvas::Align::kRight && x - width < box.x) font.align = Canvas::Align::kLeft;
    if (align == Canvas::Align::kLeft && x + width > box.right())
      font.align = Canvas::Align::kRight;
    canvas.text({x, top - 7.0}, text, font);
  };
  threshold(fake,
            fake < 0.0 ? "fake from a gap of " + um_text(-fake) + " µm"
                       : "fake up to " + um_text(fake) + " µm",
            Canvas::Align::kRight);
  threshold(real,
            real < 0.0 ? "real below a gap of " + um_text(-real) + " µm"
                       : "real above " + um_text(real) + " µm",
            Canvas::Align::kLeft);
  const double x = x_of(delta);
  canvas.line({{x, top - 2.0}, {x, bottom + 6.0}}, {kInk, 2.4});
  canvas.fill({{{x, bottom}, {x - 5.0, bottom + 9.0}, {x + 5.0, bottom + 9.0}}}, kInk);
  const std::string text = delta < 0.0 ? "gap of the meshes " + um_text(-delta)
                                       : "overlap of the meshes " + um_text(delta);
  const Canvas::Align align = x < box.x + 0.2 * box.width   ? Canvas::Align::kLeft
                              : x > box.x + 0.8 * box.width ? Canvas::Align::kRight
                                                            : Canvas::Align::kMiddle;
  canvas.text({x, bottom + 21.0}, text + " µm", {11.0, true, kInk, align});
}

}  // namespace mortise
