#include "client/picture/canvas.h"

#include <cairo.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "client/picture/svg_text.h"

namespace mortise {
namespace {

std::string reason(cairo_status_t status) { return cairo_status_to_string(status); }

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int count) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), count);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

// A PNG is drawn by the library. An SVG is written here, with text as text: a tenth of the bytes
// that outlines of letters take, and it can be searched; the library then only measures.
struct Canvas::Impl {
  bool png = false;
  cairo_surface_t* surface = nullptr;
  cairo_t* cr = nullptr;
  SvgText svg;

  ~Impl() {
    if (cr != nullptr) cairo_destroy(cr);
    if (surface != nullptr) cairo_surface_destroy(surface);
  }

  void use(const Color& c) { cairo_set_source_rgba(cr, c.red, c.green, c.blue, c.alpha); }

  void use(const Pen& pen) {
    use(pen.color);
    cairo_set_line_width(cr, pen.width);
    cairo_set_dash(cr, pen.dashes.data(), static_cast<int>(pen.dashes.size()), pen.dash_from);
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
  }

  void path(const std::vector<Vec2>& points) {
    cairo_new_sub_path(cr);
    for (const Vec2& x : points) cairo_line_to(cr, x.x(), x.y());
  }

  void use(const Font& font) {
    cairo_select_font_face(cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           font.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, font.size);
    use(font.color);
  }

  double advance(const std::string& text) {
    cairo_text_extents_t extents;
    cairo_text_extents(cr, text.c_str(), &extents);
    return extents.x_advance;
  }
};

Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;

Canvas::Canvas(Format format, double width, double height, double pixels_per_unit)
    : impl_(std::make_unique<Impl>()) {
  impl_->png = format == Format::kPng;
  const double scale = impl_->png ? pixels_per_unit : 0.0;
  impl_->surface = cairo_image_surface_create(
      CAIRO_FORMAT_RGB24, std::max(1, static_cast<int>(std::ceil(width * scale))),
      std::max(1, static_cast<int>(std::ceil(height * scale))));
  impl_->cr = cairo_create(impl_->surface);
  if (impl_->png)
    cairo_scale(impl_->cr, pixels_per_unit, pixels_per_unit);
  else
    impl_->svg.begin(width, height);
  rectangle({0.0, 0.0, width, height}, {1, 1, 1});
}

void Canvas::fill(const std::vector<std::vector<Vec2>>& outlines, const Color& color) {
  if (!impl_->png) return impl_->svg.fill(outlines, color);
  cairo_new_path(impl_->cr);
  for (const std::vector<Vec2>& outline : outlines) {
    impl_->path(outline);
    cairo_close_path(impl_->cr);
  }
  cairo_set_fill_rule(impl_->cr, CAIRO_FILL_RULE_EVEN_ODD);
  impl_->use(color);
  cairo_fill(impl_->cr);
}

void Canvas::line(const std::vector<Vec2>& points, const Pen& pen) {
  if (!impl_->png) return impl_->svg.line(points, pen);
  cairo_new_path(impl_->cr);
  impl_->path(points);
  impl_->use(pen);
  cairo_stroke(impl_->cr);
}

void Canvas::rectangle(const Box2& box, const Color& color) {
  if (!impl_->png) return impl_->svg.rectangle(box, color);
  cairo_new_path(impl_->cr);
  cairo_rectangle(impl_->cr, box.x, box.y, box.width, box.height);
  impl_->use(color);
  cairo_fill(impl_->cr);
}

void Canvas::circle(const Vec2& center, double radius, const Pen& pen) {
  if (!impl_->png) return impl_->svg.circle(center, radius, pen);
  cairo_new_path(impl_->cr);
  cairo_arc(impl_->cr, center.x(), center.y(), radius, 0.0, 2.0 * std::numbers::pi);
  impl_->use(pen);
  cairo_stroke(impl_->cr);
}

void Canvas::text(const Vec2& at, const std::string& text, const Font& font) {
  impl_->use(font);
  const double width = impl_->advance(text);
  const double share = font.align == Align::kLeft ? 0.0 : font.align == Align::kMiddle ? 0.5 : 1.0;
  const Vec2 from(at.x() - share * width, at.y());
  if (!impl_->png) return impl_->svg.text(from, width, text, {font.size, font.bold, font.color});
  cairo_move_to(impl_->cr, from.x(), from.y());
  cairo_show_text(impl_->cr, text.c_str());
  cairo_new_path(impl_->cr);
}

double Canvas::text_width(const std::string& text, const Font& font) const {
  impl_->use(font);
  return impl_->advance(text);
}

void Canvas::clip(const Box2& box) {
  if (!impl_->png) return impl_->svg.clip(box);
  cairo_save(impl_->cr);
  cairo_new_path(impl_->cr);
  cairo_rectangle(impl_->cr, box.x, box.y, box.width, box.height);
  cairo_clip(impl_->cr);
}

void Canvas::unclip() {
  if (!impl_->png) return impl_->svg.unclip();
  cairo_restore(impl_->cr);
}

Result<std::string> Canvas::finish() {
  std::string bytes;
  cairo_status_t status = cairo_status(impl_->cr);
  if (status == CAIRO_STATUS_SUCCESS && impl_->png)
    status = cairo_surface_write_to_png_stream(impl_->surface, append, &bytes);
  if (status != CAIRO_STATUS_SUCCESS)
    return fail(Code::kRuntime, "a picture could not be drawn (" + reason(status) + ")");
  return impl_->png ? bytes : impl_->svg.end();
}

}  // namespace mortise
