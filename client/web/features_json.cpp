#include "client/web/features_json.h"

#include <array>

#include "common/messages/names.h"

namespace mortise::web {
namespace {

constexpr std::array<const char*, kFeatureOriginCount> kOrigins = {"unknown", "declared",
                                                                   "generated", "recognized"};

template <std::size_t n, class Enum>
const char* name_in(const std::array<const char*, n>& names, Enum value) {
  const auto index = static_cast<std::size_t>(value);
  return names[index < n ? index : 0];
}

Json feature_json(const FeatureInfo& feature) {
  return {{"name", feature.name},
          {"origin", name_in(kOrigins, feature.origin)},
          {"kind", name_of(feature.kind)},
          {"inward", feature.inward},
          {"point", json_of(feature.point_P)},
          {"axis", json_of(feature.axis_P)},
          {"radius", feature.radius_mm},
          {"tube_radius", feature.tube_radius_mm},
          {"half_angle", feature.half_angle_rad},
          {"along", {feature.along_mm.lo, feature.along_mm.hi}},
          {"middle", json_of(feature.middle_P)}};
}

}  // namespace

Json features_message(const Client& client) {
  const KnownFeatures& known = client.features();
  std::map<const FeatureInfo*, Json> sets;  // by the list that parts share
  for (const auto& [id, part] : client.parts()) {
    const auto features = known.of(id);
    if (features.empty()) continue;
    Json& set = sets[features.data()];
    if (set.is_null()) {
      set = {{"parts", Json::array()}, {"features", Json::array()}};
      for (const FeatureInfo& feature : features) set["features"].push_back(feature_json(feature));
    }
    set["parts"].push_back(id.value);
  }
  Json json{{"type", "features"},
            {"sets", Json::array()},
            {"waiting", known.meshes_waiting()},
            {"too_large", known.meshes_too_large()},
            {"left_out", known.left_out()}};
  for (auto& [list, set] : sets) json["sets"].push_back(std::move(set));
  return json;
}

}  // namespace mortise::web
