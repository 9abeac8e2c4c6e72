#pragma once
#include <memory>
#include <string>
#include <vector>

#include "client/picture/sheet.h"
#include "common/base/result.h"

namespace mortise {

/// A sheet to draw on, as SVG or PNG; the only place that knows the drawing library. Points are
/// pixels from the upper left corner.
class Canvas {
 public:
  enum class Align { kLeft, kMiddle, kRight };
  enum class Format { kSvg, kPng };
  struct Font {
    double size = 13.0;
    bool bold = false;
    Color color;
    Align align = Align::kLeft;
  };

  /// White. A PNG has `pixels_per_unit` pixels a unit.
  Canvas(Format format, double width, double height, double pixels_per_unit);
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;
  ~Canvas();

  /// Several closed outlines as one area by the even-odd rule.
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

  /// Ends it; the bytes of its file.
  Result<std::string> finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mortise
