#pragma once
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "common/generators/generators.h"
#include "common/io/step/step_document.h"

namespace mortise::test {

/// A generated part as a STEP importer would send it: each feature one face, the rest a freeform
/// one.
inline StepPart step_part(const std::string& name, const std::string& generator,
                          const std::map<std::string, double>& parameters) {
  const auto generated = generate(generator, parameters);
  EXPECT_TRUE(generated) << generator;
  StepPart part;
  part.name = name;
  part.mesh = generated->mesh;
  part.face_of_triangle.assign(part.mesh.triangles.size(), 0);
  StepFace rest;
  rest.grade = StepFaceGrade::kMeasured;
  part.faces.push_back(rest);
  for (const Feature& feature : generated->features) {
    StepFace face;
    face.grade = StepFaceGrade::kExact;
    face.surface = feature.surface;
    for (const std::uint32_t t : feature.triangles)
      part.face_of_triangle[t] = static_cast<std::uint32_t>(part.faces.size());
    part.faces.push_back(face);
  }
  part.volume_mm3 = signed_volume_mm3(part.mesh);
  part.solids = 1;
  return part;
}

/// A ring Ø20 bore and two pins Ø20, one in it and one beside.
inline StepDocument ring_and_pins() {
  StepDocument document;
  document.parts.push_back(
      step_part("ring", "ring", {{"bore_mm", 20.0}, {"outer_mm", 60.0}, {"width_mm", 20.0}}));
  document.parts.push_back(step_part("pin", "dowel", {{"diameter_mm", 20.0}, {"length_mm", 40.0}}));
  const auto place = [&](const std::string& path, std::uint32_t part, const Vec3& at) {
    StepInstance instance;
    instance.path = path;
    instance.products = path;
    instance.part = part;
    instance.X_WP = Pose::translation(at);
    document.instances.push_back(instance);
  };
  place("base/ring", 0, Vec3::Zero());
  place("base/pin.1", 1, {0.0, 0.0, -10.0});
  place("servo/pin.1", 1, {100.0, 0.0, 0.0});
  return document;
}

/// The index of the face with a cylinder of this side.
inline std::uint32_t cylinder_of(const StepPart& part, bool inward) {
  for (std::uint32_t f = 0; f < part.faces.size(); ++f)
    if (part.faces[f].surface.kind == SurfaceKind::kCylinder &&
        part.faces[f].surface.inward == inward)
      return f;
  ADD_FAILURE() << "no such cylinder";
  return 0;
}

}  // namespace mortise::test
