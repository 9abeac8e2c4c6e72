#include "common/session/guide/feature_table.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "common/geometry/same_face.h"
#include "common/session/guide/guidance.h"

namespace mortise {
namespace {

bool may_be_recognized(const Solid& solid) {
  return solid.mesh().triangles.size() <= kRecognizedOnDemand;
}

bool same(const Surface& a, const Surface& b) {
  return a.kind == b.kind && a.point == b.point && a.axis == b.axis && a.radius_mm == b.radius_mm &&
         a.tube_radius_mm == b.tube_radius_mm && a.half_angle_rad == b.half_angle_rad &&
         a.inward == b.inward;
}

// Do both have the same features? Their meshes are the same.
bool alike(const FeatureSources::OfPart& a, const FeatureSources::OfPart& b) {
  return std::equal(a.features.begin(), a.features.end(), b.features.begin(), b.features.end(),
                    [](const Feature& x, const Feature& y) {
                      return x.name == y.name && x.origin == y.origin && same(x.surface, y.surface);
                    });
}

FeatureInfo told(const Feature& feature, const TriangleMesh& mesh) {
  FeatureInfo info;
  info.name = feature.name;
  info.origin = feature.origin;
  info.kind = feature.surface.kind;
  info.inward = feature.surface.inward;
  info.point_P = feature.surface.point;
  info.axis_P = feature.surface.axis.normalized();
  info.radius_mm = feature.surface.radius_mm;
  info.tube_radius_mm = feature.surface.tube_radius_mm;
  info.half_angle_rad = feature.surface.half_angle_rad;
  info.middle_P = middle_of(feature, mesh);
  Interval along{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const std::uint32_t t : feature.triangles)
    for (int k = 0; k < 3; ++k) {
      const double z_mm = (mesh.corner(t, k) - info.point_P).dot(info.axis_P);
      along = hull(along, {z_mm, z_mm});
    }
  if (along.lo <= along.hi) info.along_mm = along;
  return info;
}

// Of one part: what the load knows, then what its mesh shows beside.
std::vector<FeatureInfo> features_of(const FeatureSources::OfPart& part) {
  const TriangleMesh& mesh = part.solid->mesh();
  const std::vector<Feature>* shown = part.shown.get();
  std::vector<FeatureInfo> features;
  std::vector<bool> taken(shown != nullptr ? mesh.triangles.size() : 0, false);
  std::set<std::string> names;
  for (const Feature& feature : part.features) {
    names.insert(feature.name);
    if (feature.surface.kind != SurfaceKind::kUnknown) features.push_back(told(feature, mesh));
    for (const std::uint32_t t : feature.triangles)
      if (t < taken.size()) taken[t] = true;
  }
  if (shown == nullptr) return features;
  for (const Feature& feature : *shown) {
    const bool covered = std::all_of(feature.triangles.begin(), feature.triangles.end(),
                                     [&](std::uint32_t t) { return taken[t]; });
    if (!covered && !names.contains(feature.name)) features.push_back(told(feature, mesh));
  }
  return features;
}

struct Kind {
  const FeatureSources::OfPart* first;
  std::vector<PartId> parts;
};

// Alike parts together, in the order of the first of each kind.
std::vector<Kind> kinds_of(const FeatureSources& sources) {
  std::vector<Kind> kinds;
  std::map<std::string, std::vector<std::size_t>> by_mesh;
  for (const FeatureSources::OfPart& part : sources.parts) {
    std::vector<std::size_t>& candidates = by_mesh[part.solid->hash()];
    const auto known = std::find_if(candidates.begin(), candidates.end(),
                                    [&](std::size_t k) { return alike(*kinds[k].first, part); });
    if (known != candidates.end()) {
      kinds[*known].parts.push_back(part.part);
      continue;
    }
    candidates.push_back(kinds.size());
    kinds.push_back({&part, {part.part}});
  }
  return kinds;
}

}  // namespace

FeatureSources feature_sources(const World& world) {
  FeatureSources sources;
  for (const Part& part : world.parts) {
    if (!part.present) continue;
    const auto shown = world.recognized.find(part.solid->hash());
    sources.parts.push_back({part.id, part.solid, part.features,
                             shown == world.recognized.end() ? nullptr : shown->second});
  }
  return sources;
}

FeatureTable feature_table(const World& world, std::size_t most) {
  return feature_table(feature_sources(world), most);
}

FeatureTable feature_table(const FeatureSources& sources, std::size_t most) {
  FeatureTable table;
  std::size_t entries = 0;
  std::set<std::string> waiting, too_large;
  for (Kind& kind : kinds_of(sources)) {
    const Solid& solid = *kind.first->solid;
    if (!kind.first->shown) (may_be_recognized(solid) ? waiting : too_large).insert(solid.hash());
    std::vector<FeatureInfo> features = features_of(*kind.first);
    if (features.empty()) continue;
    if (entries + features.size() > most) {
      table.left_out += static_cast<std::uint32_t>(features.size());
      continue;
    }
    entries += features.size();
    table.sets.push_back({std::move(kind.parts), std::move(features)});
  }
  table.meshes_waiting = static_cast<std::uint32_t>(waiting.size());
  table.meshes_too_large = static_cast<std::uint32_t>(too_large.size());
  return table;
}

std::vector<SolidPtr> unrecognized_meshes(const World& world) {
  std::vector<SolidPtr> meshes;
  std::set<std::string> seen;
  for (const Part& part : world.parts) {
    if (!part.present || !may_be_recognized(*part.solid) ||
        world.recognized.contains(part.solid->hash()))
      continue;
    if (seen.insert(part.solid->hash()).second) meshes.push_back(part.solid);
  }
  std::stable_sort(meshes.begin(), meshes.end(), [](const SolidPtr& a, const SolidPtr& b) {
    return a->mesh().triangles.size() < b->mesh().triangles.size();
  });
  return meshes;
}

}  // namespace mortise
