#include "common/io/scenario/scene_load.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "common/evaluation/band.h"
#include "common/evaluation/deviation.h"
#include "common/generators/generators.h"
#include "common/geometry/recognition/recognized.h"
#include "common/io/scenario/brought_part.h"
#include "common/io/scenario/live_rules.h"
#include "common/io/scenario/scene_features.h"
#include "common/io/scenario/scene_rules.h"
#include "common/session/world/surface_rules.h"

namespace mortise {
namespace {

// Byte-exact key of what makes parts alike, so that instances share all work.
class AlikeKey {
 public:
  AlikeKey& add(const std::string& text) {
    key_ += std::to_string(text.size()) + ":" + text;
    return *this;
  }
  AlikeKey& add(double value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof bytes);
    key_.append(bytes, sizeof bytes);
    return *this;
  }
  AlikeKey& add(const Vec3& v) { return add(v.x()).add(v.y()).add(v.z()); }
  AlikeKey& add(const std::optional<Scenario::Tolerance>& t) {
    return t ? add(t->offset_mm.lo).add(t->offset_mm.hi).add(t->text) : add(std::string("none"));
  }
  const std::string& text() const { return key_; }

 private:
  std::string key_;
};

AlikeKey key_of(const Scenario::MeshSource& mesh) {
  AlikeKey key;
  key.add(mesh.file).add(mesh.unit_mm).add(mesh.generator).add(static_cast<double>(mesh.mirror));
  for (const auto& [name, value] : mesh.parameters) key.add(name).add(value);
  key.add(mesh.given ? static_cast<double>(mesh.given_number) : -1.0);
  return key;
}

AlikeKey key_of(const Scenario::PartSpec& part) {
  AlikeKey key = key_of(part.mesh);
  key.add(part.chord_error_mm.value_or(-1.0)).add(part.tolerance);
  key.add(static_cast<double>(part.undeclared));
  for (const auto& f : part.features) {
    const Surface& s = f.surface;
    key.add(f.name).add(static_cast<double>(s.kind)).add(s.point).add(s.axis).add(s.radius_mm);
    key.add(s.tube_radius_mm).add(s.half_angle_rad).add(s.inward ? 1.0 : 0.0);
    key.add(f.along_mm ? f.along_mm->lo : NAN).add(f.along_mm ? f.along_mm->hi : NAN);
    key.add(f.tolerance).add(f.iso_class).add(f.nominal_mm).add(f.position.zone_mm).add(f.width_to);
    key.add(static_cast<double>(f.position.condition));
  }
  return key;
}

struct LoadedMesh {
  SolidPtr solid;
  ImportReport report;
  std::vector<Feature> generated;  // features that a generator or an assembly brings
  std::vector<FreeformFace> freeform;
  std::vector<Scenario::FeatureSpec> stated;  // of which the mesh itself brings a tolerance
};

// All parts that are alike: mesh, features, band.
struct PartKind {
  SolidPtr solid;
  ImportReport report;
  std::vector<Feature> features;
  SurfaceBand band;
  StatedPart stated;
};

void add_undeclared(const Recognition& recognized, PartKind& kind) {
  for (Feature& feature :
       undeclared_features(recognized, kind.features, kind.solid->mesh().triangles.size())) {
    kind.features.push_back(std::move(feature));
    kind.stated.of_feature.push_back(kind.stated.rest);
  }
}

// Does the file give this feature a surface of its own?
bool declared_in_file(const Scenario::PartSpec& spec, const std::string& name) {
  return std::any_of(spec.features.begin(), spec.features.end(), [&](auto& f) {
    return f.name == name && f.surface.kind != SurfaceKind::kUnknown;
  });
}

Result<FeatureMatch> match_of(const Scenario::PartSpec& spec, const Scenario::FeatureSpec& declared,
                              const LoadedMesh& mesh) {
  FeatureDeclaration declaration{declared.name, declared.surface, declared.along_mm,
                                 spec.chord_error_mm.value_or(0.0)};
  const auto own = std::find_if(mesh.generated.begin(), mesh.generated.end(), [&](auto& f) {
    return f.name == declared.name && f.surface.kind == declared.surface.kind;
  });
  if (own == mesh.generated.end() || own->triangles.empty() || declared.along_mm ||
      declared_in_file(spec, declared.name))
    return match_feature(mesh.solid->mesh(), declaration);
  // The corners of a CAD file lie on its edges, which may be off its surfaces by what it states.
  if (spec.mesh.given || mesh.solid->mesh().stated)
    declaration.chord_error_mm = std::max(declaration.chord_error_mm, 1.001 * own->residual_mm);
  return check_feature(*mesh.solid, declaration, own->triangles);
}

// The file's features, those without a surface taking the generator's; then the generator's other
// ones, whose exact surface is known even where nobody speaks of them.
std::vector<Scenario::FeatureSpec> with_generated(const Scenario::PartSpec& spec,
                                                  const LoadedMesh& mesh) {
  std::vector<Scenario::FeatureSpec> specs = spec.features;
  for (const Feature& generated : mesh.generated) {
    const auto same =
        std::find_if(specs.begin(), specs.end(), [&](auto& s) { return s.name == generated.name; });
    if (same == specs.end()) {
      const auto stated =
          std::ranges::find(mesh.stated, generated.name, &Scenario::FeatureSpec::name);
      Scenario::FeatureSpec extra = stated == mesh.stated.end() ? Scenario::FeatureSpec{} : *stated;
      extra.name = generated.name;
      extra.surface = generated.surface;
      extra.at = spec.at;
      specs.push_back(std::move(extra));
    } else if (same->surface.kind == SurfaceKind::kUnknown) {
      same->surface = generated.surface;
    }
  }
  return specs;
}

std::string known_names(const LoadedMesh& mesh) {
  std::string names;
  for (const Feature& f : mesh.generated) names += (names.empty() ? "" : ", ") + f.name;
  return names.empty() ? "it has none; add kind: and the surface" : "known: " + names;
}

std::string not_known(const Scenario::PartSpec& spec, const LoadedMesh& mesh,
                      const Recognition* recognized) {
  if (spec.mesh.given)
    return "the part of " + spec.mesh.given->file + " has no feature of this name; " +
           known_names(mesh);
  if (spec.mesh.generator.empty() && recognized != nullptr)
    return "no feature of this name was recognized; " + recognized_names(*recognized);
  return "generator " + spec.mesh.generator + " has no feature of this name; " + known_names(mesh);
}

std::string told_of_open(const LoadedMesh& mesh) {
  const ImportReport& report = mesh.report;
  const std::string edges = std::to_string(report.boundary_edges) + " boundary, " +
                            std::to_string(report.non_manifold_edges) + " non-manifold, " +
                            std::to_string(report.misoriented_edges) + " misoriented edges";
  const bool volume = mesh.solid->topology().balanced();  // then it is the volume that is missing
  return ": mesh " + report.file +
         (mesh.solid->has_inside()
              ? " is open at " + std::to_string(mesh.solid->cracks().count) + " cracks (" + edges +
                    "): beside them its inside is not known, and a clash there potential at best; "
                    "repair it"
              : (volume ? " encloses no volume (" : " is open (") + edges +
                    "): crossing is found, depth is not, and what lies within it is not examined; "
                    "repair it for more than potential");
}

// What can be added while the session runs.
std::shared_ptr<PartShapes> make_shapes(const LoadedScene& scene, UndeclaredSurface undeclared) {
  auto shapes = std::make_shared<PartShapes>([undeclared](SolidPtr solid, double quantum_mm) {
    return shape_of(std::move(solid), quantum_mm, undeclared);
  });
  for (std::size_t i = 0; i < scene.world.parts.size(); ++i)
    shapes->add(scene.world.parts[i].solid, scene.imports[i].quantum_mm);
  return shapes;
}

/// Told again with each snapshot; a list of more is not read by people.
constexpr std::size_t kMostDeclared = 4096;

class SceneLoader {
 public:
  SceneLoader(const Scenario& scenario, const MeshProvider& meshes)
      : scenario_(scenario), meshes_(meshes) {}

