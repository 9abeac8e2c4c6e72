#include "common/io/scenario/revised_part.h"

#include <algorithm>
#include <set>
#include <utility>

#include "common/evaluation/band.h"
#include "common/evaluation/deviation.h"
#include "common/geometry/recognition/recognized.h"
#include "common/io/scenario/scene_features.h"

namespace mortise {
namespace {

using Spec = Scenario::FeatureSpec;

// A face of the new mesh with what is said of it.
struct Named {
  Feature feature;
  std::optional<Spec> spec;
};

const Spec* spec_of(const PartMemory& memory, const std::string& name) {
  const auto found = std::ranges::find(memory.declared, name, &Spec::name);
  return found == memory.declared.end() ? nullptr : &*found;
}

bool states(const Spec& spec) {
  return spec.tolerance || !spec.iso_class.empty() || spec.position.zone_mm > 0.0;
}

// Did people say this, in the scenario or since? Also that nothing is stated any more.
bool by_people(const Spec& spec) {
  using By = Scenario::SaidBy;
  return spec.by == By::kSession || (spec.by == By::kScenario && states(spec));
}

// What holds of a face of a mesh of which `own` is stated: what people said, wherever they did.
const Spec* spec_beside(const PartMemory& memory, const std::string& name, const Spec* own) {
  const Spec* said = spec_of(memory, name);
  return said != nullptr && by_people(*said) ? said : own;
}

// "bore_3" -> "bore_"
std::string stem_of(const std::string& name) {
  const std::size_t end = name.find_last_not_of("0123456789");
  return name.substr(0, end == std::string::npos ? 0 : end + 1);
}

// What the new mesh shows, or its file states, has the names that its faces had; other ones get
// fresh names. What is shown has names of recognized faces alone.
void name_as_before(const PartMemory& memory, const Solid& solid, std::vector<Feature>& shown,
                    bool are_stated = false) {
  std::vector<std::string> names;
  std::vector<SoughtFace> sought;
  std::set<std::string> taken;
  for (const auto& [name, face] : memory.faces) {
    taken.insert(name);
    if (face.origin != FeatureOrigin::kRecognized && !are_stated) continue;
    names.push_back(name);
    sought.push_back(face);
  }
  const double reach_mm = solid.sphere().center_mm.norm() + solid.sphere().radius_mm;
  const auto found = find_again(sought, shown, solid.mesh(), reach_mm);
  std::vector<bool> is_named(shown.size(), false);
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i]) {
      shown[*found[i]].name = names[i];
      is_named[*found[i]] = true;
    }
  for (std::size_t j = 0; j < shown.size(); ++j) {
    if (is_named[j]) continue;
    const std::string stem = stem_of(shown[j].name);
    for (int number = 1; !taken.insert(shown[j].name).second; ++number)
      shown[j].name = stem + std::to_string(number);
  }
}

// A triangle that lies on two of them belongs to the closer one.
void share_out(std::vector<Named>& faces, const TriangleMesh& mesh) {
  std::vector<Feature> features;
  for (const Named& face : faces) features.push_back(face.feature);
  const std::vector<std::int32_t> owner = owners_of(features, mesh);
  for (std::size_t f = 0; f < faces.size(); ++f)
    std::erase_if(faces[f].feature.triangles,
                  [&](std::uint32_t t) { return owner[t] != static_cast<std::int32_t>(f); });
  std::erase_if(faces, [](const Named& face) { return face.feature.triangles.empty(); });
}

// Faces that were declared, or of which something was stated, as far as the mesh has them.
std::vector<Named> declared_faces(const PartMemory& memory, const Solid& solid,
                                  const std::vector<Feature>& shown) {
  std::vector<Named> faces;
  for (const auto& [name, face] : memory.faces) {
    const Spec* said = spec_of(memory, name);
    Spec spec = said != nullptr ? *said : Spec{};
    spec.name = name;
    if (face.origin == FeatureOrigin::kRecognized) {
      const auto found = std::ranges::find(shown, name, &Feature::name);
      if (said == nullptr || found == shown.end()) continue;
      spec.surface = found->surface;
      faces.push_back({*found, std::move(spec)});
      continue;
    }
    if (said == nullptr) spec.surface = face.surface;
    Result<FeatureMatch> match = match_feature(
        solid.mesh(), {name, spec.surface, spec.along_mm, memory.chord_error_mm.value_or(0.0)});
    if (!match) continue;
    match->feature.origin = face.origin;
    faces.push_back({std::move(match->feature), std::move(spec)});
  }
  share_out(faces, solid.mesh());
  return faces;
}

// The mesh with which the part began: its faces are those that it had.
std::vector<Named> first_faces(const PartMemory& memory) {
  std::vector<Named> faces;
  for (const Feature& feature : memory.first->features) {
    Named& face = faces.emplace_back();
    face.feature = feature;
    const auto own = std::ranges::find(memory.first->declared, feature.name, &Spec::name);
    const Spec* said =
        spec_beside(memory, feature.name, own == memory.first->declared.end() ? nullptr : &*own);
    if (said != nullptr) face.spec = *said;
  }
  return faces;
}

