#include "client/picture/draw.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "client/picture/class_colours.h"
#include "client/picture/told_overlap.h"
#include "common/evaluation/threshold_text.h"
#include "common/messages/length_text.h"

namespace mortise {

Color color_of_part(int part) {
  return part == 0 ? Color{0.15, 0.39, 0.68} : Color{0.80, 0.38, 0.06};
}

Color color_of_hex(std::uint32_t hex) {
  const auto part = [&](int shift) { return static_cast<double>(hex >> shift & 0xffu) / 255.0; };
  return {part(16), part(8), part(0)};
}

Color color_of(CollisionClass collision_class) {
  return color_of_hex(class_colours(collision_class).light);
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
  const bool fake_known = states_fake(verdict), real_known = states_real(verdict);
  const double delta = told_overlap_mm(verdict);
  // Of a threshold that is not known only its side is.
  const double fake = fake_known ? verdict.fake_below_mm : std::min(0.0, delta);
  const double real = real_known ? verdict.real_above_mm : std::max(fake, delta);
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
  if (fake_known) zone(lo, fake, CollisionClass::kFake, "fake");
  const double unknown_from = fake_known ? fake : lo, unknown_to = real_known ? real : hi;
  if (unknown_to > unknown_from && (fake_known || real_known))
    zone(unknown_from, unknown_to, CollisionClass::kPotential,
         fake_known && real_known ? "potential" : "");
  if (real_known) zone(real, hi, CollisionClass::kReal, "real");
  const auto threshold = [&](double mm, const std::string& text, Canvas::Align align) {
    const double x = x_of(mm);
    canvas.line({{x, top - 4.0}, {x, bottom}}, {kInk, 1.2});
    Canvas::Font font{11.0, false, kInk, align};
    const double width = canvas.text_width(text, font);
    if (align == Canvas::Align::kRight && x - width < box.x) font.align = Canvas::Align::kLeft;
    if (align == Canvas::Align::kLeft && x + width > box.right())
      font.align = Canvas::Align::kRight;
    // Both may stand at one place: a gap between their texts.
    const double gap = font.align == Canvas::Align::kRight ? -4.0 : 4.0;
    canvas.text({x + gap, top - 7.0}, text, font);
  };
  if (fake_known) threshold(fake, fake_text(fake), Canvas::Align::kRight);
  if (real_known) threshold(real, real_text(real), Canvas::Align::kLeft);
  const double x = x_of(delta);
  canvas.line({{x, top - 2.0}, {x, bottom + 6.0}}, {kInk, 2.4});
  canvas.fill({{{x, bottom}, {x - 5.0, bottom + 9.0}, {x + 5.0, bottom + 9.0}}}, kInk);
  const std::string text = "meshes " + told_overlap_text(verdict);
  const Canvas::Align align = x < box.x + 0.2 * box.width   ? Canvas::Align::kLeft
                              : x > box.x + 0.8 * box.width ? Canvas::Align::kRight
                                                            : Canvas::Align::kMiddle;
  canvas.text({x, bottom + 21.0}, text, {11.0, true, kInk, align});
}

namespace {

const Canvas::Font kSmall{11.0, false, kGrey, Canvas::Align::kLeft};

// Beside `at`, and within the box: words that are cut off cannot be read.
void draw_label(Canvas& canvas, const Box2& box, const Vec2& at, const std::string& label,
                bool left, const Color& color) {
  const Canvas::Font font{12.0, true, color, Canvas::Align::kLeft};
  const double width = canvas.text_width(label, font);
  const double beside = left ? at.x() - 7.0 - width : at.x() + 7.0;
  const double x = std::max(box.x + 4.0, std::min(beside, box.right() - 4.0 - width));
  canvas.rectangle({x - 2.0, at.y() - 7.0, width + 4.0, 15.0}, Color{1, 1, 1, 0.82});
  canvas.text({x, at.y() + 4.0}, label, font);
}

// Of the surface as modelled; where both parts are modelled alike both are seen.
Pen dashed(int part) { return {color_of_part(part), 1.8, {7.0, 7.0}, 7.0 * part}; }

// 1, 2 or 5 times a power of ten, not above x.
double round_below(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double m : {5.0, 2.0})
    if (m * power <= x) return m * power;
  return power;
}

void arrow_head(Canvas& canvas, const Vec2& tip, double up, const Color& color) {
  canvas.fill({{tip, tip + Vec2(-3.2, 8.0 * up), tip + Vec2(3.2, 8.0 * up)}}, color);
}

// A dimension of a height: two arrows, inside where there is room, else from outside.
struct Dimension {
  double x = 0.0, y0 = 0.0, y1 = 0.0;
  std::string label;
  bool label_left = false, label_high = false;
};

void draw_dimension(Canvas& canvas, const Box2& box, const Dimension& d) {
  const double top = std::min(d.y0, d.y1), bottom = std::max(d.y0, d.y1);
  const Pen pen{kInk, 1.1};
  if (bottom - top >= 22.0) {
    canvas.line({{d.x, top}, {d.x, bottom}}, pen);
    arrow_head(canvas, {d.x, top}, 1.0, kInk);
    arrow_head(canvas, {d.x, bottom}, -1.0, kInk);
  } else {
    canvas.line({{d.x, top - 20.0}, {d.x, bottom + 20.0}}, pen);
    arrow_head(canvas, {d.x, top}, -1.0, kInk);
    arrow_head(canvas, {d.x, bottom}, 1.0, kInk);
  }
  const bool inside = bottom - top >= 40.0;
  const double share = d.label_high ? 0.3 : 0.7, beside = d.label_high ? top - 18.0 : bottom + 18.0;
  draw_label(canvas, box, {d.x, inside ? top + share * (bottom - top) : beside}, d.label,
             d.label_left, kInk);
}

void draw_materials(Canvas& canvas, const Frame& frame, const DetailView& view) {
  for (int i = 0; i < 2; ++i) {
    const Color color = color_of_part(i);
    std::vector<std::vector<Vec2>> outlines;
    for (const ChartLine& outline : view.parts[i].fills) outlines.push_back(frame(outline));
    canvas.fill(outlines, color.faded(0.17));
  }
  for (int i = 0; i < 2; ++i) {
    const Color color = color_of_part(i);
    for (const DrawnZone& zone : view.parts[i].zones) {
      std::vector<Vec2> area = frame(zone.least);
      const std::vector<Vec2> most = frame(zone.most);
      area.insert(area.end(), most.rbegin(), most.rend());
      canvas.fill({area}, color.faded(0.5));
      canvas.line(most, {color, 1.0});
      canvas.line(frame(zone.least), {color, 1.0});
      if (zone.has_surface) canvas.line(frame(zone.modelled), dashed(i));
    }
    for (const ChartLine& mesh : view.parts[i].meshes) canvas.line(frame(mesh), {color, 2.0});
  }
}

void draw_heights(Canvas& canvas, const Frame& frame) {
  const double step = round_below(frame.y_mm.width() / 5.0);
  Canvas::Font font = kSmall;
  font.align = Canvas::Align::kRight;
  for (double h = std::ceil(frame.y_mm.lo / step) * step; h <= frame.y_mm.hi; h += step) {
    const double y = frame({frame.x_mm.lo, h}).y();
    canvas.line({{frame.box.x - 4.0, y}, {frame.box.x, y}}, {kGrey, 1.0});
    canvas.line({{frame.box.x, y}, {frame.box.right(), y}}, {kGrey.faded(0.15), 1.0});
    const double shown = std::fabs(h) < 0.5 * step ? 0.0 : h * 1e3;
    canvas.text({frame.box.x - 7.0, y + 4.0},
                step >= 1e-3 ? fmt::format("{:.0f}", shown) : fmt::format("{:g}", shown), font);
  }
}

// Between the two zones at the deciding point: what is left at least, what overlaps at least.
void draw_gaps(Canvas& canvas, const Frame& frame, const DetailView& view) {
  const auto& above = view.parts[view.upper].zone_at_point;
  const auto& below = view.parts[1 - view.upper].zone_at_point;
  if (!above || !below) return;
  const double s0 = view.point.x();
  const auto between = [&](double share, double from_h, double to_h, const std::string& what) {
    const double s = s0 + share * view.s_mm.width();
    for (const double h : {from_h, to_h})
      canvas.line({frame({s0, h}), frame({s, h})}, {kInk.faded(0.55), 0.7});
    Dimension d{frame({s, 0.0}).x(), frame({s, from_h}).y(), frame({s, to_h}).y(),
                what + " " + length_text(std::fabs(to_h - from_h))};
    d.label_high = share > 0.2;
    draw_dimension(canvas, frame.box, d);
  };
  const double most = below->hi - above->lo, least = below->lo - above->hi;
  if (most <= 0.0) return between(0.12, above->lo, below->hi, "clearance ≥");
  if (least > 0.0) return between(0.12, above->hi, below->lo, "interference ≥");
  between(0.07, above->lo, below->hi, "interference ≤");
  between(0.22, above->hi, below->lo, "clearance ≤");
}

void draw_witness(Canvas& canvas, const Frame& frame, const DetailView& view) {
  if (!view.witness) return;
  const Vec2 at = frame(*view.witness);
  const Color color = color_of(CollisionClass::kReal);
  canvas.circle(at, 5.0, {color, 2.0});
  canvas.line({at - Vec2(9, 0), at + Vec2(9, 0)}, {color, 1.2});
  canvas.line({at - Vec2(0, 9), at + Vec2(0, 9)}, {color, 1.2});
  draw_label(
      canvas, frame.box, at - Vec2(8.0, 13.0),
      view.witness_is_declared ? "inside both, however made" : "inside both, by their meshes", true,
      color);
}

// Which way the part that is moved out sets off at the deciding point, and how far it goes at most:
// an arrow of a fixed size, for the scales along and across differ.
void draw_way_out(Canvas& canvas, const Frame& frame, const DetailView& view,
                  const Verdict& verdict) {
  if (verdict.separation_way == SeparationWay::kNone) return;
  const std::optional<Vec2> seen = way_seen(view.plane, verdict);
  const Color color{0.1, 0.5, 0.25, 1.0};
  const std::string label = (verdict.separation_of_b ? view.parts[1] : view.parts[0]).name +
                            " free after " + length_text(verdict.gpd_mm.hi);
  const Vec2 from = frame(view.point) + Vec2(-46.0, 0.0);
  if (!seen) {
    canvas.circle(from, 5.0, {color, 1.6});
    canvas.circle(from, 1.0, {color, 1.6});
    return draw_label(canvas, frame.box, from - Vec2(8.0, 0.0), label, true, color);
  }
  const Vec2 d(seen->x(), -seen->y()), side(-d.y(), d.x());
  const Vec2 tip = from + 34.0 * d;
  canvas.line({from, tip - 7.0 * d}, {color, 2.0});
  canvas.fill({{tip, tip - 10.0 * d + 4.0 * side, tip - 10.0 * d - 4.0 * side}}, color);
  draw_label(canvas, frame.box, tip + 6.0 * d - Vec2(8.0, 0.0), label, true, color);
}

std::string scales_text(const Frame& frame, const DetailView& view) {
  const double along = frame.box.width / view.s_mm.width();
  const double up = frame.box.height / view.h_mm.width();
  const double times = up / along;
  const std::string zero = view.chart.straight()
                               ? std::string("heights in µm from the deciding point")
                               : std::string("heights in µm from the modelled round, unrolled");
  return times > 1.05
             ? fmt::format("{}, magnified ×{:.3g}; dimensions at the deciding point", zero, times)
             : zero + ", to scale; dimensions there";
}

void draw_legend(Canvas& canvas, const Box2& box, const DetailView& view) {
  for (int i = 0; i < 2; ++i) {
    const DrawnPart& part = view.parts[i];
    const Color color = color_of_part(i);
    double x = box.x;
    const double y = box.y + 15.0 * i;
    const auto entry = [&](const std::string& text, auto draw) {
      draw(Vec2(x, y - 4.0));
      canvas.text({x + 26.0, y}, text, {11.0, false, kInk, Canvas::Align::kLeft});
      x += 26.0 + canvas.text_width(text, {11.0, false, kInk, Canvas::Align::kLeft}) + 16.0;
    };
    entry(part.name + (part.face.empty() ? "" : "." + part.face) + ", mesh", [&](const Vec2& at) {
      canvas.rectangle({at.x(), at.y() - 5.0, 20.0, 10.0}, color.faded(0.17));
      canvas.line({at, at + Vec2(20, 0)}, {color, 2.0});
    });
    const bool any_surface = std::any_of(part.zones.begin(), part.zones.end(),
                                         [](const DrawnZone& zone) { return zone.has_surface; });
    if (any_surface)
      entry("surface as modelled", [&](const Vec2& at) {
        canvas.line({at, at + Vec2(20, 0)}, {color, 1.8, {8.0, 4.0}});
      });
    if (part.zone_at_point && part.zone_at_point->width() > 1e-6)
      entry("where the real surface may lie", [&](const Vec2& at) {
        canvas.rectangle({at.x(), at.y() - 4.0, 20.0, 8.0}, color.faded(0.6));
      });
  }
}

}  // namespace

