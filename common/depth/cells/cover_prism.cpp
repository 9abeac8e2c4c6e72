#include "common/depth/cells/cover_prism.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "common/depth/cells/outline.h"

namespace mortise {
namespace {

// Plane faces whose outline is tried, the largest first.
constexpr std::size_t kMostOutlines = 3;
// Sides of an outline; and sides times triangles that are compared, some 0.1 s.
constexpr std::size_t kMostSides = 2'000, kMostCompared = 20'000'000;
constexpr std::size_t kMostOutlinePieces = 160;
// Normals that differ by less are parallel, or at right angles.
constexpr double kParallelSides = 1e-9;
// Of a piece with no more sides each round one is followed by so many tangents: tips of teeth.
constexpr std::size_t kFewSides = 32, kTangents = 4;
// Sides go on into each other smoothly whose normals have a larger cosine: but for 1.2 degrees.
constexpr double kSmoothSides = 0.9998;
// Cells go on into each other by so many times what any face may be off.
constexpr double kIntoNext = 4.0;

class Prism {
 public:
  Prism(const CoverFaces& faces, const PlaneFace& cap) : f_(faces), axis_(cap.n) {
    e1_ = axis_.unitOrthogonal();
    e2_ = axis_.cross(e1_);
    height_ = {kInfinity, -kInfinity};
    for (const Vec3& x : f_.mesh().points_mm) {
      const double z = axis_.dot(x);
      height_ = hull(height_, {z, z});
    }
    is_whole_ = cap.c >= height_.hi - f_.same_mm;
  }

  Outside run() {
    Outside outside;
    if (!is_whole_ || !find_outline() || !set_sides() || !rest_is_inside()) return outside;
    const std::vector<outline::Piece> pieces = outline::convex_pieces(corners_, f_.same_mm);
    if (pieces.empty() || pieces.size() > kMostOutlinePieces) return outside;
    join_smooth();
    const LayerOffsets upper = end_offsets(1.0, height_.hi), lower = end_offsets(-1.0, -height_.lo);
    for (int layer = 0; layer < 2; ++layer) {
      const Interval along{height_.lo - lower[layer], height_.hi + upper[layer]};
      outside.volume_mm3 = 0.0;
      for (const outline::Piece& piece : pieces) {
        const std::vector<Vec2> polygon = outline::within(lines_of(piece, layer));
        const auto cell = prism_cell({e1_, e2_, axis_}, polygon, along);
        if (!cell) return {};
        outside.cells[layer].push_back(*cell);
        outside.volume_mm3 += outline::area(polygon) * along.width();
      }
    }
    return outside;
  }

 private:
  struct Side {
    bool found = false;
    LayerOffsets from_chord{}, from_round{};  // outward
    const Surface* round = nullptr;           // its face: an outer cylinder along the axis
  };

  Vec2 flat(const Vec3& x) const { return {e1_.dot(x), e2_.dot(x)}; }
  bool is_cap(std::uint32_t t) const {
    for (int k = 0; k < 3; ++k)
      if (axis_.dot(f_.mesh().corner(t, k)) < height_.hi - f_.same_mm) return false;
    // Corners at the upper end alone: the normal is the axis itself, or across it.
    return f_.body.normal(t).dot(axis_) > 0.5;
  }

  // The longest way around the triangles of the upper end.
  bool find_outline() {
    std::map<std::uint32_t, std::uint32_t> next;
    const Topology& topology = f_.body.solid->topology();
    std::vector<bool> caps(f_.count());
    for (std::uint32_t t = 0; t < f_.count(); ++t) caps[t] = is_cap(t);
    for (std::uint32_t t = 0; t < f_.count(); ++t)
      for (int k = 0; caps[t] && k < 3; ++k) {
        const std::uint32_t across = topology.neighbor[t][k];
        if (across == Topology::kNone) return false;
        if (caps[across]) continue;
        const auto& points = f_.mesh().triangles[t];
        if (!next.emplace(points[k], points[(k + 1) % 3]).second) return false;
      }
    double most = 0.0;
    while (!next.empty()) {
      std::vector<Vec2> loop;
      for (auto at = next.begin(); at != next.end();) {
        loop.push_back(flat(f_.mesh().points_mm[at->first]));
        const std::uint32_t to = at->second;
        next.erase(at);
        at = next.find(to);
      }
      if (const double area = outline::area(loop); area > most) {
        most = area;
        corners_ = std::move(loop);
      }
    }
    return corners_.size() >= 3 && corners_.size() <= kMostSides;
  }