  LoadedScene run() {
    World& world = scene_.world;
    world.name = scenario_.name;
    world.tick_rate_hz = scenario_.tick_rate_hz;
    world.threads = scenario_.threads;
    world.policy = scenario_.policy;
    world.max_jump_mm = scenario_.max_jump_mm;
    world.lease_s = scenario_.lease_s;
    world.may_hold = scenario_.users;
    for (const auto& spec : scenario_.parts) add_part(spec);
    // Rules speak of features: with a part missing they would only repeat what is said already.
    if (scene_.usable()) {
      RuleOutcome rules = rules_of({scenario_, world.parts, stated_});
      world.pair_rules = std::move(rules.pair_rules);
      world.approved_at_start = std::move(rules.approved_at_start);
      scene_.min_gaps_mm = std::move(rules.min_gaps_mm);
      scene_.fits = std::move(rules.fits);
      scene_.findings.insert(scene_.findings.end(), rules.findings.begin(), rules.findings.end());
      declare();
    }
    if (scene_.usable()) {
      world.rules = make_live_rules(scenario_, stated_);
      world.shapes = make_shapes(scene_, scenario_.undeclared_of_meshes());
    }
    if (scenario_.assembly) scene_.assembly = scenario_.assembly->sent;
    world.evaluates = evaluates(world);
    return std::move(scene_);
  }

