#include "common/io/scenario/assembly_parts.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "common/base/nearest_word.h"
#include "common/base/plain_text.h"
#include "common/io/scenario/general_tolerance.h"
#include "common/io/scenario/product_information.h"
#include "common/io/step/given_parts.h"
#include "common/io/step/step_import.h"
#include "common/io/step/step_objections.h"
#include "common/session/world/rights.h"

namespace mortise {
namespace {

// An address agrees with a face to the digits that people copy.
constexpr double kAgreesSize_mm = 1e-3, kAgreesPlace_mm = 1e-3, kAgreesDirection = 1e-4;

class AssemblyPlacer {
 public:
  AssemblyPlacer(ScenarioReading& reading, const StepDocument& document)
      : reading_(reading),
        scenario_(reading.scenario),
        assembly_(*reading.scenario.assembly),
        document_(document) {}

  void run() {
    assembly_.not_solid = document_.not_solid;
    for (const std::string& note : document_.notes) say(false, assembly_.at, note);
    if (is_crowded(document_)) {
      say(true, assembly_.at,
          "its " + std::to_string(document_.instances.size()) + " instances meet in more than " +
              std::to_string(kMostStepPairs) + " pairs; export a part of the assembly");
      return;
    }
    for (std::size_t i = 0; i < document_.parts.size(); ++i) {
      const StepPart& part = document_.parts[i];
      if (part.faces.size() > kMostPartFaces) {
        say(true, assembly_.at,
            "part " + part.name + " has " + std::to_string(part.faces.size()) +
                " faces, more than " + std::to_string(kMostPartFaces) + "; split or simplify it");
        return;
      }
      given_.push_back(given_part(part, assembly_.file,
                                  groups_of_faces(document_, static_cast<std::uint32_t>(i))));
    }
    std::vector<PartStatements> stated = statements_of(document_, given_, assembly_.listed);
    for (const StepInstance& instance : document_.instances) add(instance, stated);
    for (const auto& statement : assembly_.statements) apply(statement);
  }

 private:
  void say(bool is_error, SourceLine at, const std::string& text) {
    const std::string place =
        at.line > 0 ? scenario_.file + ":" + std::to_string(at.line) + ": " : "";
    reading_.findings.push_back({is_error, place + assembly_.file + ": " + text});
  }

  void add(const StepInstance& instance, const std::vector<PartStatements>& stated) {
    Scenario::PartSpec part;
    part.name = unique(part_name_of(instance.path));
    part.mesh.given = given_[instance.part].part;
    part.mesh.given_number = instance.part;
    part.mesh.file = assembly_.file;
    part.X_WP = instance.X_WP;
    part.at = assembly_.at;
    part.products = instance.products;
    part.moving = !matches_any(assembly_.fixed, part.name);
    part.bought = matches_any(assembly_.bought, part.name) || has_bought_product(part.products);
    part.features = stated[instance.part].features;
    general_sizes(part);
    scenario_.parts.push_back(std::move(part));
  }

  std::string unique(const std::string& name) {
    std::string numbered = name;
    for (int i = 2; !names_.insert(numbered).second; ++i)
      numbered =
          name.substr(0, utf8_prefix(std::string_view(name).substr(0, kMostName_bytes - 7))) + "_" +
          std::to_string(i);
    return numbered;
  }

  static bool matches_any(const std::vector<std::string>& patterns, const std::string& name) {
    return std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
      return matches_name(pattern, name) || matches_name(pattern + "/*", name);
    });
  }

  bool has_bought_product(const std::string& products) const {
    for (std::size_t from = 0; from <= products.size();) {
      const std::size_t to = std::min(products.find('/', from), products.size());
      if (const std::string product = products.substr(from, to - from);
          std::any_of(assembly_.bought.begin(), assembly_.bought.end(),
                      [&](const std::string& pattern) { return matches_name(pattern, product); }))
        return true;
      from = to + 1;
    }
    return false;
  }

  // The general tolerance of the title block holds for sizes that nobody has stated.
  void general_sizes(Scenario::PartSpec& part) const {
    if (assembly_.general.empty()) return;
    for (const Feature& feature : part.mesh.given->features) {
      const SurfaceKind kind = feature.surface.kind;
      if (kind != SurfaceKind::kCylinder && kind != SurfaceKind::kSphere) continue;
      const auto stated = std::find_if(part.features.begin(), part.features.end(),
                                       [&](auto& f) { return f.name == feature.name; });
      if (stated != part.features.end() && (stated->tolerance || !stated->iso_class.empty()))
        continue;
      const double diameter = 2.0 * feature.surface.radius_mm;
      const auto deviation = general_deviation_mm(assembly_.general, diameter);
      if (!deviation) continue;
      const Scenario::Tolerance tolerance{{-0.5 * *deviation, 0.5 * *deviation},
                                          "Ø" + size_text(diameter) + " ±" + size_text(*deviation) +
                                              " ISO 2768-" + assembly_.general,
                                          assembly_.at};
      if (stated != part.features.end()) {
        stated->tolerance = tolerance;
        continue;
      }
      Scenario::FeatureSpec spec;
      spec.name = feature.name;
      spec.tolerance = tolerance;
      spec.at = assembly_.at;
      part.features.push_back(std::move(spec));
    }
  }