  // Walls along the axis, each on one side of the outline; all other triangles but those at the end
  // are the rest.
  bool set_sides() {
    sides_.assign(corners_.size(), {});
    if (corners_.size() * f_.count() > kMostCompared) return false;
    for (std::uint32_t t = 0; t < f_.count(); ++t) {
      if (is_cap(t)) continue;
      const std::optional<std::size_t> side =
          std::fabs(f_.body.normal(t).dot(axis_)) < kParallelSides ? side_of(t) : std::nullopt;
      if (side)
        add_wall(sides_[*side], t);
      else
        rest_.push_back(t);
    }
    return std::all_of(sides_.begin(), sides_.end(), [](const Side& side) { return side.found; });
  }

  std::optional<std::size_t> side_of(std::uint32_t t) const {
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Vec2 &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
      bool on_side = true;
      for (int k = 0; on_side && k < 3; ++k)
        on_side = outline::distance(flat(f_.mesh().corner(t, k)), a, b) <= f_.same_mm;
      if (on_side) return i;
    }
    return std::nullopt;
  }

  void add_wall(Side& side, std::uint32_t t) {
    const Surface* s = f_.surface(t);
    const LayerOffsets offsets = f_.offsets(t);
    const double bulge_mm = s != nullptr ? f_.bulge_mm(t) : 0.0;
    const LayerOffsets from_chord{offsets[0] + bulge_mm, offsets[1] + bulge_mm};
    const bool round = s != nullptr && s->kind == SurfaceKind::kCylinder && !s->inward &&
                       s->axis.cross(axis_).norm() < kParallelSides;
    side.round = round && (!side.found || side.round == s) ? s : nullptr;
    side.from_round = side.found ? larger(side.from_round, offsets) : offsets;
    side.from_chord = side.found ? larger(side.from_chord, from_chord) : from_chord;
    side.found = true;
    for (const double offset : from_chord) widest_mm_ = std::max(widest_mm_, std::fabs(offset));
  }

  // Where a side goes over into another one neither trims the other.
  void join_smooth() {
    const std::vector<Side> own = sides_;
    const auto is_one = [&](std::size_t i, std::size_t k) {
      return i == k || (own[i].round != nullptr && own[i].round == own[k].round);
    };
    const auto normal = [&](std::size_t i, const Vec2& x) {
      if (own[i].round != nullptr) return Vec2((x - flat(own[i].round->point)).normalized());
      return outline::outward(corners_[i], corners_[(i + 1) % corners_.size()]);
    };
    const auto raise = [&](std::size_t i, const Side& other) {
      const LayerOffsets& out = other.round != nullptr ? other.from_round : other.from_chord;
      for (std::size_t k = 0; k < sides_.size(); ++k) {
        if (!is_one(i, k)) continue;
        const double bulge_mm = own[k].from_chord[0] - own[k].from_round[0];
        sides_[k].from_round = larger(sides_[k].from_round, out);
        sides_[k].from_chord = larger(sides_[k].from_chord, {out[0] + bulge_mm, out[1] + bulge_mm});
      }
    };
    // Along flat sides it goes on to the next one.
    const auto after = [&](std::size_t i) { return (i + 1) % own.size(); };
    for (std::size_t i = 0; i < own.size(); ++i) {
      const Vec2 n = normal(i, corners_[after(i)]);
      for (std::size_t k = after(i); k != i; k = after(k)) {
        if (n.dot(normal(k, corners_[k])) <= kSmoothSides) break;
        if (!is_one(i, k)) {
          raise(i, own[k]);
          raise(k, own[i]);
        }
        if (own[k].round != nullptr) break;
      }
    }
  }