 private:
  void finding(bool is_error, SourceLine at, const std::string& text) {
    scene_.findings.push_back({is_error, place_of(scenario_, at) + text});
  }

  // Fits and exclusions as participants are told of them.
  void declare() {
    World& world = scene_.world;
    std::map<std::string, PartId> ids;
    for (const Part& part : world.parts) ids.emplace(part.name, part.id);
    std::vector<Decision> all;
    for (const LoadedScene::ResolvedFit& fit : scene_.fits) {
      Decision& said = all.emplace_back();
      said.kind = Decision::Kind::kSetTolerance;
      said.part = ids.at(fit.part_a);
      said.details.other_part = ids.at(fit.part_b);
      said.details.feature = fit.feature_a;
      said.details.other_feature = fit.feature_b;
      said.details.text = fit.code;
    }
    for (const auto& [pair, rule] : world.pair_rules) {
      if (!rule.excluded) continue;
      Decision& said = all.emplace_back();
      said.kind = Decision::Kind::kSetExclusion;
      said.part = rule.a;
      said.details.other_part = rule.b;
      said.details.text = rule.reason;
    }
    if (all.size() > kMostDeclared) {
      scene_.findings.push_back({false, place_of(scenario_, {}) + "of " +
                                            std::to_string(all.size()) +
                                            " pairs with a fit or an exclusion participants are "
                                            "told the first " +
                                            std::to_string(kMostDeclared)});
      all.resize(kMostDeclared);
    }
    world.declared = std::move(all);
  }

  // 1. parts, one kind for all that are alike

  void add_part(const Scenario::PartSpec& spec) {
    const std::string key = key_of(spec).text();
    auto known = kind_of_.find(key);
    if (known == kind_of_.end()) {
      known = kind_of_.emplace(key, kinds_.size()).first;
      kinds_.push_back(make_kind(spec, kinds_.size()));
    }
    const std::optional<PartKind>& kind = kinds_[known->second];
    if (!kind) return;  // said once, at the first of them
    Part part;
    part.id = PartId{static_cast<std::uint32_t>(scene_.world.parts.size() + 1)};
    part.name = spec.name;
    part.solid = kind->solid;
    part.band = kind->band;
    part.features = kind->features;
    part.moving = spec.moving;
    part.X_WP = part.X_WP_scenario = spec.X_WP;
    part.notes = notes_of(kind->report);
    part.kind = static_cast<std::uint32_t>(known->second);
    scene_.imports.push_back(kind->report);
    scene_.mesh_of_part.push_back(kind->solid->hash());
    resolve_for_report(part);
    scene_.world.parts.push_back(std::move(part));
    stated_.push_back(kind->stated);
  }

