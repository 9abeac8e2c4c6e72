#include "common/io/scenario/saved_scenario.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <numbers>
#include <set>

#include "common/io/scenario/brought_part.h"
#include "common/io/step/step_document.h"
#include "common/messages/names.h"
#include "common/session/memory/session_state.h"
#include "common/session/world/standing.h"

namespace mortise {
namespace {

// The shortest that reads back as the same double.
std::string digits(double x) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, x).ptr};
}

YAML::Node list_of(std::initializer_list<double> values) {
  YAML::Node list;
  list.SetStyle(YAML::EmitterStyle::Flow);
  for (const double x : values) list.push_back(digits(x));
  return list;
}

YAML::Node vector_of(const Vec3& v) { return list_of({v.x(), v.y(), v.z()}); }

// Is it a class or a code ("H7", "Ø20 H7/g6"), and not a tolerance?
bool names_class(const YAML::Node& node) {
  if (!node.IsScalar()) return false;
  const std::string& text = node.Scalar();
  return !text.starts_with("±") && !text.starts_with("+") && !text.starts_with("profile") &&
         !text.starts_with("surface") &&
         std::ranges::any_of(text, [](unsigned char c) { return std::isalpha(c) != 0; });
}

// A tolerance of a pair as the keys of a fit: "±0.05", "profile 0.1 mm", "surface -0.02/0.01 mm".
void put_tolerance(const std::string& text, double unit_mm, YAML::Node& node) {
  const auto begins = [&](const char* word) { return text.starts_with(word); };
  const std::size_t at = text.find_first_of("-.0123456789", begins("+-")    ? 2
                                                            : begins("+/-") ? 3
                                                                            : 0);
  if (at == std::string::npos) return;
  const double in_file = text.find("mm") == std::string::npos ? 1.0 : unit_mm;
  char* rest = nullptr;
  const double first = std::strtod(text.c_str() + at, &rest) / in_file;
  if (begins("surface")) {
    node["lower"] = digits(first);
    node["upper"] = digits(std::strtod(rest + 1, nullptr) / in_file);
    return;
  }
  node[begins("profile") ? "profile" : "plus_minus"] = digits(first);
  if (const std::size_t uz = text.find("UZ"); uz != std::string::npos)
    node["unequal"] = digits(std::strtod(text.c_str() + uz + 2, nullptr) / in_file);
}

// Each part of the text by its name, as if it stood there alone.
std::map<std::string, YAML::Node> nodes_by_name(const YAML::Node& parts, const Scenario& scenario) {
  std::map<std::string, YAML::Node> nodes;
  for (const YAML::Node& node : parts) {
    const YAML::Node instances = node["instances"];
    const auto add = [&](const std::string& name, const YAML::Node& over) {
      YAML::Node part = YAML::Clone(node);
      part.remove("instances");
      part.remove("repeat");
      if (over && over["mirror"]) part["mirror"] = over["mirror"];
      part["name"] = name;
      nodes[name].reset(part);
    };
    if (instances) {
      for (const YAML::Node& instance : instances)
        add(instance["name"].as<std::string>(), instance);
    } else if (node["repeat"]) {
      const std::string stem = node["name"].as<std::string>() + "_";
      for (const auto& spec : scenario.parts)
        if (spec.name.starts_with(stem)) add(spec.name, YAML::Node());
    } else {
      add(node["name"].as<std::string>(), YAML::Node());
    }
  }
  return nodes;
}

// The parts of a STEP assembly as if somebody had brought them one by one: each with its mesh and
// what the file states of it.
class AssemblySolids {
 public:
  explicit AssemblySolids(const BegunScenario& begun) : begun_(begun) {
    const auto& assembly = begun.scenario.assembly;
    if (!assembly || !assembly->sent) return;
    Result<StepDocument> document = decode_step(*assembly->sent);
    if (document) document_ = std::move(*document);
  }

