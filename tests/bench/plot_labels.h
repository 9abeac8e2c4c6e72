#pragma once
#include <string>
#include <vector>

namespace mortise::bench {

/// A rectangle of the picture, in pixels from the lower left of the plotted area.
struct PixelBox {
  double x0, y0, x1, y1;
  bool meets(const PixelBox& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

/// Where the text of one mark goes: beside, above or below it, on either side.
struct Placed {
  double x, y;  ///< pixels, of the end of the text that is near the mark, half height
  bool to_the_left;
};

/// Puts texts beside their marks, one after another, where they cover neither taken places nor each
/// other; when there is no such place, where they cover least.
class LabelPlaces {
 public:
  LabelPlaces(double width, double height) : width_(width), height_(height) {}
  void take(const PixelBox& box) { taken_.push_back(box); }
  Placed place(double x, double y, const std::string& text);

 private:
  double width_, height_;
  std::vector<PixelBox> taken_;
};

}  // namespace mortise::bench