  void resolve_for_report(const Part& part) {
    for (const SurfaceBand::Face& face : part.band.faces) {
      if (face.name.empty() && face.tolerance_source.empty() &&
          face.grade != DeviationGrade::kDeclaredChord)
        continue;
      // Estimated faces without a name: all in one line below.
      if (face.grade == DeviationGrade::kEstimated && face.name.empty()) continue;
      scene_.tolerances.push_back({part.name, face.name, face.tolerance_source, face.tolerance_mm,
                                   face.grade, face.deviation_mm, face.residual_mm});
    }
    if (const auto estimated = estimated_deviation_of(part.band))
      scene_.tolerances.push_back({part.name, "", part.band.faces[0].tolerance_source,
                                   part.band.faces[0].tolerance_mm, DeviationGrade::kEstimated,
                                   *estimated, 0.0});
  }

  std::optional<PartKind> make_kind(const Scenario::PartSpec& spec, std::size_t index) {
    const std::optional<LoadedMesh>& mesh = mesh_of(spec);
    return mesh ? make_kind(spec, *mesh, index, 0) : std::nullopt;
  }

 public:
  // threads: see RecognitionOptions.
  std::optional<PartKind> make_kind(const Scenario::PartSpec& spec, const LoadedMesh& mesh,
                                    std::size_t index, unsigned threads) {
    PartKind kind;
    kind.solid = mesh.solid;
    kind.report = mesh.report;
    kind.stated.kind = index;
    if (spec.tolerance)
      kind.stated.rest = {{spec.tolerance->offset_mm, spec.tolerance->text}, spec.tolerance->at};
    // Of a mesh whose file states its faces nothing is guessed.
    const bool recognizes =
        spec.undeclared != UndeclaredSurface::kNominal && !kind.solid->mesh().stated;
    std::shared_ptr<const Recognition> shown;
    if (recognizes)
      shown = recognized(*kind.solid, {.quantum_mm = kind.report.quantum_mm, .threads = threads});
    if (!match_features(spec, mesh, shown.get(), kind)) return std::nullopt;
    if (shown) add_undeclared(*shown, kind);
    kind.band = build_band({kind.solid.get(), kind.features, spec.chord_error_mm,
                            for_band(kind.stated.rest), for_band(kind.stated.of_feature),
                            recognizes, kind.report.quantum_mm, mesh.freeform});
    return kind;
  }
  const std::vector<Finding>& findings() const { return scene_.findings; }

 private:
  // 2. meshes, one a source, one solid a content

  const std::optional<LoadedMesh>& mesh_of(const Scenario::PartSpec& spec) {
    const std::string key = key_of(spec.mesh).text();
    const auto known = mesh_of_.find(key);
    if (known != mesh_of_.end()) return known->second;
    return mesh_of_.emplace(key, load_mesh(spec)).first->second;
  }

