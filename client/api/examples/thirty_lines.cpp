// A session in this process: a peg is pushed into its hole, with a fit and without one.
#include <mortise/judge.h>
#include <mortise/session.h>

#include <cstdio>

using namespace mortise;

namespace {

int push_in(const char* code) {
  const auto plate = Part::generate("plate_with_bore", {{"bore_mm", 20}, {"facets", 32}}, "plate");
  const auto peg = Part::generate("dowel",
                                  {{"diameter_mm", 20},
                                   {"length_mm", 40},
                                   {"chamfer_mm", 1},
                                   {"facets", 32},
                                   {"phase_rad", 0.0981747704246810387}},
                                  "peg");
  Session s;
  const PartRef in_plate = s.add_fixed(plate);
  const PartRef in_hand = s.add(peg, Pose(Eigen::Translation3d(0, 0, 30)));
  if (*code != '\0') s.fit(in_plate, "bore", in_hand, "journal", code);
  s.hold("ann", in_hand);
  const Pose down(Eigen::Translation3d(0, 0, -1));
  Pushed last;
  for (int i = 0; i < 25 && s.status(); ++i) last = s.push(in_hand, down);
  if (!s.status()) return std::puts(s.status().error().text.c_str()), 3;
  std::printf("%s: the peg stands at z = %.3f mm\n", *code != '\0' ? code : "as drawn",
              s.pose(in_hand).translation().z());
  for (const Clash& clash : last.clashes)
    std::printf("  %s: %s\n", name_of(clash.collision_class).c_str(), clash.explanation.c_str());
  return 0;
}

}  // namespace

int main() { return push_in("H7/g6") + push_in("H7/p6"); }