  // What is neither a wall nor an end is inside of the outline, and stays there however its face is
  // moved, or it ends on the outline.
  bool rest_is_inside() const {
    if (rest_.size() * corners_.size() > kMostCompared) return false;
    return std::all_of(rest_.begin(), rest_.end(), [&](std::uint32_t t) {
      const double clear_mm = widest_mm_ + f_.reach_mm(t) + f_.bulge_mm(t) + f_.same_mm;
      const bool is_end = std::fabs(f_.body.normal(t).dot(axis_)) > 1.0 - kParallelSides;
      for (int k = 0; k < 3; ++k) {
        const Vec2 a = flat(f_.mesh().corner(t, k)), b = flat(f_.mesh().corner(t, (k + 1) % 3));
        if (is_end ? !outline::is_within(corners_, a, b, f_.same_mm)
                   : !outline::is_within(corners_, a, b, -clear_mm))
          return false;
      }
      return true;
    });
  }

  LayerOffsets end_offsets(double sign, double c_mm) const {
    return f_.border(sign * axis_, c_mm).offsets;
  }

  std::vector<outline::Line> lines_of(const outline::Piece& piece, int layer) const {
    std::vector<outline::Line> lines;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      const Vec2 &a = piece[i].at, &b = piece[(i + 1) % piece.size()].at;
      outline::Line line{outline::outward(a, b), 0.0};
      line.c_mm = reach_of(piece, line.n);
      if (piece[i].is_cut()) {
        line.c_mm += kIntoNext * std::max(widest_mm_, f_.travel_mm);
        lines.push_back(line);
        continue;
      }
      const Side& side = sides_[piece[i].side];
      line.c_mm += side.from_chord[layer];
      if (side.round == nullptr || piece.size() > kFewSides)
        lines.push_back(line);
      else
        add_tangents(piece, i, side.from_round[layer], lines);
    }
    return lines;
  }

  // Corners are convex only as closely as places are told apart; none is cut off.
  static double reach_of(const outline::Piece& piece, const Vec2& n) {
    double most = -kInfinity;
    for (const outline::Corner& corner : piece) most = std::max(most, n.dot(corner.at));
    return most;
  }

  // Of a round side: those below which the piece is.
  void add_tangents(const outline::Piece& piece, std::size_t i, double out_mm,
                    std::vector<outline::Line>& lines) const {
    const Surface& s = *sides_[piece[i].side].round;
    const Vec2 &a = piece[i].at, &b = piece[(i + 1) % piece.size()].at, middle = flat(s.point);
    for (std::size_t k = 0; k <= kTangents; ++k) {
      const double share = static_cast<double>(k) / kTangents;
      const Vec2 n = (a + share * (b - a) - middle).normalized();
      const double c_mm = n.dot(middle) + s.radius_mm;
      const double reach = reach_of(piece, n);
      if (reach <= c_mm + f_.same_mm) lines.push_back({n, std::max(c_mm, reach) + out_mm});
    }
  }

  const CoverFaces& f_;
  Vec3 axis_, e1_, e2_;
  Interval height_;
  bool is_whole_ = false;
  std::vector<Vec2> corners_;  // of the outline, counter-clockwise seen against the axis
  std::vector<Side> sides_;    // from corner i to the next
  std::vector<std::uint32_t> rest_;
  double widest_mm_ = 0.0;  // no wall is farther off, inwards or outwards
};

}  // namespace

Outside prism_outside(const CoverFaces& f) {
  std::vector<double> area(f.planes.faces.size(), 0.0);
  for (std::uint32_t t = 0; t < f.count(); ++t)
    if (const std::uint32_t face = f.planes.face_of_triangle[t]; face < area.size())
      area[face] += (f.mesh().corner(t, 1) - f.mesh().corner(t, 0))
                        .cross(f.mesh().corner(t, 2) - f.mesh().corner(t, 0))
                        .norm();
  std::vector<std::size_t> order(area.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return area[a] > area[b]; });
  for (std::size_t i = 0; i < std::min(kMostOutlines, order.size()); ++i) {
    Outside outside = Prism(f, f.planes.faces[order[i]]).run();
    if (!outside.cells[1].empty()) return outside;
  }
  return {};
}

}  // namespace mortise