  std::optional<LoadedMesh> load_mesh(const Scenario::PartSpec& spec) {
    Result<ImportedMesh> imported = meshes_(scenario_, spec);
    if (!imported) {
      finding(true, spec.at, "part " + spec.name + ": " + imported.error().text);
      return std::nullopt;
    }
    if (imported->mesh.triangles.empty()) {
      finding(true, spec.at, "part " + spec.name + ": its mesh has no triangles; check the file");
      return std::nullopt;
    }
    LoadedMesh mesh;
    if (imported->mesh.stated && !take_stated(spec, *imported, mesh)) return std::nullopt;
    mesh.report = imported->report;
    SolidPtr solid = std::make_shared<const Solid>(std::move(imported->mesh));
    mesh.solid = solid_of_.emplace(solid->hash(), solid).first->second;
    for (const std::string& note : mesh.report.notes)
      finding(false, spec.at, "part " + spec.name + ": mesh " + mesh.report.file + ": " + note);
    if (!mesh.report.closed) finding(false, spec.at, "part " + spec.name + told_of_open(mesh));
    if (spec.mesh.given && mesh_hash(spec.mesh.given->mesh) == mesh.solid->hash()) {
      mesh.generated = spec.mesh.given->features;
      mesh.freeform = spec.mesh.given->freeform;
    }
    if (!spec.mesh.generator.empty()) {
      Result<GeneratedPart> generated = generate(spec.mesh.generator, spec.mesh.parameters);
      if (generated) {
        mirror_part(*generated, spec.mesh.mirror);
        // A mesh from elsewhere (a log) may be another one: then its faces are found, not known.
        if (mesh_hash(generated->mesh) != mesh.solid->hash())
          for (Feature& feature : generated->features) feature.triangles.clear();
        mesh.generated = std::move(generated->features);
      }
    }
    return mesh;
  }

  // A part of a STEP file that a session saved, or has in its log.
  bool take_stated(const Scenario::PartSpec& spec, ImportedMesh& imported, LoadedMesh& mesh) {
    Result<BroughtPart> brought = brought_part(imported.mesh);
    if (!brought) {
      finding(true, spec.at, "part " + spec.name + ": " + brought.error().text);
      return false;
    }
    mesh.generated = brought->given->features;
    mesh.freeform = brought->given->freeform;
    mesh.stated = std::move(brought->features);
    imported.report.notes = brought->given->notes;
    return true;
  }

  // 3. features

  bool match_features(const Scenario::PartSpec& spec, const LoadedMesh& mesh,
                      const Recognition* recognized, PartKind& kind) {
    std::vector<Scenario::FeatureSpec> specs = with_generated(spec, mesh);
    bool good = true;
    for (auto& declared : specs) {
      const std::string who = "part " + spec.name + ": feature " + declared.name + ": ";
      const bool named = declared.surface.kind == SurfaceKind::kUnknown;
      const Feature* own =
          named && recognized != nullptr ? find_recognized(*recognized, declared.name) : nullptr;
      if (named && own == nullptr) {
        finding(true, declared.at, who + not_known(spec, mesh, recognized));
        good = false;
        continue;
      }
      if (own != nullptr) declared.surface = own->surface;
      Result<FeatureMatch> match = own != nullptr ? Result<FeatureMatch>(FeatureMatch{*own, ""})
                                                  : match_of(spec, declared, mesh);
      if (!match) {
        finding(true, declared.at, who + match.error().text);
        good = false;
        continue;
      }
      if (!match->note.empty()) finding(false, declared.at, who + match->note);
      const bool in_file = &declared < specs.data() + spec.features.size();
      match->feature.origin = in_file ? FeatureOrigin::kDeclared : FeatureOrigin::kGenerated;
      kind.features.push_back(std::move(match->feature));
      Result<PlacedStatement> statement =
          statement_of_feature(declared, specs, kind.features.back().residual_mm, kind.stated.rest);
      if (!statement) {
        finding(true, declared.at, who + statement.error().text);
        good = false;
        continue;
      }
      kind.stated.of_feature.push_back(std::move(statement).value());
    }
    kind.stated.declared = std::move(specs);
    return good && share_out_triangles(spec, kind);
  }