  bool is_as_begun(const Part& part) const {
    const std::size_t i = part.id.value - 1;
    return i < begun_.mesh_of_part.size() && begun_.mesh_of_part[i] == part.solid->hash();
  }

  // Of a part of the assembly, unless its mesh was replaced.
  const Scenario::PartSpec* spec_of(const Part& part) const {
    const std::size_t i = part.id.value - 1;
    const auto& parts = begun_.scenario.parts;
    return i < parts.size() && parts[i].mesh.given && is_as_begun(part) ? &parts[i] : nullptr;
  }

  // The mesh with what a STEP file states of it, where it is of one.
  SolidPtr solid_of(const Part& part) {
    const Scenario::PartSpec* spec = spec_of(part);
    if (part.solid->mesh().stated || spec == nullptr ||
        spec->mesh.given_number >= document_.parts.size())
      return part.solid;
    SolidPtr& made = made_[spec->mesh.given_number];
    if (made) return made;
    Result<TriangleMesh> mesh = brought_mesh(brought_bytes(document_, spec->mesh.given_number));
    made = mesh ? std::make_shared<const Solid>(std::move(*mesh)) : part.solid;
    return made;
  }

 private:
  const BegunScenario& begun_;
  StepDocument document_;
  std::map<std::uint32_t, SolidPtr> made_;
};

// What a scenario says of a face of an assembly, as the keys of a feature.
void put_statement(const Scenario::FeatureSpec& says, double unit_mm, YAML::Node at) {
  if (!says.iso_class.empty()) at["iso"] = says.iso_class;
  if (!says.iso_class.empty() && says.nominal_mm > 0.0)
    at["nominal"] = digits(says.nominal_mm / unit_mm);
  if (says.tolerance) {
    at["tolerance"]["lower"] = digits(says.tolerance->offset_mm.lo / unit_mm);
    at["tolerance"]["upper"] = digits(says.tolerance->offset_mm.hi / unit_mm);
  }
  if (!(says.position.zone_mm > 0.0)) return;
  at["position"]["zone"] = digits(says.position.zone_mm / unit_mm);
  constexpr const char* kAt[] = {"rfs", "mmc", "lmc"};
  at["position"]["at"] = kAt[static_cast<std::size_t>(says.position.condition)];
}

// What the file of an assembly states of a part is in its mesh; this is what the scenario says
// besides.
void put_statements(const Scenario::PartSpec& spec, double unit_mm, YAML::Node& node) {
  if (spec.tolerance) {
    node["tolerance"]["lower"] = digits(spec.tolerance->offset_mm.lo / unit_mm);
    node["tolerance"]["upper"] = digits(spec.tolerance->offset_mm.hi / unit_mm);
  }
  for (const Scenario::FeatureSpec& says : spec.features)
    if (says.by == Scenario::SaidBy::kScenario)
      put_statement(says, unit_mm, node["features"][says.name]);
}

class Writer {
 public:
  Writer(const BegunScenario& begun, const World& world)
      : begun_(begun),
        world_(world),
        scenario_(begun.scenario),
        root_(YAML::Load(begun.yaml)),
        assembly_(begun) {}

  SavedScenario run() {
    const auto before = nodes_by_name(root_["parts"], scenario_);
    YAML::Node parts(YAML::NodeType::Sequence);
    for (const Part& part : world_.parts)
      if (part.present) parts.push_back(node_of(part, before));
    root_["parts"] = parts;
    root_.remove("assembly");
    root_["policy"] = std::string(name_of(world_.policy));
    pairs();
    approvals();
    say_what_is_left_out();
    YAML::Emitter out;
    out << root_;
    std::string head = "# The session on " + world_.name + " as it stood after tick " +
                       std::to_string(world_.tick) + ".\n";
    for (const std::string& line : out_.left_out) head += "# Not kept: " + line + "\n";
    out_.yaml = head + out.c_str() + "\n";
    return std::move(out_);
  }

