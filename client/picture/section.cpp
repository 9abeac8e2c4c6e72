#include "client/picture/section.h"

#include <array>
#include <map>
#include <optional>
#include <utility>

namespace mortise {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // lower point first

struct Piece {
  Edge from, to;
  Vec2 at_from, at_to;
  std::uint32_t triangle = 0;
};

class Cut {
 public:
  Cut(const TriangleMesh& mesh, const Pose& X_WP, const CutPlane& plane)
      : mesh_(mesh), plane_(plane) {
    const Vec3 normal = plane.normal_W();
    points_.reserve(mesh.points_mm.size());
    for (const Vec3& x : mesh.points_mm) {
      const Vec3 x_W = X_WP * x;
      points_.push_back(x_W);
      heights_.push_back((x_W - plane.origin_W).dot(normal));
    }
  }

  std::vector<CutLine> run() {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) add_triangle(t);
    // Lines that begin at an open edge first, then the closed ones.
    std::map<Edge, int> ends;
    for (const Piece& piece : pieces_) ++ends[piece.to];
    std::vector<CutLine> lines;
    for (const bool open : {true, false})
      for (std::size_t i = 0; i < pieces_.size(); ++i)
        if (!used_[i] && !(open && ends[pieces_[i].from] > 0)) lines.push_back(follow(i));
    return lines;
  }

 private:
  Vec2 crossing(const Edge& edge) const {
    const double a = heights_[edge.first], b = heights_[edge.second];
    const Vec3 x = points_[edge.first] + a / (a - b) * (points_[edge.second] - points_[edge.first]);
    return plane_.project(x);
  }

  // Pieces run so that the next one begins at the edge at which this one ends.
  void add_triangle(std::uint32_t t) {
    const auto& c = mesh_.triangles[t];
    std::optional<Edge> from, to;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = c[k], b = c[(k + 1) % 3];
      const bool above_a = heights_[a] >= 0.0, above_b = heights_[b] >= 0.0;
      if (above_a == above_b) continue;
      (above_b ? from : to) = Edge{std::min(a, b), std::max(a, b)};
    }
    if (!from || !to) return;
    by_start_[*from].push_back(pieces_.size());
    pieces_.push_back({*from, *to, crossing(*from), crossing(*to), t});
    used_.push_back(0);
  }

  CutLine follow(std::size_t i) {
    CutLine line;
    const Edge start = pieces_[i].from;
    line.points.push_back(pieces_[i].at_from);
    while (true) {
      used_[i] = 1;
      line.points.push_back(pieces_[i].at_to);
      line.triangles.push_back(pieces_[i].triangle);
      if (pieces_[i].to == start) {
        line.closed = true;
        return line;
      }
      const auto next = by_start_.find(pieces_[i].to);
      bool found = false;
      if (next != by_start_.end())
        for (const std::size_t j : next->second)
          if (!used_[j] && !found) {
            found = true;
            i = j;
          }
      if (!found) return line;
    }
  }

  const TriangleMesh& mesh_;
  const CutPlane& plane_;
  std::vector<Vec3> points_;
  std::vector<double> heights_;
  std::vector<Piece> pieces_;
  std::vector<char> used_;
  std::map<Edge, std::vector<std::size_t>> by_start_;
};

}  // namespace

std::vector<CutLine> cut_lines(const TriangleMesh& mesh, const Pose& X_WP, const CutPlane& plane) {
  return Cut(mesh, X_WP, plane).run();
}

std::vector<Vec2> clipped(const std::vector<Vec2>& polygon, const Vec2& normal, double offset_mm) {
  std::vector<Vec2> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = a.dot(normal) - offset_mm, db = b.dot(normal) - offset_mm;
    if (da >= 0.0) kept.push_back(a);
    if ((da >= 0.0) != (db >= 0.0)) kept.push_back(a + da / (da - db) * (b - a));
  }
  return kept;
}

}  // namespace mortise