std::optional<Vec2> way_seen(const CutPlane& plane, const Verdict& verdict) {
  const Vec3 way =
      verdict.separation_translation_mm +
      verdict.separation_rotation_rad.cross(verdict.point_W - verdict.separation_about_W);
  const Vec2 seen(way.dot(plane.right_W), way.dot(plane.up_W));
  if (!(seen.norm() > 0.2 * way.norm())) return std::nullopt;
  return seen / seen.norm();
}

void draw_scale_bar(Canvas& canvas, const Frame& frame, double share) {
  const double length = round_below(share * frame.x_mm.width());
  const double pixels = length / frame.x_mm.width() * frame.box.width;
  const Vec2 from(frame.box.right() - 12.0 - pixels, frame.box.bottom() - 10.0);
  canvas.rectangle({from.x() - 5.0, from.y() - 19.0, pixels + 10.0, 25.0}, Color{1, 1, 1, 0.8});
  canvas.line({from, from + Vec2(pixels, 0)}, {kInk, 2.0});
  for (const double x : {0.0, pixels})
    canvas.line({from + Vec2(x, -4), from + Vec2(x, 4)}, {kInk, 1.2});
  const std::string text =
      length < 0.1 ? fmt::format("{:g} µm", length * 1e3) : fmt::format("{:g} mm", length);
  canvas.text(from + Vec2(0.5 * pixels, -6.0), text, {11.0, false, kInk, Canvas::Align::kMiddle});
}

