#include "client/report/pictures.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "client/picture/part_view.h"
#include "client/picture/picture.h"
#include "client/report/cells.h"
#include "client/report/moments.h"
#include "client/report/pair_groups.h"

namespace mortise {
namespace {

// What is drawn of one part in the end.
struct MarkedPart {
  SolidPtr solid;
  SurfaceBand band;
  std::vector<ContactMark> marks;
  double deepest_mm() const {
    double deepest = 0.0;
    for (const ContactMark& mark : marks) deepest = std::max(deepest, mark.overlap_mm);
    return deepest;
  }
  CollisionClass worst() const {
    CollisionClass worst = CollisionClass::kNone;
    for (const ContactMark& mark : marks) worst = std::max(worst, mark.collision_class);
    return worst;
  }
};

// The worst of each pair first, then their other places.
std::vector<std::uint64_t> drawing_order(const Table& clashes) {
  std::vector<std::uint64_t> order, others;
  const auto number = [&](std::size_t row) {
    return Cells(clashes, clashes.rows[row])["clash"].get<std::uint64_t>();
  };
  for (const PairGroup& group : pair_groups(clashes)) {
    order.push_back(number(group.lead));
    for (const std::size_t row : group.others) others.push_back(number(row));
  }
  order.insert(order.end(), others.begin(), others.end());
  return order;
}

class Drawing {
 public:
  Drawing(Pictures& pictures, std::set<std::uint64_t> drawn, bool png)
      : pictures_(pictures), drawn_(std::move(drawn)), png_(png) {}

  void take(const Moment& moment) {
    const ClashEvent& event = moment.event;
    const Verdict& verdict = event.verdict;
    const Part& a = *moment.world.find(event.part_a);
    const Part& b = *moment.world.find(event.part_b);
    const Vec3 p_A = a.X_WP.inverse() * verdict.point_W, p_B = b.X_WP.inverse() * verdict.point_W;
    pictures_.touches[event.clash.value] = {
        p_A, p_B, std::min(a.solid->sphere().radius_mm, b.solid->sphere().radius_mm)};
    pictures_.circumstances[event.clash.value] = circumstances_at(moment);
    // The normal of a verdict leads from B to A: out of the material of B, into that of A.
    mark(a, p_A, -(a.X_WP.q.conjugate() * verdict.normal_W), verdict, verdict.face_a);
    mark(b, p_B, b.X_WP.q.conjugate() * verdict.normal_W, verdict, verdict.face_b);
    if (!drawn_.contains(event.clash.value)) return;
    const RegionQuery query{&moment.world, event.part_a, event.part_b, &verdict};
    if (auto svg = region_picture(query, Canvas::Format::kSvg))
      pictures_.of_clash[event.clash.value] = std::move(*svg);
    if (!png_) return;
    if (auto png = region_picture(query, Canvas::Format::kPng))
      pictures_.png_of_clash[event.clash.value] = std::move(*png);
  }

  void draw_parts(std::size_t most) {
    std::vector<const std::pair<const std::string, MarkedPart>*> order;
    for (const auto& row : parts_) order.push_back(&row);
    std::stable_sort(order.begin(), order.end(), [](const auto* x, const auto* y) {
      const auto rank = [](const MarkedPart& part) {
        return std::pair(part.worst(), part.deepest_mm());
      };
      return rank(x->second) > rank(y->second);
    });
    for (const auto* row : order) {
      const MarkedPart& part = row->second;
      if (pictures_.of_part.size() >= most) {
        ++pictures_.parts_left_out;
        continue;
      }
      if (auto png = part_picture(part.solid->mesh(), part.band, part.marks))
        pictures_.of_part.push_back(
            {row->first, std::move(*png), part.deepest_mm(), part.marks.size()});
    }
  }

 private:
  void mark(const Part& part, const Vec3& p, const Vec3& out_P, const Verdict& verdict,
            const std::string& face) {
    MarkedPart& marked = parts_[part.name];
    if (!marked.solid) marked.solid = part.solid, marked.band = part.band;
    const double overlap_mm = std::max(0.0, verdict.delta_mm.lo);
    marked.marks.push_back({p, out_P, overlap_mm, verdict.fake_below_mm, verdict.real_above_mm,
                            verdict.collision_class, face});
  }

  Pictures& pictures_;
  std::set<std::uint64_t> drawn_;
  bool png_;
  std::map<std::string, MarkedPart> parts_;
};

}  // namespace

Pictures pictures_of(const SessionLog& log, const Table& clashes, const PictureLimits& limits,
                     const std::function<void(double share)>& on_progress) {
  Pictures pictures;
  const std::vector<std::uint64_t> order = drawing_order(clashes);
  const std::size_t drawn = std::min(order.size(), limits.clashes);
  EventKeys wanted;
  for (const auto& cells : clashes.rows) {
    const Cells clash(clashes, cells);
    wanted.insert(
        {clash["worst_tick"].get<std::uint64_t>(), ClashId{clash["clash"].get<std::uint32_t>()}});
  }
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>(drawn);
  Drawing drawing(pictures, {order.begin(), middle}, limits.png);
  // Parts are drawn last, and are fewer.
  constexpr double kMomentsShare = 0.8;
  const Status done = for_moments(log, wanted, [&](const Moment& moment) {
    drawing.take(moment);
    if (on_progress)
      on_progress(kMomentsShare * static_cast<double>(pictures.touches.size()) /
                  static_cast<double>(wanted.size()));
  });
  if (!done) {
    pictures.missing = done.error().text;
    return pictures;
  }
  drawing.draw_parts(limits.parts);
  if (on_progress) on_progress(1.0);
  pictures.clashes_left_out = order.size() - pictures.of_clash.size();
  return pictures;
}

}  // namespace mortise
