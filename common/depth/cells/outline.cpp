#include "common/depth/cells/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise::outline {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

// How far c is to the left of the way from a to b.
double left_mm(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 way = b - a;
  const double length = way.norm();
  return length > 0.0 ? cross(way, c - a) / length : 0.0;
}

std::size_t before(std::size_t i, std::size_t n) { return i == 0 ? n - 1 : i - 1; }
std::size_t after(std::size_t i, std::size_t n) { return i + 1 == n ? 0 : i + 1; }

bool is_hollow(const Piece& piece, std::size_t i, double same_mm) {
  const std::size_t n = piece.size();
  return left_mm(piece[before(i, n)].at, piece[i].at, piece[after(i, n)].at) < -same_mm;
}

bool is_convex(const Piece& piece, double same_mm) {
  for (std::size_t i = 0; i < piece.size(); ++i)
    if (is_hollow(piece, i, same_mm)) return false;
  return true;
}

bool holds(const Piece& convex, const Vec2& x) {
  for (std::size_t i = 0; i < convex.size(); ++i)
    if (left_mm(convex[i].at, convex[after(i, convex.size())].at, x) <= 0.0) return false;
  return true;
}

// Cuts off what lies between one hollow corner and the next where that is convex and holds nothing
// else. False: nothing was cut.
bool cut_once(Piece& rest, std::vector<Piece>& pieces, double same_mm) {
  const std::size_t n = rest.size();
  std::vector<std::size_t> hollow;
  for (std::size_t i = 0; i < n; ++i)
    if (is_hollow(rest, i, same_mm)) hollow.push_back(i);
  if (hollow.size() < 2) return false;
  Piece left;
  bool any = false;
  for (std::size_t h = 0; h < hollow.size(); ++h) {
    const std::size_t from = hollow[h], to = hollow[after(h, hollow.size())];
    Piece piece;
    for (std::size_t i = from; i != to; i = after(i, n)) piece.push_back(rest[i]);
    const std::size_t chain = piece.size();
    piece.push_back({rest[to].at, Corner::kCut, Corner::kCut});
    bool cuts = chain >= 2 && is_convex(piece, same_mm);
    for (std::size_t i = after(to, n); cuts && i != from; i = after(i, n))
      cuts = !holds(piece, rest[i].at);
    if (!cuts) {
      left.insert(left.end(), piece.begin(), piece.end() - 1);
      continue;
    }
    left.push_back({rest[from].at, Corner::kCut, pieces.size()});
    pieces.push_back(std::move(piece));
    any = true;
  }
  rest = std::move(left);
  return any;
}

// Takes back each cut without which the piece is convex, too.
void join(Piece& piece, std::vector<Piece>& pieces, double same_mm) {
  for (std::size_t i = 0; i < piece.size();) {
    const std::size_t beyond = piece[i].beyond;
    if (!piece[i].is_cut() || beyond == Corner::kCut) {
      ++i;
      continue;
    }
    const Piece& other = pieces[beyond];
    Piece joined(piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(i));
    joined.insert(joined.end(), other.begin(), other.end() - 1);
    joined.insert(joined.end(), piece.begin() + static_cast<std::ptrdiff_t>(i) + 1, piece.end());
    if (is_convex(joined, same_mm)) {
      piece = std::move(joined);
      pieces[beyond].clear();
    } else {
      ++i;
    }
  }
}

}  // namespace

Vec2 outward(const Vec2& a, const Vec2& b) {
  const Vec2 way = b - a;
  return Vec2(way.y(), -way.x()).normalized();
}

double area(const std::vector<Vec2>& corners) {
  double twice = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    twice += cross(corners[i], corners[after(i, corners.size())]);
  return 0.5 * twice;
}

double distance(const Vec2& x, const Vec2& a, const Vec2& b) {
  const Vec2 way = b - a;
  const double square = way.squaredNorm();
  const double s = square > 0.0 ? std::clamp((x - a).dot(way) / square, 0.0, 1.0) : 0.0;
  return (a + s * way - x).norm();
}

bool is_within(const std::vector<Vec2>& corners, const Vec2& a, const Vec2& b, double slack_mm) {
  const std::size_t n = corners.size();
  const Vec2 middle = 0.5 * (a + b);
  bool inside = false;
  double nearest = std::numeric_limits<double>::infinity(), of_middle = nearest;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &p = corners[i], &q = corners[after(i, n)];
    if ((p.y() > middle.y()) != (q.y() > middle.y()) &&
        middle.x() < p.x() + (middle.y() - p.y()) / (q.y() - p.y()) * (q.x() - p.x()))
      inside = !inside;
    const double reach = std::fabs(slack_mm);
    if ((p.cwiseMin(q) - a.cwiseMax(b)).maxCoeff() > reach ||
        (a.cwiseMin(b) - p.cwiseMax(q)).maxCoeff() > reach)
      continue;  // farther away than matters
    const bool crosses = cross(b - a, p - a) * cross(b - a, q - a) < 0.0 &&
                         cross(q - p, a - p) * cross(q - p, b - p) < 0.0;
    // Who crosses the border by no more than the slack ends that near to it.
    const double ends = std::min(distance(a, p, q), distance(b, p, q));
    if (crosses && ends > slack_mm) return false;
    nearest = std::min({nearest, ends, distance(p, a, b), distance(q, a, b)});
    of_middle = std::min(of_middle, distance(middle, p, q));
  }
  return slack_mm < 0.0 ? inside && nearest >= -slack_mm : inside || of_middle <= slack_mm;
}

std::vector<Piece> convex_pieces(const std::vector<Vec2>& corners, double same_mm) {
  Piece rest;
  for (std::size_t i = 0; i < corners.size(); ++i) rest.push_back({corners[i], i, Corner::kCut});
  std::vector<Piece> pieces;
  while (!is_convex(rest, same_mm))
    if (!cut_once(rest, pieces, same_mm)) return {};
  pieces.push_back(std::move(rest));
  for (std::size_t i = pieces.size(); i-- > 0;) {
    Piece piece = std::move(pieces[i]);
    join(piece, pieces, same_mm);
    pieces[i] = std::move(piece);
  }
  std::erase_if(pieces, [](const Piece& piece) { return piece.empty(); });
  return pieces;
}

std::vector<Vec2> within(const std::vector<Line>& lines) {
  double far = 0.0;
  for (const Line& line : lines) far = std::max(far, std::fabs(line.c_mm));
  far = 1e3 * (far + 1.0);
  std::vector<Vec2> polygon = {{-far, -far}, {far, -far}, {far, far}, {-far, far}}, cut;
  for (const Line& line : lines) {
    cut.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 &p = polygon[i], &q = polygon[after(i, polygon.size())];
      const double at_p = line.n.dot(p) - line.c_mm, at_q = line.n.dot(q) - line.c_mm;
      if (at_p <= 0.0) cut.push_back(p);
      if ((at_p < 0.0 && at_q > 0.0) || (at_p > 0.0 && at_q < 0.0))
        cut.push_back(p + at_p / (at_p - at_q) * (q - p));
    }
    polygon.swap(cut);
    if (polygon.size() < 3) return {};
  }
  return polygon;
}

}  // namespace mortise::outline