  static bool agrees(const Scenario::FaceAddress& address, const Surface& s) {
    if (s.kind != address.kind) return false;
    const double size = s.kind == SurfaceKind::kTorus ? s.tube_radius_mm : s.radius_mm;
    if (address.radius_mm > 0.0 && std::fabs(size - address.radius_mm) > kAgreesSize_mm)
      return false;
    if (address.inward && *address.inward != s.inward) return false;
    if (address.axis) {
      const double along = address.axis->dot(s.axis);
      if ((s.kind == SurfaceKind::kPlane ? along : std::fabs(along)) < 1.0 - kAgreesDirection)
        return false;
    }
    if (!address.point) return true;
    const Vec3 off = *address.point - s.point;
    switch (s.kind) {
      case SurfaceKind::kPlane:
        return std::fabs(off.dot(s.axis)) <= kAgreesPlace_mm;
      case SurfaceKind::kCylinder:
        return (off - off.dot(s.axis) * s.axis).norm() <= kAgreesPlace_mm;
      default:
        return off.norm() <= kAgreesPlace_mm;
    }
  }

  void apply(const Scenario::AssemblySpec::Statement& statement) {
    std::size_t parts = 0, faces = 0;
    for (Scenario::PartSpec& part : scenario_.parts) {
      if (!part.mesh.given || !matches_name(statement.part, part.name)) continue;
      ++parts;
      if (!statement.face) {
        part.tolerance = statement.says.tolerance;
        continue;
      }
      for (const Feature& feature : part.mesh.given->features)
        if (agrees(*statement.face, feature.surface)) {
          ++faces;
          state(part, feature.name, statement.says);
        }
    }
    if (parts == 0) {
      std::vector<std::string> names;
      for (const Scenario::PartSpec& part : scenario_.parts) names.push_back(part.name);
      say(false, statement.at,
          "statement not used: no part is called '" + statement.part + "'" +
              did_you_mean(statement.part, names));
    } else if (statement.face && faces == 0) {
      say(false, statement.at,
          "statement not used: '" + statement.part + "' has no such face any more");
    }
  }

  // The scenario's statement takes the place of the file's own.
  static void state(Scenario::PartSpec& part, const std::string& name,
                    const Scenario::FeatureSpec& says) {
    Scenario::FeatureSpec spec = says;
    spec.name = name;
    const auto known = std::find_if(part.features.begin(), part.features.end(),
                                    [&](auto& f) { return f.name == name; });
    if (known == part.features.end()) {
      part.features.push_back(std::move(spec));
      return;
    }
    if (spec.iso_class.empty() && !spec.tolerance) {  // a position alone leaves the size
      known->position = spec.position;
      return;
    }
    *known = std::move(spec);
  }

  ScenarioReading& reading_;
  Scenario& scenario_;
  Scenario::AssemblySpec& assembly_;
  const StepDocument& document_;
  std::vector<StepPartGiven> given_;
  std::set<std::string> names_;
};

// The text names the STEP file, which may be all that there is.
void fail_with(ScenarioReading& reading, const std::string& text) {
  const int line = reading.scenario.assembly->at.line;
  const std::string place =
      line > 0 ? reading.scenario.file + ":" + std::to_string(line) + ": " : "";
  reading.findings.push_back({true, place + text});
}

}  // namespace

std::string part_name_of(const std::string& path) {
  std::string name = one_line(path);
  for (char& c : name)
    if (c == '.' || c == '*') c = '_';
  if (name.size() > kMostName_bytes - 8) {  // the end tells parts apart
    std::size_t from = name.size() - (kMostName_bytes - 12);
    while (from < name.size() && (static_cast<unsigned char>(name[from]) & 0xc0U) == 0x80U) ++from;
    name = "…" + name.substr(from);
  }
  return is_name(name) ? name : "part";
}

void add_assembly(ScenarioReading& reading, std::span<const std::byte> sent) {
  if (!reading.scenario.assembly || !reading.usable()) return;
  const Result<StepDocument> document = decode_step(sent);
  if (!document) {
    fail_with(reading, document.error().text);
    return;
  }
  reading.scenario.assembly->sent =
      std::make_shared<const std::vector<std::byte>>(sent.begin(), sent.end());
  AssemblyPlacer(reading, *document).run();
}

std::vector<std::string> not_read_of(const StepDocument& document) {
  std::vector<std::string> lost;
  for (const std::string& note : document.notes)
    if (!note.ends_with(kWithoutFaces)) lost.push_back(note);
  for (const StepPart& part : document.parts)
    if (part.untriangulated > 0)
      lost.push_back(part.name + ": " + std::to_string(part.untriangulated) +
                     " faces could not be tessellated");
  return lost;
}

std::vector<std::string> not_read_of(const Scenario& scenario) {
  if (!scenario.assembly || !scenario.assembly->sent) return {};
  const Result<StepDocument> document = decode_step(*scenario.assembly->sent);
  return document ? not_read_of(*document) : std::vector{document.error().text};
}

void add_assembly(ScenarioReading& reading) {
  if (!reading.scenario.assembly || !reading.usable()) return;
  const std::filesystem::path folder = std::filesystem::path(reading.scenario.file).parent_path();
  Result<StepAssembly> assembly =
      import_step(folder / reading.scenario.assembly->file, reading.assembly);
  if (!assembly) {
    fail_with(reading, assembly.error().text);
    return;
  }
  reading.scenario.assembly->sent =
      std::make_shared<const std::vector<std::byte>>(std::move(assembly->bytes));
  reading.exact = std::move(assembly->exact);
  AssemblyPlacer(reading, assembly->document).run();
}

}  // namespace mortise
