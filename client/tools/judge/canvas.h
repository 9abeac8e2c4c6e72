#pragma once
#include <memory>
#include <string>
#include <vector>

#include "client/tools/judge/section.h"
#include "common/base/result.h"

namespace mortise {

struct Color {
  double red = 0.0, green = 0.0, blue = 0.0, alpha = 1.0;
  Color faded(double share) const { return {red, green, blue, alpha * share}; }
};

struct Pen {
  Color color;
  double width = 1.0;
  std::vector<double> dashes = {};
  double dash_from = 0.0;  ///< how far into the dashes a line begins
};

struct Box2 {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
};

/// A sheet to draw on, written as SVG or PNG; the only place that knows the drawing library. Points
/// are pixels from the upper left corner.
class Canvas {
 public:
  enum class Align { kLeft, kMiddle, kRight };
  struct Font {
    double size = 13.0;
    bool bold = false;
    Color color;
    Align align = Align::kLeft;
  };

  /// The name ends in .svg or .png. A PNG has `pixels_per_unit` pixels a unit.
  static Result<Canvas> open(const std::string& file, double width, double height,
                             double pixels_per_unit);
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;
  ~Canvas();

  /// Several closed outlines as one area: what an even number of them encloses is not part of it.
  void fill(const std::vector<std::vector<Vec2>>& outlines, const Color& color);
  void line(const std::vector<Vec2>& points, const Pen& pen);
  void rectangle(const Box2& box, const Color& color);
  void circle(const Vec2& center, double radius, const Pen& pen);
  /// Baseline at `at`.
  void text(const Vec2& at, const std::string& text, const Font& font);
  double text_width(const std::string& text, const Font& font) const;
  /// Until unclip() nothing is drawn outside; not nested.
  void clip(const Box2& box);
  void unclip();

  /// Writes the file; an error says what went wrong.
  Status finish();

 private:
  struct Impl;
  explicit Canvas(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace mortise
