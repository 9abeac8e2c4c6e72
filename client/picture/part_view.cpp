#include "client/picture/part_view.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "client/picture/draw.h"
#include "client/picture/heat.h"
#include "common/messages/length_text.h"

namespace mortise {
namespace {

// A square of so many units for each view, a title above, and a share of it free around the part.
constexpr double kSide = 300.0, kTitle = 18.0, kRoom = 0.06;
constexpr double kPixelsPerUnit = 1.5;
// Labels in numbers; beyond, they hide each other.
constexpr std::size_t kLabels = 3;
constexpr double kSmallest = 4.0, kLargest = 13.0;  // radius of a mark

// Looks along `ahead`; x to the right, y up on the sheet.
struct View {
  Vec3 ahead, right, up;
  Vec3 center = Vec3::Zero();
  double scale = 1.0, left = 0.0;

  Vec2 operator()(const Vec3& x) const {
    const Vec3 d = x - center;
    return {left + 0.5 * kSide + scale * d.dot(right), kTitle + 0.5 * kSide - scale * d.dot(up)};
  }
};

View view_from(const Vec3& side, const BoundingSphere& sphere, double left) {
  View view;
  view.ahead = -side.normalized();
  const Vec3 up = std::fabs(view.ahead.z()) > 0.95 ? Vec3::UnitY() : Vec3::UnitZ();
  view.right = view.ahead.cross(up).normalized();
  view.up = view.right.cross(view.ahead);
  view.center = sphere.center_mm;
  view.scale = (0.5 - kRoom) * kSide / std::max(sphere.radius_mm, 1e-6);
  view.left = left;
  return view;
}

Color mixed(const Color& a, const Color& b, double share) {
  const auto mix = [&](double x, double y) { return x + share * (y - x); };
  return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

Color shaded(const Color& color, double light) { return mixed({0, 0, 0}, color, light); }

class PartView {
 public:
  PartView(const TriangleMesh& mesh, const SurfaceBand& band, const std::vector<ContactMark>& marks)
      : mesh_(mesh), band_(band), marks_(marks) {
    for (const ContactMark& mark : marks)
      if (!mark.face.empty()) {
        Heat& worst = of_face_[mark.face];
        worst = std::max(worst, heat_of(mark));
      }
  }

  void draw(Canvas& canvas, const View& view, const std::string& title) const {
    triangles(canvas, view);
    marks(canvas, view);
    canvas.text({view.left + 4.0, 13.0}, title, {11.0, false, kGrey, Canvas::Align::kLeft});
  }

 private:
  // Farthest first, so that the nearest are seen.
  void triangles(Canvas& canvas, const View& view) const {
    struct Seen {
      std::uint32_t triangle;
      double depth, light;
    };
    std::vector<Seen> seen;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const Vec3 &a = mesh_.corner(t, 0), &b = mesh_.corner(t, 1), &c = mesh_.corner(t, 2);
      const Vec3 n = (b - a).cross(c - a);
      const double area = n.norm();
      if (!(area > 0.0)) continue;
      const double facing = -n.dot(view.ahead) / area;
      if (facing <= 0.0) continue;
      seen.push_back({t, (a + b + c).dot(view.ahead), 0.55 + 0.45 * facing});
    }
    std::sort(seen.begin(), seen.end(),
              [](const Seen& x, const Seen& y) { return x.depth > y.depth; });
    constexpr Color kMetal{0.86, 0.88, 0.91};
    for (const Seen& s : seen) {
      const auto found = of_face_.find(band_.face_of(s.triangle).name);
      const Color color = found == of_face_.end() ? kMetal : color_of(found->second);
      const Color drawn = shaded(color, s.light);
      std::vector<Vec2> outline;
      for (int k = 0; k < 3; ++k) outline.push_back(view(mesh_.corner(s.triangle, k)));
      canvas.fill({outline}, drawn);
      // Closes the seam that anti-aliasing leaves between neighbours.
      outline.push_back(outline.front());
      canvas.line(outline, {drawn, 0.6});
    }
  }

  void marks(Canvas& canvas, const View& view) const {
    std::vector<std::size_t> order(marks_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) {
      return marks_[x].overlap_mm > marks_[y].overlap_mm;
    });
    for (std::size_t rank = order.size(); rank-- > 0;) {
      const ContactMark& mark = marks_[order[rank]];
      if (mark.out_P.dot(view.ahead) > 0.2) continue;  // on the other side
      const Vec2 at = view(mark.point_P);
      const double radius = kSmallest + (kLargest - kSmallest) * std::sqrt(heat_of(mark).share());
      const Color color = color_of(mark.collision_class);
      canvas.circle(at, radius, {{1, 1, 1}, 4.0});
      canvas.circle(at, radius, {color, 2.0});
      const std::string letter = mark.collision_class == CollisionClass::kReal        ? "R"
                                 : mark.collision_class == CollisionClass::kPotential ? "P"
                                                                                      : "F";
      canvas.text(at + Vec2(0.0, 3.2), letter, {9.0, true, color, Canvas::Align::kMiddle});
      if (rank >= kLabels) continue;
      const Canvas::Font font{11.0, true, kInk, Canvas::Align::kLeft};
      const std::string label = length_text(mark.overlap_mm);
      const Vec2 from = at + Vec2(radius + 4.0, 4.0);
      const double width = canvas.text_width(label, font);
      canvas.rectangle({from.x() - 2.0, from.y() - 11.0, width + 4.0, 14.0}, {1, 1, 1, 0.75});
      canvas.text(from, label, font);
    }
  }

  const TriangleMesh& mesh_;
  const SurfaceBand& band_;
  const std::vector<ContactMark>& marks_;
  std::map<std::string, Heat> of_face_;  // worst heat
};

}  // namespace

Result<std::string> part_picture(const TriangleMesh& mesh, const SurfaceBand& band,
                                 const std::vector<ContactMark>& marks) {
  const PartView view(mesh, band, marks);
  const auto deepest = std::max_element(
      marks.begin(), marks.end(),
      [](const ContactMark& x, const ContactMark& y) { return x.overlap_mm < y.overlap_mm; });
  // Somewhat from above and beside, so that the part is seen as a body.
  Vec3 side = Vec3(0.45, -0.6, 0.4);
  if (deepest != marks.end() && deepest->out_P.dot(side) < 0.0) side = -side;
  if (deepest != marks.end()) side += 0.5 * deepest->out_P;
  if (side.norm() < 0.2) side = Vec3(0.45, -0.6, 0.4);
  const BoundingSphere sphere = bounding_sphere(mesh);
  Canvas canvas(Canvas::Format::kPng, 2.0 * kSide, kSide + kTitle, kPixelsPerUnit);
  view.draw(canvas, view_from(side, sphere, 0.0), "from where the deepest is seen");
  view.draw(canvas, view_from(-side, sphere, kSide), "from the other side");
  return canvas.finish();
}

}  // namespace mortise