 private:
  // 1. parts

  YAML::Node node_of(const Part& part, const std::map<std::string, YAML::Node>& before) {
    const std::size_t i = part.id.value - 1;
    const bool is_named = i < scenario_.parts.size() && !scenario_.parts[i].mesh.given;
    YAML::Node node = is_named ? YAML::Clone(before.at(part.name)) : YAML::Node();
    node["name"] = part.name;
    const bool is_generated =
        is_named && !scenario_.parts[i].mesh.generator.empty() && assembly_.is_as_begun(part);
    if (!is_generated) {
      node.remove("generator");
      node.remove("mirror");
      node["mesh"]["file"] = file_of(part);
      node["mesh"]["unit"] = "mm";
      node["mesh"].remove("scale");
      if (!is_kept_whole(part)) surfaces(part, node);
      if (const auto* spec = assembly_.spec_of(part))
        put_statements(*spec, scenario_.unit_mm, node);
    }
    statements(part, node, is_generated);
    if (whole_of(part.id)) take_back(part, node);
    YAML::Node pose;
    pose["position"] = vector_of(part.X_WP.p / scenario_.unit_mm);
    const Eigen::Vector4d& q = part.X_WP.q.coeffs();
    pose["quaternion"] = list_of({q[3], q[0], q[1], q[2]});
    node["pose"] = pose;
    node["moving"] = part.moving;
    return node;
  }

  // Its mesh is kept with all that its file states of it, under the names that the faces have
  // there. Faces of a part that took this mesh may go by older names: then the mesh is kept alone.
  bool is_kept_whole(const Part& part) {
    const SolidPtr solid = assembly_.solid_of(part);
    if (!solid->mesh().stated) return false;
    const auto [known, is_new] = whole_.try_emplace(part.id, false);
    if (!is_new) return known->second;
    const Result<BroughtPart> brought = brought_part(solid->mesh());
    known->second = brought && std::ranges::all_of(part.features, [&](const Feature& feature) {
                      return std::ranges::any_of(brought->given->features, [&](const Feature& own) {
                        return own.name == feature.name;
                      });
                    });
    return known->second;
  }

  bool whole_of(PartId id) const {
    const auto known = whole_.find(id);
    return known != whole_.end() && known->second;
  }

  std::string file_of(const Part& part) {
    const bool whole = is_kept_whole(part);
    const std::string ending = whole ? kBroughtEnding : ".obj";
    std::string& name = files_[part.solid->hash() + ending];
    if (!name.empty()) return name;
    std::string stem = part.name;
    std::ranges::replace_if(
        stem, [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '-'; }, '_');
    name = "meshes/" + stem + ending;
    for (int n = 2; !names_.insert(name).second; ++n)
      name = "meshes/" + stem + "_" + std::to_string(n) + ending;
    out_.meshes.push_back({name, assembly_.solid_of(part), whole});
    return name;
  }

  // Of a mesh file surfaces are said in full; those of faces that it no longer has go.
  void surfaces(const Part& part, YAML::Node& node) {
    const YAML::Node said = node["features"];
    YAML::Node features;
    // Of a STEP file those of which something was said: the others may lie on one surface.
    const bool all = !assembly_.solid_of(part)->mesh().stated;
    for (const Feature& feature : part.features)
      if (feature.origin != FeatureOrigin::kRecognized && (all || (said && said[feature.name])))
        features[feature.name] = with_surface(feature, said ? said[feature.name] : YAML::Node());
    node.remove("features");
    if (features.size() > 0) node["features"] = features;
  }

