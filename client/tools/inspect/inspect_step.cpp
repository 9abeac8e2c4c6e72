#include "client/tools/inspect/inspect_step.h"

#include <fmt/format.h>

#include <cstdio>

#include "common/base/json_text.h"
#include "common/io/scenario/assembly_parts.h"
#include "common/io/scenario/open_scene.h"
#include "common/io/step/step_import.h"
#include "common/io/usage.h"

namespace mortise {
namespace {

// Faces by how their surface is known.
struct Faces {
  std::size_t exact = 0, recognized = 0, freeform = 0;
};

Faces faces_of(const StepPart& part) {
  Faces faces;
  for (const StepFace& face : part.faces)
    ++(face.grade == StepFaceGrade::kExact        ? faces.exact
       : face.grade == StepFaceGrade::kRecognized ? faces.recognized
                                                  : faces.freeform);
  return faces;
}

}  // namespace

std::string step_text(const std::string& file, const StepDocument& document) {
  std::string text =
      fmt::format("{}: {} parts of {} distinct products, {} tolerances stated\n", file,
                  document.instances.size(), document.parts.size(), document.statements.size());
  for (const StepInstance& instance : document.instances) {
    const StepPart& part = document.parts[instance.part];
    const Faces faces = faces_of(part);
    text += fmt::format(
        "  {}: {}, {} triangles, {:.6g} mm³, faces: {} exact, {} recognized, {} freeform{}{}{}\n",
        instance.path, part.name, part.mesh.triangles.size(), part.volume_mm3, faces.exact,
        faces.recognized, faces.freeform,
        part.open_edges > 0 ? fmt::format(", {} open edges", part.open_edges) : "",
        part.untriangulated > 0 ? fmt::format(", {} not tessellated", part.untriangulated) : "",
        part.mirrored ? ", mirrored" : "");
  }
  for (const std::string& path : document.not_solid) text += "  " + path + ": not a solid\n";
  for (const std::string& note : document.notes) text += "  note: " + note + "\n";
  return text;
}

Json step_json(const std::string& file, const StepDocument& document) {
  Json json = {{"schema", "mortise/inspect-step/1"},
               {"file", file},
               {"statements", document.statements.size()}};
  json["parts"] = Json::array();
  for (const StepInstance& instance : document.instances) {
    const StepPart& part = document.parts[instance.part];
    const Faces faces = faces_of(part);
    json["parts"].push_back({{"part", instance.path},
                             {"product", instance.products},
                             {"triangles", part.mesh.triangles.size()},
                             {"volume_mm3", part.volume_mm3},
                             {"open_edges", part.open_edges},
                             {"exact_faces", faces.exact},
                             {"recognized_faces", faces.recognized},
                             {"freeform_faces", faces.freeform}});
  }
  json["not_solid"] = document.not_solid;
  json["notes"] = document.notes;
  return json;
}

int inspect_step(const std::string& file, bool json) {
  const auto assembly = import_step(file);
  if (!assembly) {
    std::fprintf(stderr, "mortise-inspect: %s\n", assembly.error().text.c_str());
    return kExitBadInput;
  }
  if (!json) std::fputs(step_text(file, assembly->document).c_str(), stderr);
  const std::string text =
      json ? json_text(step_json(file, assembly->document)) + "\n" : assembly_yaml(file, {});
  std::fputs(text.c_str(), stdout);
  return not_read_of(assembly->document).empty() ? kExitOk : kExitNotWhole;
}

}  // namespace mortise
