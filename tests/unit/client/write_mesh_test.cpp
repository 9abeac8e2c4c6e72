#include "client/tools/generate/write_mesh.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/generators/generators.h"
#include "common/io/mesh/mesh_import.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

TEST(WriteMesh, EveryGeneratedPartComesBackThroughTheImport) {
  const fs::path folder =
      fs::temp_directory_path() / ("mortise-write-mesh-" + std::to_string(getpid()));
  fs::create_directories(folder);
  for (const GeneratorInfo& info : generators()) {
    const auto part = generate(info.name, {});
    ASSERT_TRUE(part);
    for (const char* extension : {".obj", ".stl"}) {
      const fs::path file = folder / (info.name + extension);
      {
        std::ofstream out(file, std::ios::binary);
        std::string(extension) == ".obj" ? write_obj(part->mesh, part->features, out)
                                         : write_stl(part->mesh, out);
      }
      const auto back = import_mesh(file, 1.0);
      ASSERT_TRUE(back) << back.error().text;
      EXPECT_TRUE(back->report.closed) << file;
      EXPECT_EQ(back->mesh.triangles.size(), part->mesh.triangles.size()) << file;
      EXPECT_EQ(back->mesh.points_mm.size(), part->mesh.points_mm.size()) << file;
      const double volume = signed_volume_mm3(part->mesh);
      EXPECT_NEAR(back->report.volume_mm3, volume, 1e-5 * volume) << file;
    }
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace mortise