  YAML::Node with_surface(const Feature& feature, const YAML::Node& said) const {
    YAML::Node node = said && said.IsMap() ? YAML::Clone(said) : YAML::Node();
    for (const char* key : {"diameter", "radius", "tube_radius", "half_angle_deg", "inward"})
      if (node.IsMap()) node.remove(key);
    const Surface& s = feature.surface;
    const double unit = scenario_.unit_mm;
    node["kind"] = std::string(name_of(s.kind));
    node["point"] = vector_of(s.point / unit);
    if (s.kind != SurfaceKind::kSphere) node["axis"] = vector_of(s.axis);
    if (s.radius_mm > 0.0) node["radius"] = digits(s.radius_mm / unit);
    if (s.kind == SurfaceKind::kTorus) node["tube_radius"] = digits(s.tube_radius_mm / unit);
    if (s.kind == SurfaceKind::kCone)
      node["half_angle_deg"] = digits(s.half_angle_rad * 180.0 / std::numbers::pi);
    if (s.inward) node["inward"] = true;
    return node;
  }

  // What the running session says of the part alone, and surfaces of recognized faces of which it
  // says something: their names are not those of another recognition.
  void statements(const Part& part, YAML::Node& node, bool is_generated) const {
    const auto name_face = [&](const std::string& name) {
      if (name.empty() || (node["features"] && node["features"][name])) return;
      const auto face = std::ranges::find(part.features, name, &Feature::name);
      if (face == part.features.end()) return;
      if (face->origin == FeatureOrigin::kGenerated && is_generated)
        return;                       // the generator knows it
      if (whole_of(part.id)) return;  // so does the mesh
      node["features"][name] = with_surface(*face, YAML::Node());
    };
    for (const Decision& said : standing_decisions(world_)) {
      if (said.kind != Decision::Kind::kSetTolerance) continue;
      const Details& d = said.details;
      if (said.part == part.id) name_face(d.feature);
      if (d.other_part == part.id) name_face(d.other_feature);
      if (said.part != part.id || d.other_part) continue;
      YAML::Node at = d.feature.empty() ? node : node["features"][d.feature];
      for (const char* key : {"iso", "nominal", "width_to", "tolerance", "position"})
        if (at.IsMap() && (!d.feature.empty() || std::string(key) == "tolerance")) at.remove(key);
      if (d.text.empty()) continue;
      const YAML::Node text = YAML::Load(d.text);
      if (!d.feature.empty() && names_class(text))
        at["iso"] = d.text;
      else if (text.IsMap() && !d.feature.empty() &&
               (text["iso"] || text["tolerance"] || text["position"]))
        for (const auto& entry : text) at[entry.first] = entry.second;
      else
        at["tolerance"] = text;
    }
  }

  // What the file of a mesh states of a face, and somebody has taken back: a feature that says
  // nothing.
  void take_back(const Part& part, YAML::Node& node) {
    const Result<BroughtPart> brought = brought_part(assembly_.solid_of(part)->mesh());
    if (!brought) return;
    for (const Scenario::FeatureSpec& stated : brought->features) {
      const auto face = std::ranges::find(part.band.faces, stated.name, &SurfaceBand::Face::name);
      if (face != part.band.faces.end() && face->tolerance_source.empty() &&
          !(node["features"] && node["features"][stated.name]))
        node["features"][stated.name] = YAML::Node(YAML::NodeType::Map);
    }
  }

  // 2. pairs

  std::string end(PartId id, const std::string& feature) const {
    const std::string& name = world_.find(id)->name;
    return feature.empty() ? name : name + "." + feature;
  }

  // What the scenario itself says is told in mm: "Ø20 H7/g6"; its file has a unit of its own.
  std::string code_in_file(const std::string& text) const {
    const std::string sign = "Ø";
    if (!text.starts_with(sign)) return text;
    char* rest = nullptr;
    const double nominal_mm = std::strtod(text.c_str() + sign.size(), &rest);
    return sign + digits(nominal_mm / scenario_.unit_mm) + rest;
  }

  YAML::Node between(const std::string& a, const std::string& b) const {
    YAML::Node node;
    node["between"].push_back(a);
    node["between"].push_back(b);
    node["between"].SetStyle(YAML::EmitterStyle::Flow);
    return node;
  }

