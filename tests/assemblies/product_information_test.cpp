#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/assemblies/support.h"

// What NIST's files state, by the counts of an independent reading of each file. The document model
// of OpenCASCADE 7.6.3 reads four things wrong; a test holds each.
namespace mortise {
namespace {

using Kind = StepStatement::Kind;

StepDocument document_of(const std::filesystem::path& file) {
  test::use_built_importer();
  auto assembly = import_step(file);
  EXPECT_TRUE(assembly) << assembly.error().text;
  return assembly ? std::move(assembly->document) : StepDocument();
}

struct Counted {
  std::size_t sizes = 0, distances = 0, with_value = 0, with_limits = 0;
  std::size_t geometric = 0, geometric_with_value = 0, geometric_with_faces = 0;
};

Counted counted(const StepDocument& document) {
  Counted c;
  for (const StepStatement& s : document.statements) {
    const bool has_value = !std::isnan(s.value) || !std::isnan(s.limit_upper);
    if (s.kind == Kind::kGeometric) {
      ++c.geometric;
      c.geometric_with_value += has_value;
      c.geometric_with_faces += !s.faces.empty();
    } else if (s.kind == Kind::kSize || s.kind == Kind::kDistance || s.kind == Kind::kAngle) {
      ++(s.kind == Kind::kSize ? c.sizes : c.distances);
      c.with_value += has_value;
      c.with_limits += !std::isnan(s.upper) || !std::isnan(s.limit_upper) || !s.code.empty();
    }
  }
  return c;
}

std::map<std::string, std::size_t> reasons_of(const std::filesystem::path& file) {
  test::use_built_importer();
  const auto opened = open_assembly(file);
  EXPECT_TRUE(opened && opened->usable());
  std::map<std::string, std::size_t> reasons;
  for (const auto& listed : opened->scenario.assembly->listed)
    ++reasons[listed.used ? "used" : listed.reason];
  EXPECT_EQ(reasons.count(""), 0U);
  return reasons;
}

TEST(ProductInformation, Ftc10) {
  const auto file = test::data_folder() / "step" / "nist_ftc_10_asme1_ap242-e2.stp";
  MORTISE_NEEDS_DATA(file);
  const Counted c = counted(document_of(file));
  EXPECT_EQ(c.sizes, 19U);
  EXPECT_EQ(c.distances, 7U);
  EXPECT_EQ(c.with_value, 26U);
  EXPECT_EQ(c.with_limits, 23U);  // 20 with deviations, 3 with a class
  EXPECT_EQ(c.geometric, 40U);    // the library knows 39: a straightness of a unit length is lost
  EXPECT_EQ(c.geometric_with_value, 40U);  // two of them zero at a material condition
  EXPECT_EQ(c.geometric_with_faces, 36U);
  EXPECT_EQ(reasons_of(file)["used"], 35U);  // 14 sizes, 2 widths, 12 positions, 7 profiles
}

TEST(ProductInformation, Ctc01) {
  const auto file = test::data_folder() / "assemblies" / "nist_ctc_01_asme1_ap242-e1.stp";
  MORTISE_NEEDS_DATA(file);
  const StepDocument document = document_of(file);
  const Counted c = counted(document);
  EXPECT_EQ(c.sizes + c.distances, 12U);
  EXPECT_EQ(c.with_value, 8U);
  EXPECT_EQ(c.geometric, 6U);
  EXPECT_EQ(c.geometric_with_value, 6U);  // of which the library reads none
  EXPECT_EQ(c.geometric_with_faces, 6U);
  auto reasons = reasons_of(file);
  EXPECT_EQ(reasons["used"], 9U);  // 7 sizes, 2 profiles
  EXPECT_EQ(reasons["the file gives no value"], 4U);
  EXPECT_TRUE(std::any_of(document.statements.begin(), document.statements.end(),
                          [](auto& s) { return s.limit_lower == 34.8 && s.limit_upper == 35.2; }));
}

TEST(ProductInformation, Ctc03IsInInches) {
  const auto file = test::data_folder() / "assemblies" / "nist_ctc_03_asme1_ap242-e2.stp";
  MORTISE_NEEDS_DATA(file);
  const StepDocument document = document_of(file);
  const Counted c = counted(document);
  EXPECT_EQ(c.sizes + c.distances, 10U);
  EXPECT_EQ(c.with_value, 9U);
  EXPECT_EQ(c.geometric, 13U);  // the library knows 12: a flatness of a unit area is lost
  EXPECT_EQ(c.geometric_with_value, 13U);
  EXPECT_EQ(c.geometric_with_faces, 13U);
  EXPECT_EQ(reasons_of(file)["used"], 15U);  // 7 sizes, 5 positions, 3 profiles
  std::size_t at_mmc = 0;
  for (const StepStatement& s : document.statements) {
    at_mmc += s.name == "position" && s.modifiers == "maximum material requirement" &&
              std::fabs(s.value - 1.27) < 1e-9;  // 0.05 in
    if (s.kind == Kind::kSize && !std::isnan(s.upper)) {
      EXPECT_LT(s.lower, 0.0);
      EXPECT_GT(s.upper, 0.0);
    }
  }
  EXPECT_EQ(at_mmc, 2U);
}

// What the document model of the library reads right of FTC-10 we read as well.
TEST(ProductInformation, AgreesWithTheLibraryWhereThatIsRight) {
  const auto file = test::data_folder() / "step" / "nist_ftc_10_asme1_ap242-e2.stp";
  const auto other = test::data_folder() / "step" / "nist_ftc_10_tolerances_occt763.json";
  MORTISE_NEEDS_DATA(other);
  const StepDocument document = document_of(file);
  const auto read = nlohmann::json::parse(std::ifstream(other));
  std::size_t compared = 0;
  for (const auto& dimension : read.at("dimensions")) {
    if (!dimension.contains("plus")) continue;
    const double value = dimension.at("value"), plus = dimension.at("plus"),
                 minus = dimension.at("minus");
    if (plus == 0.0 && minus == 0.0) continue;
    ++compared;
    EXPECT_TRUE(std::any_of(document.statements.begin(), document.statements.end(), [&](auto& s) {
      return std::fabs(s.value - value) < 1e-9 && std::fabs(s.upper - plus) < 1e-9 &&
             std::fabs(s.lower + minus) < 1e-9;
    })) << dimension;
  }
  EXPECT_GE(compared, 15U);
}

// k6 must not read as js, g6 (both limits below) not as a range, a class in pieces must not vanish.
TEST(ProductInformation, SignsAndClassesAreThoseOfTheFile) {
  const auto file = test::data_folder() / "assemblies" / "derived_ftc10_signs.stp";
  MORTISE_NEEDS_DATA(file);
  const auto states = [&, document = document_of(file)](auto is) {
    return std::any_of(document.statements.begin(), document.statements.end(), is);
  };
  EXPECT_TRUE(states([](const StepStatement& s) {
    return std::fabs(s.upper - 0.015) < 1e-9 && std::fabs(s.lower - 0.002) < 1e-9;
  }));
  EXPECT_TRUE(states([](const StepStatement& s) {
    return std::fabs(s.upper + 0.007) < 1e-9 && std::fabs(s.lower + 0.02) < 1e-9;
  }));
  EXPECT_TRUE(states([](const StepStatement& s) { return s.code == "G6"; }));
}

// Statements of our own file, which OpenCASCADE wrote.
TEST(ProductInformation, OfTheTensioner) {
  const test::TestFolder folder;
  const std::string file = folder.path() / "tensioner.step";
  test::step_maker("tensioner '" + file + "'");
  test::use_built_importer();
  const auto opened = open_assembly(file);
  ASSERT_TRUE(opened && opened->usable());
  for (const auto& listed : opened->scenario.assembly->listed)
    EXPECT_TRUE(listed.used) << listed.reason;
  const auto band_of = [&](const std::string& part, const std::string& name) {
    for (const Part& p : opened->scene.world.parts)
      if (p.name == part)
        for (const auto& face : p.band.faces)
          if (face.name == name) return face.tolerance_mm;
    ADD_FAILURE() << part << "." << name;
    return Interval{};
  };
  // g6 with its axis in a zone of 2 µm: below the drawn size by 2.5 to 7 µm of the radius, ± 1.
  EXPECT_NEAR(band_of("shaft", "shaft_1").lo, -0.008, 1e-9);
  EXPECT_NEAR(band_of("shaft", "shaft_1").hi, -0.0015, 1e-9);
  EXPECT_NEAR(band_of("bush", "bore_1").lo, -0.0075, 1e-9);
  EXPECT_NEAR(band_of("bush", "bore_1").hi, 0.0, 1e-9);
}

}  // namespace
}  // namespace mortise