void draw_detail(Canvas& canvas, const Box2& box, const DetailView& view, const Verdict& verdict) {
  const Frame frame{
      {box.x + 46.0, box.y, box.width - 46.0, box.height - 52.0}, view.s_mm, view.h_mm};
  canvas.clip(frame.box);
  draw_materials(canvas, frame, view);
  canvas.unclip();
  draw_heights(canvas, frame);
  canvas.clip(frame.box);
  draw_gaps(canvas, frame, view);
  draw_dimension(
      canvas, frame.box,
      {frame(view.point).x(), frame({0.0, view.overlap_h_mm.lo}).y(),
       frame({0.0, view.overlap_h_mm.hi}).y(), "meshes " + told_overlap_text(verdict), true});
  draw_witness(canvas, frame, view);
  draw_way_out(canvas, frame, view, verdict);
  draw_scale_bar(canvas, frame, 0.22);
  canvas.unclip();
  const Box2& f = frame.box;
  canvas.line(
      {{f.x, f.y}, {f.right(), f.y}, {f.right(), f.bottom()}, {f.x, f.bottom()}, {f.x, f.y}},
      {kGrey, 1.0});
  canvas.text({f.x, f.bottom() + 14.0}, scales_text(frame, view), kSmall);
  draw_legend(canvas, {f.x, f.bottom() + 32.0, f.width, 30.0}, view);
}

}  // namespace mortise
