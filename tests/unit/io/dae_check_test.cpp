// A DAE file is looked at before assimp leaves out what is named and not there.
#include <gtest/gtest.h>

#include <string>

#include "common/io/mesh/mesh_import.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

// A tetrahedron.
const std::string kDae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 2 0 0 0 3 0 0 0 4</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_nodes><node id="n"/></library_nodes>
<library_visual_scenes><visual_scene id="s"><node id="a"><translate>5 0 0</translate>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";

std::string dae_with(const std::string& what, const std::string& by) {
  std::string text = kDae;
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

class DaeCheck : public testing::Test {
 protected:
  void expect(const std::string& bytes, const std::string& words) const {
    const auto mesh = import_mesh(folder_.write("part.dae", bytes), 1.0);
    const std::string said = mesh ? "imported" : mesh.error().text;
    EXPECT_NE(said.find(words), std::string::npos) << "wanted '" << words << "' in: " << said;
    EXPECT_EQ(said.find('\n'), std::string::npos);
    if (!mesh) return;
    EXPECT_TRUE(mesh->report.closed);
    EXPECT_NEAR(mesh->report.volume_mm3, 4.0, 1e-5);
  }
  test::TestFolder folder_;
};

TEST_F(DaeCheck, WhatAssimpReadsAsItIsMeantIsTaken) {
  expect(kDae, "imported");
  expect("\xef\xbb\xbf" + kDae, "imported");
  expect(dae_with(" 0 3 0", "\n  0\t3e0 -0.0"), "imported");
  expect(dae_with("</node></visual", R"(<instance_node url="#n"/></node></visual)"), "imported");
}

TEST_F(DaeCheck, WhatIsNamedAndNotThereIsRefused) {
  const auto scene_with = [](const std::string& more) {
    return dae_with("</node></visual", more + "</node></visual");
  };
  expect(scene_with(R"(<instance_geometry url="#h"/>)"),
         "<instance_geometry> names '#h', and the file has no such geometry");
  expect(scene_with(R"(<instance_node url="#g"/>)"), "the file has no such node");
  expect(scene_with(R"(<instance_node url="other.dae#n"/>)"), "names 'other.dae#n'");
  expect(scene_with(R"(<instance_controller url="#c"/>)"), "the file has no such controller");
  expect(dae_with("<library_nodes>", R"(<library_geometries><geometry id="g"><mesh/></geometry>)"
                                     "</library_geometries><library_nodes>"),
         "<geometry> 'g' stands here twice");
}

TEST_F(DaeCheck, OtherNumbersThanAnnouncedAreRefused) {
  expect(dae_with("count=\"12\"", "count=\"9\""), "<float_array> 'pa' holds 12 numbers, not 9");
  expect(dae_with("count=\"12\"", "count=\"-1\""), "<float_array> 'pa' has the count '-1'");
  expect(dae_with("count=\"4\" stride=\"3\"", "count=\"4\" stride=\"4\""), "reaches beyond its 12");
  expect(dae_with("stride=\"3\"", "stride=\"3\" offset=\"3\""), "reaches beyond its 12 numbers");
  expect(dae_with(" 0 3 0", " 0 3,5 0"), "holds '3,5', which is no number (decimals have a point)");
  expect(dae_with("0 3 2 1", "0 -3 2 1"), "<p> holds '-3', which is no index");
  expect(dae_with(">5 0 0<", ">5,5 0 0<"), "<translate> holds '5,5', which is no number");
  expect(dae_with(">5 0 0<", ">5 0<"), "<translate> holds 2 numbers, not 3");
  expect(dae_with("0.001", "-1"), "<unit> has '-1' metres");
  expect(kDae.substr(0, 900), "its XML is damaged or was cut off, at byte ");
}

TEST_F(DaeCheck, WhatIsNestedTooDeepIsRefused) {
  const auto nested = [](int levels) {
    std::string open, close;
    for (int i = 0; i < levels; ++i) open += "<node>", close += "</node>";
    const std::string mesh = R"(<instance_geometry url="#g"/>)";
    return dae_with(mesh, open + mesh + close);
  };
  expect(nested(900), "imported");
  expect(nested(1000), "its elements are nested deeper than 1000 levels");
  expect(nested(200'000), "its elements are nested deeper than 1000 levels");
  expect(dae_with(R"(<instance_geometry url="#g"/>)", R"(<instance_node url="#a"/>)"),
         "its elements hold each other");
}

}  // namespace
}  // namespace mortise
