#include "client/tools/judge/canvas.h"

#include <cairo-svg.h>
#include <cairo.h>

#include <cmath>
#include <numbers>

namespace mortise {
namespace {

bool ends_with(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

std::string reason(cairo_status_t status) { return cairo_status_to_string(status); }

}  // namespace

struct Canvas::Impl {
  std::string file;
  bool png = false;
  cairo_surface_t* surface = nullptr;
  cairo_t* cr = nullptr;

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

Canvas::Canvas(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;

Result<Canvas> Canvas::open(const std::string& file, double width, double height,
                            double pixels_per_unit) {
  auto impl = std::make_unique<Impl>();
  impl->file = file;
  impl->png = ends_with(file, ".png");
  if (!impl->png && !ends_with(file, ".svg"))
    return fail(Code::kInvalidInput, file + ": a picture is written as .svg or .png");
  impl->surface =
      impl->png ? cairo_image_surface_create(CAIRO_FORMAT_RGB24,
                                             static_cast<int>(std::ceil(width * pixels_per_unit)),
                                             static_cast<int>(std::ceil(height * pixels_per_unit)))
                : cairo_svg_surface_create(file.c_str(), width, height);
  impl->cr = cairo_create(impl->surface);
  if (const cairo_status_t status = cairo_status(impl->cr); status != CAIRO_STATUS_SUCCESS)
    return fail(Code::kRuntime, file + ": cannot be written (" + reason(status) + ")");
  if (impl->png) cairo_scale(impl->cr, pixels_per_unit, pixels_per_unit);
  Canvas canvas(std::move(impl));
  canvas.rectangle({0.0, 0.0, width, height}, {1, 1, 1});
  return canvas;
}

void Canvas::fill(const std::vector<std::vector<Vec2>>& outlines, const Color& color) {
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
  cairo_new_path(impl_->cr);
  impl_->path(points);
  impl_->use(pen);
  cairo_stroke(impl_->cr);
}

void Canvas::rectangle(const Box2& box, const Color& color) {
  cairo_new_path(impl_->cr);
  cairo_rectangle(impl_->cr, box.x, box.y, box.width, box.height);
  impl_->use(color);
  cairo_fill(impl_->cr);
}

void Canvas::circle(const Vec2& center, double radius, const Pen& pen) {
  cairo_new_path(impl_->cr);
  cairo_arc(impl_->cr, center.x(), center.y(), radius, 0.0, 2.0 * std::numbers::pi);
  impl_->use(pen);
  cairo_stroke(impl_->cr);
}

void Canvas::text(const Vec2& at, const std::string& text, const Font& font) {
  impl_->use(font);
  const double width = impl_->advance(text);
  const double share = font.align == Align::kLeft ? 0.0 : font.align == Align::kMiddle ? 0.5 : 1.0;
  cairo_move_to(impl_->cr, at.x() - share * width, at.y());
  cairo_show_text(impl_->cr, text.c_str());
  cairo_new_path(impl_->cr);
}

double Canvas::text_width(const std::string& text, const Font& font) const {
  impl_->use(font);
  return impl_->advance(text);
}

void Canvas::clip(const Box2& box) {
  cairo_save(impl_->cr);
  cairo_new_path(impl_->cr);
  cairo_rectangle(impl_->cr, box.x, box.y, box.width, box.height);
  cairo_clip(impl_->cr);
}

void Canvas::unclip() { cairo_restore(impl_->cr); }

Status Canvas::finish() {
  cairo_status_t status = CAIRO_STATUS_SUCCESS;
  if (impl_->png) {
    status = cairo_surface_write_to_png(impl_->surface, impl_->file.c_str());
  } else {
    cairo_surface_finish(impl_->surface);
    status = cairo_surface_status(impl_->surface);
  }
  if (status != CAIRO_STATUS_SUCCESS)
    return fail(Code::kRuntime, impl_->file + ": cannot be written (" + reason(status) + ")");
  return ok();
}

}  // namespace mortise
