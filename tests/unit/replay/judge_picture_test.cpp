#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <regex>

#include "client/picture/detail_view.h"
#include "client/picture/draw.h"
#include "client/picture/picture.h"
#include "client/picture/told_overlap.h"
#include "common/io/scenario/open_scene.h"
#include "tests/support/shapes.h"

namespace mortise {
namespace {

double area_of(const std::vector<Vec2>& outline) {
  double sum = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return std::fabs(sum);
}

TEST(Section, CutsABoxIntoOneClosedLine) {
  const TriangleMesh box = shapes::box({1, 2, 3}, Vec3::Zero(), 3);
  for (const double z : {-1.0, 0.0, 1.0, 0.37}) {  // through corners of the grid as well
    const CutPlane plane{{0, 0, z}, Vec3::UnitX(), Vec3::UnitY()};
    const auto lines = cut_lines(box, {}, plane);
    ASSERT_EQ(lines.size(), 1u) << z;
    EXPECT_TRUE(lines[0].closed);
    EXPECT_EQ(lines[0].points.size(), lines[0].triangles.size() + 1);
    EXPECT_NEAR(area_of(lines[0].points), 8.0, 1e-12);
  }
  EXPECT_TRUE(cut_lines(box, {}, {{0, 0, 3.5}, Vec3::UnitX(), Vec3::UnitY()}).empty());
}

TEST(Section, ATubeHasTwoLinesAndEveryPointIsOnPlaneAndTriangle) {
  const TriangleMesh tube = shapes::ring({10, 0, 20, 32, 1, 0.1}, 15);
  std::mt19937_64 random(11);
  const Pose X = shapes::random_pose(random, 30);
  CutPlane plane{X * Vec3(0, 0, 7), X.q * Vec3::UnitX(), X.q * Vec3::UnitY()};
  const auto lines = cut_lines(tube, X, plane);
  ASSERT_EQ(lines.size(), 2u);
  for (const CutLine& line : lines) {
    EXPECT_TRUE(line.closed);
    for (std::size_t i = 0; i < line.triangles.size(); ++i)
      for (const Vec2& x : {line.points[i], line.points[i + 1]}) {
        const Vec3 x_P = X.inverse() * plane.lift(x);
        const std::uint32_t t = line.triangles[i];
        const Vec3 &a = tube.corner(t, 0), &b = tube.corner(t, 1), &c = tube.corner(t, 2);
        EXPECT_NEAR((x_P - a).dot((b - a).cross(c - a).normalized()), 0.0, 1e-9);
      }
  }
}

TEST(Section, AnOpenMeshGivesAnOpenLine) {
  TriangleMesh open = shapes::box({1, 1, 1});
  // Without both triangles of one side wall.
  std::erase_if(open.triangles, [&](const auto& t) {
    return open.points_mm[t[0]].x() > 0 && open.points_mm[t[1]].x() > 0 &&
           open.points_mm[t[2]].x() > 0;
  });
  const auto lines = cut_lines(open, {}, {{0, 0, 0.2}, Vec3::UnitX(), Vec3::UnitY()});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_FALSE(lines[0].closed);
}

TEST(Section, ClipsAPolygon) {
  const std::vector<Vec2> square = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  EXPECT_NEAR(area_of(clipped(square, {1, 0}, 0.5)), 3.0, 1e-12);
  EXPECT_NEAR(area_of(clipped(square, {-1, 0}, -0.5)), 1.0, 1e-12);
  EXPECT_TRUE(clipped(square, {1, 0}, 3.0).empty());
}

TEST(Chart, UnrollsACircleAndBack) {
  const Chart chart{{0.3, -10.0}, 10.0};
  for (const Vec2& x : {Vec2(0, 0), Vec2(2, 0.1), Vec2(-3, -0.7)})
    EXPECT_LT((chart.to_cut(chart.to_chart(x)) - x).norm(), 1e-12);
  // A quarter of the circle is a quarter of its length, and on it the height is 0.
  const Vec2 quarter = chart.to_chart({10.3, -10.0});
  EXPECT_NEAR(quarter.x(), 5.0 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(quarter.y(), 0.0, 1e-12);
}

class FitsPicture : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto opened = open_scene(std::string(MORTISE_SOURCE_DIR) + "/scenarios/fits.yaml");
    ASSERT_TRUE(opened && opened->usable());
    scene_ = new OpenedScene(std::move(*opened));
    Scratch scratch;
    report_ = new JudgeReport(judge_world(scene_->scene.world, scratch, true));
  }
  static void TearDownTestSuite() {
    delete report_;
    delete scene_;
  }
  static DetailView view_of(const std::string& peg) {
    for (const NumberedRegion& region : numbered_regions(*report_))
      if (scene_->scene.world.find(region.pair->b)->name == peg)
        return detail_view({&scene_->scene.world, region.pair->a, region.pair->b, region.verdict},
                           1.6);
    ADD_FAILURE() << "no region of " << peg;
    return {};
  }
  static std::string file(const std::string& name) {
    return (std::filesystem::temp_directory_path() /
            ("mortise_picture_" + std::to_string(getpid()) + name))
        .string();
  }
  static OpenedScene* scene_;
  static JudgeReport* report_;
};
OpenedScene* FitsPicture::scene_ = nullptr;
JudgeReport* FitsPicture::report_ = nullptr;

// Radial heights from R = 10: 20 H7 is 0 to 10.5 µm outwards, 20 g6 -10 to -3.5 µm, 20 p6 11 to
// 17.5; the meshes overlap from the middle of a facet to the true circle.
TEST_F(FitsPicture, ShowsZonesAndOverlapAtTheirHeights) {
  const DetailView g6 = view_of("peg_g6");
  EXPECT_NEAR(g6.chart.radius_mm, 10.0, 1e-9);
  EXPECT_EQ(g6.upper, 0);  // the plate's material lies outside
  const double sagitta = 10.0 * (1.0 - std::cos(std::numbers::pi / 32));
  EXPECT_NEAR(g6.overlap_h_mm.lo, -sagitta, 1e-6);
  EXPECT_NEAR(g6.overlap_h_mm.hi, 0.0, 1e-6);
  ASSERT_TRUE(g6.parts[0].zone_at_point && g6.parts[1].zone_at_point);
  EXPECT_NEAR(g6.parts[0].zone_at_point->lo, 0.0, 1e-7);
  EXPECT_NEAR(g6.parts[0].zone_at_point->hi, 0.0105, 1e-7);
  EXPECT_NEAR(g6.parts[1].zone_at_point->lo, -0.0100, 1e-7);
  EXPECT_NEAR(g6.parts[1].zone_at_point->hi, -0.0035, 1e-7);
  EXPECT_FALSE(g6.witness);
  for (const double h : {g6.overlap_h_mm.lo, 0.0105}) EXPECT_TRUE(g6.h_mm.contains(h));
  // Drawn lines of a coaxial fit are level.
  int level = 0;
  for (const DrawnZone& zone : g6.parts[0].zones)
    for (const Vec2& x : zone.least)
      if (g6.h_mm.contains(x.y())) {
        EXPECT_NEAR(x.y(), 0.0105, 1e-7);
        ++level;
      }
  EXPECT_GT(level, 100);
  // More than two facets are seen, so that the polygon is told from the circle.
  EXPECT_GT(g6.s_mm.width(), 2.0 * 20.0 * std::sin(std::numbers::pi / 32));
}

TEST_F(FitsPicture, MarksAPointInsideBothWhenReal) {
  const DetailView p6 = view_of("peg_p6");
  ASSERT_TRUE(p6.witness);
  const Vec3 x_W = p6.plane.lift(p6.chart.to_cut(*p6.witness));
  const double radius = std::hypot(x_W.x() - 400.0, x_W.y());
  EXPECT_GT(radius, 10.0105);  // inside the plate even with the largest bore
  EXPECT_LT(radius, 10.0110);  // inside the peg even when it is least
  EXPECT_FALSE(view_of("peg_k6").witness);
}

TEST_F(FitsPicture, IsWrittenAsSvgAndPng) {
  const World& world = scene_->scene.world;
  const auto head = [](const std::string& name) {
    std::ifstream in(name, std::ios::binary);
    std::string text(5, '\0');
    in.read(text.data(), 5);
    return text;
  };
  ASSERT_TRUE(draw_regions(world, *report_, {}, file("a.svg")));
  EXPECT_EQ(head(file("a.svg")), "<svg ");
  ASSERT_TRUE(draw_regions(world, *report_, {2, 6}, file("b.png")));
  EXPECT_EQ(head(file("b.png")).substr(1, 3), "PNG");
  for (const char* name : {"a.svg", "b.png"}) std::filesystem::remove(file(name));
}

// A witness near the edge of what is drawn: its words are moved into the picture.
TEST_F(FitsPicture, WordsAtTheEdgeAreNotCutOff) {
  const Box2 box{60.0, 10.0, 500.0, 300.0};
  Verdict verdict;
  for (const double share : {0.01, 0.5, 0.99}) {
    DetailView view = view_of("peg_p6");
    ASSERT_TRUE(view.witness);
    view.witness->x() = view.s_mm.lo + share * view.s_mm.width();
    Canvas canvas(Canvas::Format::kSvg, 700.0, 400.0, 1.0);
    draw_detail(canvas, box, view, verdict);
    const auto svg = canvas.finish();
    ASSERT_TRUE(svg);
    std::smatch words;
    ASSERT_TRUE(std::regex_search(
        *svg, words,
        std::regex("<text x=\"([-0-9.]+)\" y=\"[-0-9.]+\" textLength=\"([0-9.]+)\"[^>]*>inside")));
    EXPECT_GE(std::stod(words[1]), box.x);
    EXPECT_LE(std::stod(words[1]) + std::stod(words[2]), box.right());
  }
}

// The arrow of the way out: a way that turns takes the deciding point elsewhere than its shift
// says.
TEST(WayOut, IsSeenAsThePointOfTheClashSetsOff) {
  const CutPlane plane{{0, 0, 0}, Vec3::UnitX(), Vec3::UnitZ()};
  Verdict v;
  v.point_W = {3, 0, 1};
  v.separation_about_W = {3, 0, 0};
  v.separation_translation_mm = {0, 0, 2};
  const auto shifted = way_seen(plane, v);
  ASSERT_TRUE(shifted);
  EXPECT_LT((*shifted - Vec2(0, 1)).norm(), 1e-12);
  v.separation_rotation_rad = {0, 2, 0};  // of an arm of 1 upwards: 2 to the right
  const auto turned = way_seen(plane, v);
  ASSERT_TRUE(turned);
  EXPECT_LT((*turned - Vec2(1, 1).normalized()).norm(), 1e-12);
  v.separation_rotation_rad = {0, 0, 0};
  v.separation_translation_mm = {0.1, 2, 0};
  EXPECT_FALSE(way_seen(plane, v)) << "it leaves the plane";
  v.separation_translation_mm = {0, 0, 0};
  EXPECT_FALSE(way_seen(plane, v));
}

// It is drawn, and with it its length.
TEST_F(FitsPicture, ShowsTheWayOut) {
  for (const NumberedRegion& region : numbered_regions(*report_)) {
    Verdict v = *region.verdict;
    const auto drawn = [&] {
      auto svg = region_picture({&scene_->scene.world, region.pair->a, region.pair->b, &v},
                                Canvas::Format::kSvg);
      EXPECT_TRUE(svg);
      return svg ? *svg : std::string();
    };
    v.separation_way = SeparationWay::kNone;
    const std::string without = drawn();
    v.separation_way = SeparationWay::kAxis;
    v.separation_translation_mm = {0, 0, 5};
    v.separation_rotation_rad = {0, 0, 0};
    v.gpd_mm = {5, 5};
    const std::string along = drawn();
    EXPECT_GT(along.size(), without.size());
    v.gpd_mm = {6, 6};
    EXPECT_NE(drawn(), along) << "its length is not told";
  }
}

// Where the bracket was left open the arrow is as long as the sentence says, not up to its middle.
TEST(ToldOverlap, OfAnOpenBracketTheEndThatDecided) {
  Verdict v;
  v.collision_class = CollisionClass::kReal;
  v.delta_mm = {0.2499, 22.3213};
  EXPECT_EQ(told_overlap_mm(v), 0.2499);
  EXPECT_EQ(told_overlap_text(v), "overlap at least 249.9 µm");
  v.collision_class = CollisionClass::kFake;
  v.delta_mm = {0.03, 0.0361};
  EXPECT_EQ(told_overlap_text(v), "overlap at most 36.1 µm");
  v.delta_mm = {0.0482, 0.0483};
  EXPECT_EQ(told_overlap_text(v), "overlap 48.2 µm");
  v.collision_class = CollisionClass::kPotential;
  v.delta_mm = {-0.05, -0.02};
  EXPECT_EQ(told_overlap_text(v), "apart at most 50.0 µm");
}

TEST_F(FitsPicture, RefusesInOneLine) {
  const World& world = scene_->scene.world;
  const auto refused = [&](const std::vector<std::size_t>& numbers, const std::string& name) {
    const Status drawn = draw_regions(world, *report_, numbers, name);
    return drawn ? std::string() : drawn.error().text;
  };
  EXPECT_EQ(refused({7}, file("c.svg")), "--region 7: there are regions 1 to 6");
  EXPECT_EQ(refused({0}, file("c.svg")), "--region 0: there are regions 1 to 6");
  EXPECT_NE(refused({}, "c.jpg").find(".svg or .png"), std::string::npos);
  EXPECT_NE(refused({}, "/no/such/folder/c.png").find("cannot be written"), std::string::npos);
  EXPECT_NE(refused({}, "/no/such/folder/c.svg").find("cannot be written"), std::string::npos);
  const JudgeReport nothing;
  EXPECT_FALSE(draw_regions(world, nothing, {}, file("c.svg")));
}

}  // namespace
}  // namespace mortise