  // A triangle that lies on two declared surfaces (a thin rim, or one round declared twice) belongs
  // to the one it lies closer to, the earlier one on a tie.
  bool share_out_triangles(const Scenario::PartSpec& spec, PartKind& kind) {
    const std::vector<std::int32_t> owner = owners_of(kind.features, kind.solid->mesh());
    bool good = true;
    for (std::int32_t f = 0; f < static_cast<std::int32_t>(kind.features.size()); ++f) {
      auto& mine = kind.features[f].triangles;
      const std::size_t before = mine.size();
      std::erase_if(mine, [&](std::uint32_t t) { return owner[t] != f; });
      if (mine.size() == before) continue;
      const std::string who = "part " + spec.name + ": feature " + kind.features[f].name + ": ";
      const SourceLine at = line_of_feature(spec, kind.features[f].name);
      if (mine.empty()) {
        finding(true, at,
                who +
                    "all of its triangles belong to another feature as well; say which "
                    "length each one has with along: [from, to]");
        good = false;
      } else if (2 * mine.size() < before) {
        finding(false, at,
                who + std::to_string(before - mine.size()) +
                    " triangles lie on another feature as well, which has them; along: "
                    "[from, to] tells them apart");
      }
    }
    return good;
  }

  static SourceLine line_of_feature(const Scenario::PartSpec& spec, const std::string& name) {
    for (const auto& feature : spec.features)
      if (feature.name == name) return feature.at;
    return spec.at;
  }

  const Scenario& scenario_;
  const MeshProvider& meshes_;
  LoadedScene scene_;
  std::vector<StatedPart> stated_;
  std::map<std::string, std::size_t> kind_of_;
  std::vector<std::optional<PartKind>> kinds_;  // nothing: could not be made, said in findings
  std::map<std::string, std::optional<LoadedMesh>> mesh_of_;
  std::map<std::string, SolidPtr> solid_of_;
};

// As the same part of an assembly is made.
Result<PartShape> shape_of_brought(const SolidPtr& solid, double quantum_mm) {
  const Result<BroughtPart> brought = brought_part(solid->mesh());
  if (!brought) return brought.error();
  Scenario scenario;
  scenario.file = brought->given->product;
  Scenario::PartSpec spec;
  spec.name = brought->given->product;
  spec.mesh.given = brought->given;
  spec.features = brought->features;
  LoadedMesh mesh{solid, {}, brought->given->features, brought->given->freeform, {}};
  mesh.report.quantum_mm = quantum_mm;
  const MeshProvider meshes = default_meshes();
  SceneLoader loader(scenario, meshes);
  std::optional<PartKind> kind = loader.make_kind(spec, mesh, 0, 1);
  if (!kind) {
    for (const Finding& finding : loader.findings())
      if (finding.is_error) return fail(Code::kInvalidInput, finding.text);
    return fail(Code::kInvalidInput, "it contradicts the mesh");
  }
  PartShape shape{solid, std::move(kind->features), std::move(kind->band)};
  shape.stated = std::make_shared<const StatedPart>(std::move(kind->stated));
  shape.notes = brought->given->notes;
  for (const Finding& finding : loader.findings()) shape.notes.push_back(finding.text);
  return shape;
}

}  // namespace

PartShape shape_of(SolidPtr solid, double quantum_mm, UndeclaredSurface undeclared) {
  std::vector<std::string> notes;
  if (solid->mesh().stated) {
    Result<PartShape> brought = shape_of_brought(solid, quantum_mm);
    if (brought) return std::move(brought).value();
    notes.push_back("its faces are not taken as its file states them: " + brought.error().text);
  }
  PartKind kind;
  kind.solid = solid;
  const bool recognizes = undeclared != UndeclaredSurface::kNominal;
  if (recognizes) add_undeclared(*recognized(*solid, {.quantum_mm = quantum_mm}), kind);
  PartShape shape{solid, kind.features, {}, {}, std::move(notes)};
  shape.band = build_band({solid.get(),
                           kind.features,
                           std::nullopt,
                           for_band(kind.stated.rest),
                           for_band(kind.stated.of_feature),
                           recognizes,
                           quantum_mm,
                           {}});
  return shape;
}

bool LoadedScene::usable() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.is_error; });
}

Result<LoadedScene> load_scene(const Scenario& scenario, const MeshProvider& meshes) {
  return SceneLoader(scenario, meshes).run();
}

}  // namespace mortise