// A mesh whose file states its faces: `own` is what it states, `notes` what of that does not hold.
std::vector<Named> stated_faces(const PartMemory& memory, const PartShape& own,
                                std::vector<std::string>& notes) {
  std::vector<Feature> features = own.features;
  name_as_before(memory, *own.solid, features, true);
  std::vector<Named> faces;
  std::size_t given_way = 0;
  std::string names;
  for (std::size_t i = 0; i < features.size(); ++i) {
    Named& face = faces.emplace_back();
    face.feature = std::move(features[i]);
    Spec stated = own.stated->declared[i];
    const Spec* said = spec_beside(memory, face.feature.name, &stated);
    if (said != &stated && states(stated))
      names += (given_way++ == 0 ? "" : ", ") + face.feature.name;
    face.spec = *said;
    face.spec->surface = stated.surface;
  }
  if (given_way > 0)
    notes.push_back("tolerances of its file give way to what people said of " + names);
  return faces;
}

// What is stated of each, up to the last one of which something is. Nothing where statements
// contradict each other: then the face is as if it were gone.
std::shared_ptr<StatedPart> stated_of(const PartMemory& memory, std::vector<Named>& faces) {
  auto stated = std::make_shared<StatedPart>();
  stated->rest = memory.rest;
  const auto is_said = [](const Named& face) { return face.spec.has_value(); };
  const auto last = std::find_if(faces.rbegin(), faces.rend(), is_said);
  const auto count = static_cast<std::size_t>(faces.rend() - last);
  for (std::size_t i = 0; i < count; ++i) {
    Spec& spec = stated->declared.emplace_back(faces[i].spec.value_or(Spec{}));
    spec.name = faces[i].feature.name;
    if (!faces[i].spec) spec.surface = faces[i].feature.surface;
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    stated->of_feature.push_back(stated->rest);
    if (i >= count) continue;
    Result<PlacedStatement> said = statement_of_feature(stated->declared[i], stated->declared,
                                                        faces[i].feature.residual_mm, stated->rest);
    if (said) stated->of_feature.back() = std::move(said).value();
  }
  return stated;
}

}  // namespace

void remember(PartMemory& memory, const Part& part, const StatedPart& stated) {
  if (!memory.first)
    memory.first = std::make_shared<const PartMemory::First>(
        PartMemory::First{part.solid->hash(), part.features, part.band, stated.declared});
  memory.rest = stated.rest;
  for (std::size_t i = 0; i < part.features.size(); ++i) {
    const Feature& feature = part.features[i];
    PartMemory::Face& face = memory.faces[feature.name];
    face.surface = feature.surface;
    face.middle_P = middle_of(feature, part.solid->mesh());
    face.origin = feature.origin;
    if (i >= stated.declared.size()) continue;
    const auto known = std::ranges::find(memory.declared, feature.name, &Spec::name);
    if (known == memory.declared.end())
      memory.declared.push_back(stated.declared[i]);
    else
      *known = stated.declared[i];
  }
}

namespace {

// A mesh whose file states its faces.
PartShape revised_by_file(const PartMemory& memory, const PartShape& own) {
  PartShape shape;
  shape.solid = own.solid;
  std::vector<Named> faces = stated_faces(memory, own, shape.notes);
  const std::shared_ptr<StatedPart> stated = stated_of(memory, faces);
  for (Named& face : faces) shape.features.change().push_back(std::move(face.feature));
  shape.band =
      with_statements(own.band, *own.solid, for_band(stated->rest), for_band(stated->of_feature));
  for (SurfaceBand::Face& face : shape.band.faces)
    if (face.feature >= 0) face.name = shape.features[static_cast<std::size_t>(face.feature)].name;
  shape.stated = stated;
  return shape;
}

}  // namespace

PartShape revised(const PartMemory& memory, SolidPtr solid, double quantum_mm) {
  const bool is_first = memory.first && memory.first->mesh == solid->hash();
  if (!is_first && solid->mesh().stated)
    if (const PartShape own = shape_of(solid, quantum_mm, memory.undeclared); own.stated)
      return revised_by_file(memory, own);
  const bool recognizes = memory.undeclared != UndeclaredSurface::kNominal;
  std::vector<Named> faces;
  if (is_first) {
    faces = first_faces(memory);
  } else {
    Recognition shown;
    if (recognizes) shown = *recognized(*solid, {.quantum_mm = quantum_mm});
    name_as_before(memory, *solid, shown.features);
    faces = declared_faces(memory, *solid, shown.features);
    std::vector<Feature> declared;
    for (const Named& face : faces) declared.push_back(face.feature);
    for (Feature& feature : undeclared_features(shown, declared, solid->mesh().triangles.size()))
      faces.push_back({std::move(feature), std::nullopt});
  }
  const std::shared_ptr<StatedPart> stated = stated_of(memory, faces);
  PartShape shape;
  shape.solid = solid;
  for (Named& face : faces) shape.features.change().push_back(std::move(face.feature));
  shape.band = is_first ? with_statements(memory.first->band, *solid, for_band(stated->rest),
                                          for_band(stated->of_feature))
                        : build_band({solid.get(),
                                      shape.features,
                                      memory.chord_error_mm,
                                      for_band(stated->rest),
                                      for_band(stated->of_feature),
                                      recognizes,
                                      quantum_mm,
                                      {}});
  shape.stated = stated;
  return shape;
}

}  // namespace mortise
