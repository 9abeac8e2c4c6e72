// Prisms, ellipses and D-shapes whose surfaces are only recognized: what they are said to be never
// contradicts what they are.
#include <gtest/gtest.h>

#include "common/geometry/recognition/recognition.h"
#include "tests/support/effort.h"
#include "tests/support/lofted.h"
#include "tests/support/numbers.h"
#include "tests/unit/depth/overlap_case.h"

namespace mortise {
namespace {

using namespace shapes;

constexpr int kFacets[] = {6, 8, 11, 12, 16, 17, 24, 32, 48, 64};
constexpr double kMargin_mm = 4e-3;

SolidPtr bar_of(const std::vector<Vec3>& section) {
  return std::make_shared<const Solid>(
      lofted({at_height(section, -5.0), at_height(section, 25.0)}));
}

SolidPtr plate_of(const std::vector<Vec3>& section) {
  return std::make_shared<const Solid>(plate_with_hole(section, 0.0, 20.0));
}

SurfaceBand recognized(const SolidPtr& solid) {
  const std::vector<Feature> features = recognize_features(*solid).features;
  BandInput input;
  input.solid = solid.get();
  input.features = features;
  input.of_feature.resize(features.size());
  input.estimate = true;
  return build_band(input);
}

// Truth: the real parts meet, or are apart. In full, which takes far longer, each third is judged.
void expect_no_contradiction(OverlapCase c, bool meet, int i, const std::string& what) {
  for (const Refinement refinement : {Refinement::kDecided, Refinement::kFull}) {
    if (refinement == Refinement::kFull && !test::plays(i, 3)) continue;
    c.refinement = refinement;
    const CollisionClass found = worst_class(overlap_of(c));
    if (meet)
      EXPECT_GE(found, CollisionClass::kPotential) << what << ", they meet";
    else
      EXPECT_NE(found, CollisionClass::kReal) << what << ", they are apart";
  }
}

std::string name_of(const char* what, int n, bool meet) {
  return std::string(what) + " " + std::to_string(n) + (meet ? " meets" : " apart");
}

TEST(RecognizedSection, APrismBesideABlock) {
  int i = 0;
  for (const int n : kFacets)
    for (const bool meet : {false, true}) {
      const SolidPtr bar = bar_of(ellipse(10.0, 10.0, n, kPi / n));
      const double x_mm = 10.0 * std::cos(kPi / n) + (meet ? -kMargin_mm : kMargin_mm);
      OverlapCase c{bar, std::make_shared<const Solid>(box(Vec3(5, 20, 8), Vec3(x_mm + 5, 0, 10)))};
      c.band_a = recognized(bar);
      expect_no_contradiction(c, meet, i++, name_of("prism", n, meet));
    }
}

TEST(RecognizedSection, APrismInABore) {
  int i = 0;
  const SolidPtr plate = plate_of(ellipse(10.0, 10.0, 96));
  const SurfaceBand bore = cylinder_band(plate, 10.0, true, {});
  for (const int n : kFacets)
    for (const bool meet : {false, true}) {
      const double r_mm = 10.0 + (meet ? kMargin_mm : -kMargin_mm);
      OverlapCase c{bar_of(ellipse(r_mm, r_mm, n, 0.1)), plate};
      c.band_a = recognized(c.a);
      c.band_b = bore;
      expect_no_contradiction(c, meet, i++, name_of("prism", n, meet));
    }
}

TEST(RecognizedSection, AShaftInAPrismaticHole) {
  int i = 0;
  for (const int n : kFacets)
    for (const bool meet : {false, true}) {
      const double r_mm = 10.0 * std::cos(kPi / n) + (meet ? kMargin_mm : -kMargin_mm);
      OverlapCase c{bar_of(ellipse(r_mm, r_mm, 90)), plate_of(ellipse(10.0, 10.0, n))};
      c.band_a = cylinder_band(c.a, r_mm, false, {});
      c.band_b = recognized(c.b);
      expect_no_contradiction(c, meet, i++, name_of("shaft", n, meet));
    }
}

TEST(RecognizedSection, AnEllipseInAnEllipse) {
  int i = 0;
  for (const int n : kFacets) {
    if (n < 16) continue;  // flats that meet at more than 35 degrees are flats
    for (const bool meet : {false, true})
      for (const double b_mm : {9.0, 11.5}) {
        const double gap_mm = meet ? -10e-3 : 10e-3;
        OverlapCase c{bar_of(ellipse(12.0, b_mm, n)),
                      plate_of(ellipse(12.0 + gap_mm, b_mm + gap_mm, n, meet ? 0.0 : kPi / n))};
        c.band_a = recognized(c.a);
        c.band_b = recognized(c.b);
        expect_no_contradiction(c, meet, i++, name_of("ellipse", n, meet));
      }
  }
}

TEST(RecognizedSection, ADShaftInItsHole) {
  int i = 0;
  for (const int n : kFacets) {
    if (n < 11) continue;
    for (const bool meet : {false, true})
      for (const double flat_mm : {7.0, 9.5}) {
        const double gap_mm = meet ? -kMargin_mm : kMargin_mm;
        OverlapCase c{bar_of(d_section(10.0, flat_mm, n)),
                      plate_of(d_section(10.0 + gap_mm, flat_mm + gap_mm, n + 1))};
        c.band_a = recognized(c.a);
        c.band_b = recognized(c.b);
        expect_no_contradiction(c, meet, i++, name_of("D", n, meet));
      }
  }
}

// What is finely drawn is known as before.
TEST(RecognizedSection, AFineShaftInAFineBoreIsDecided) {
  for (const bool meet : {false, true}) {
    const double r_mm = 10.0 + (meet ? kMargin_mm : -kMargin_mm);
    OverlapCase c{bar_of(ellipse(r_mm, r_mm, 72)), plate_of(ellipse(10.0, 10.0, 80))};
    c.band_a = recognized(c.a);
    c.band_b = recognized(c.b);
    const CollisionClass found = worst_class(overlap_of(c));
    EXPECT_EQ(found == CollisionClass::kReal, meet);
    EXPECT_NE(found, CollisionClass::kPotential);
  }
}

TEST(RecognizedSection, TheRegionSaysThatItIsAnEstimate) {
  OverlapCase c{bar_of(ellipse(10.0, 10.0, 12)),
                std::make_shared<const Solid>(box(Vec3(5, 20, 8), Vec3(14.8, 0, 10)))};
  c.band_a = recognized(c.a);
  const OverlapResult result = overlap_of(c);
  ASSERT_FALSE(result.regions.empty());
  EXPECT_TRUE(result.regions[0].estimated);
}

}  // namespace
}  // namespace mortise
