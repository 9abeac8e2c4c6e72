#include "client/known_features.h"

#include <algorithm>

namespace mortise {

void KnownFeatures::take(const FeatureTable& table) {
  of_part_.clear();
  told_ = true;
  meshes_waiting_ = table.meshes_waiting;
  meshes_too_large_ = table.meshes_too_large;
  left_out_ = table.left_out;
  for (const FeatureSet& set : table.sets) {
    const auto list = std::make_shared<const std::vector<FeatureInfo>>(set.features);
    // A long list comes in pieces, each for the same parts: put together once for all of them.
    std::map<const std::vector<FeatureInfo>*, List> longer;
    for (const PartId part : set.parts) {
      List& known = of_part_[part];
      if (!known) {
        known = list;
        continue;
      }
      List& joined = longer[known.get()];
      if (!joined) {
        std::vector<FeatureInfo> both = *known;
        both.insert(both.end(), list->begin(), list->end());
        joined = std::make_shared<const std::vector<FeatureInfo>>(std::move(both));
      }
      known = joined;
    }
  }
}

std::span<const FeatureInfo> KnownFeatures::of(PartId part) const {
  const auto known = of_part_.find(part);
  if (known == of_part_.end()) return {};
  return *known->second;
}

const FeatureInfo* KnownFeatures::find(PartId part, const std::string& name) const {
  const auto features = of(part);
  const auto found = std::find_if(features.begin(), features.end(),
                                  [&](const FeatureInfo& feature) { return feature.name == name; });
  return found == features.end() ? nullptr : &*found;
}

}  // namespace mortise
