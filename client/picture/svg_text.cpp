#include "client/picture/svg_text.h"

#include <fmt/format.h>

#include <cmath>

namespace mortise {
namespace {

// Hundredths, without what says nothing: "12", "-0.5".
std::string number(double x) {
  std::string text = fmt::format("{:.2f}", std::isfinite(x) ? x : 0.0);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  if (text == "-0") text.erase(0, 1);
  return text;
}

std::string rgb(const Color& c) {
  const auto part = [](double x) { return static_cast<int>(std::lround(255.0 * x)); };
  return fmt::format("#{:02x}{:02x}{:02x}", part(c.red), part(c.green), part(c.blue));
}

std::string filled(const Color& c) {
  return std::string(" fill=\"") + rgb(c) + "\"" +
         (c.alpha < 1.0 ? " fill-opacity=\"" + number(c.alpha) + "\"" : "");
}

std::string stroked(const Pen& pen) {
  std::string text = " fill=\"none\" stroke=\"" + rgb(pen.color) + "\" stroke-width=\"" +
                     number(pen.width) + "\" stroke-linejoin=\"round\"";
  if (pen.color.alpha < 1.0) text += " stroke-opacity=\"" + number(pen.color.alpha) + "\"";
  if (pen.dashes.empty()) return text;
  text += " stroke-dasharray=\"";
  for (const double dash : pen.dashes) text += number(dash) + " ";
  text.back() = '"';
  if (pen.dash_from != 0.0) text += " stroke-dashoffset=\"" + number(pen.dash_from) + "\"";
  return text;
}

// Does the middle one say nothing, at a hundredth of a unit?
bool is_between(const Vec2& a, const Vec2& x, const Vec2& b) {
  const Vec2 ab = b - a, ax = x - a;
  const double along = ax.dot(ab);
  if (along < 0.0 || along > ab.squaredNorm()) return false;
  return std::fabs(ab.x() * ax.y() - ab.y() * ax.x()) <= 0.005 * ab.norm();
}

std::string path(const std::vector<Vec2>& points) {
  std::string text;
  Vec2 before = Vec2::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool inner = i > 0 && i + 1 < points.size();
    if (inner && is_between(before, points[i], points[i + 1])) continue;
    text +=
        fmt::format("{}{} {}", i == 0 ? 'M' : 'L', number(points[i].x()), number(points[i].y()));
    before = points[i];
  }
  return text;
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (static_cast<unsigned char>(c) >= 0x20)  // XML has no word for the others
      safe += c;
  }
  return safe;
}

std::string box_of(const Box2& box) {
  return fmt::format(" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"", number(box.x), number(box.y),
                     number(box.width), number(box.height));
}

}  // namespace

void SvgText::begin(double width, double height) {
  out_ = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\" font-family=\"DejaVu Sans, Verdana, sans-serif\">\n",
      number(width), number(height));
}

void SvgText::fill(const std::vector<std::vector<Vec2>>& outlines, const Color& color) {
  std::string d;
  for (const auto& outline : outlines)
    if (const std::string piece = path(outline); !piece.empty()) d += piece + "Z";
  if (!d.empty()) out_ += "<path d=\"" + d + "\" fill-rule=\"evenodd\"" + filled(color) + "/>\n";
}

void SvgText::line(const std::vector<Vec2>& points, const Pen& pen) {
  if (points.size() > 1) out_ += "<path d=\"" + path(points) + "\"" + stroked(pen) + "/>\n";
}

void SvgText::rectangle(const Box2& box, const Color& color) {
  out_ += "<rect" + box_of(box) + filled(color) + "/>\n";
}

void SvgText::circle(const Vec2& center, double radius, const Pen& pen) {
  out_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>\n", number(center.x()),
                      number(center.y()), number(radius), stroked(pen));
}

void SvgText::text(const Vec2& baseline, double width, const std::string& text,
                   const Letters& letters) {
  if (text.empty()) return;
  out_ += fmt::format(
      "<text x=\"{}\" y=\"{}\" textLength=\"{}\" lengthAdjust=\"spacingAndGlyphs\" "
      "font-size=\"{}\"{}{}>{}</text>\n",
      number(baseline.x()), number(baseline.y()), number(width), number(letters.size),
      letters.bold ? " font-weight=\"bold\"" : "", filled(letters.color), escaped(text));
}

void SvgText::clip(const Box2& box) {
  out_ += fmt::format("<svg{} viewBox=\"{} {} {} {}\">\n", box_of(box), number(box.x),
                      number(box.y), number(box.width), number(box.height));
}

void SvgText::unclip() { out_ += "</svg>\n"; }

std::string SvgText::end() {
  out_ += "</svg>\n";
  return std::move(out_);
}

}  // namespace mortise
