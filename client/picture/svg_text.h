#pragma once
#include <string>
#include <vector>

#include "client/picture/sheet.h"

namespace mortise {

/// Writes an SVG as it is drawn. No ids, so that several fit into one page; coordinates to a
/// hundredth of a unit; text as text, stretched to its measured width.
class SvgText {
 public:
  struct Letters {
    double size = 13.0;
    bool bold = false;
    Color color;
  };

  void begin(double width, double height);
  /// Even-odd, as Canvas::fill.
  void fill(const std::vector<std::vector<Vec2>>& outlines, const Color& color);
  void line(const std::vector<Vec2>& points, const Pen& pen);
  void rectangle(const Box2& box, const Color& color);
  void circle(const Vec2& center, double radius, const Pen& pen);
  void text(const Vec2& baseline, double width, const std::string& text, const Letters& letters);
  void clip(const Box2& box);
  void unclip();
  std::string end();

 private:
  std::string out_;
};

}  // namespace mortise