  void pairs() {
    YAML::Node fits(YAML::NodeType::Sequence), exclusions(YAML::NodeType::Sequence);
    for (const Decision& said : standing_decisions(world_)) {
      const Details& d = said.details;
      if (!d.other_part || d.text.empty()) continue;
      YAML::Node node = between(end(said.part, d.feature), end(d.other_part, d.other_feature));
      if (said.kind == Decision::Kind::kSetExclusion) {
        node["reason"] = d.text;
        exclusions.push_back(node);
      }
      if (said.kind != Decision::Kind::kSetTolerance) continue;
      const YAML::Node text = YAML::Load(d.text);
      if (names_class(text))
        node["code"] = said.user ? d.text : code_in_file(d.text);
      else if (text.IsMap())
        for (const auto& entry : text) node[entry.first] = entry.second;
      else
        put_tolerance(d.text, scenario_.unit_mm, node);
      fits.push_back(node);
    }
    const auto put = [&](const char* key, const YAML::Node& list) {
      root_.remove(key);
      if (list.size() > 0) root_[key] = list;
    };
    put("fits", fits);
    put("exclusions", exclusions);
  }

  void approvals() {
    YAML::Node list(YAML::NodeType::Sequence);
    std::set<PartPair> seen;
    if (world_.state)
      for (const auto& [ids, clashes] : world_.state->open)
        for (const OpenClash& clash : clashes) {
          const Review& review = clash.last.review;
          if (review.status != ReviewStatus::kApproved || !seen.insert(ids).second) continue;
          YAML::Node node = between(end(ids.first, ""), end(ids.second, ""));
          const User* by = world_.find(review.user);
          node["reason"] =
              !review.comment.empty() ? review.comment : "approved" + (by ? " by " + by->name : "");
          list.push_back(node);
        }
    root_.remove("approvals");
    if (list.size() > 0) root_["approvals"] = list;
  }

  // 3. the rest

  void say_what_is_left_out() {
    const auto say = [&](std::size_t count, const std::string& what) {
      if (count > 0) out_.left_out.push_back(std::to_string(count) + " " + what);
    };
    say(static_cast<std::size_t>(std::ranges::count_if(
            world_.parts,
            [&](const Part& p) {
              return p.present && assembly_.solid_of(p)->mesh().stated && !whole_of(p.id);
            })),
        "parts that took a mesh of a STEP file: of its exact surfaces those are kept of which "
        "something was said, of its tolerances none");
    if (scenario_.assembly)
      say(scenario_.assembly->bought.size(),
          "names of what is bought: mortise check reports what is inside of it");
    say(world_.guides.size(), "constraints: they belong to who holds the part");
    say(static_cast<std::size_t>(
            std::ranges::count_if(world_.parts, [](const Part& p) { return bool(p.holder); })),
        "parts in somebody's hand: they are free");
    say(world_.remarks.size(), "remarks on clashes: of reviews approvals alone are kept");
    say(static_cast<std::size_t>(std::ranges::count_if(
            world_.parts, [](const Part& p) { return !p.history.done.empty(); })),
        "parts have moves that could be undone: undo begins anew");
  }

  const BegunScenario& begun_;
  const World& world_;
  const Scenario& scenario_;
  YAML::Node root_;
  AssemblySolids assembly_;
  SavedScenario out_;
  std::map<std::string, std::string> files_;  ///< by hash of the mesh and ending
  std::map<PartId, bool> whole_;              ///< see is_kept_whole()
  std::set<std::string> names_;
};

}  // namespace

Result<SavedScenario> saved_scenario(const BegunScenario& begun, const World& world) try {
  return Writer(begun, world).run();
} catch (const YAML::Exception& error) {
  return fail(Code::kInvalidInput, "the scenario of the log is not valid YAML: " + error.msg);
}

}  // namespace mortise
