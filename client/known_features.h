#pragma once
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/messages/feature_info.h"

namespace mortise {

/// What constraints can name, by part: the newest table that the server told. Alike parts share
/// their list.
class KnownFeatures {
 public:
  void take(const FeatureTable& table);
  void clear() { *this = {}; }

  std::span<const FeatureInfo> of(PartId part) const;                   ///< empty: none are known
  const FeatureInfo* find(PartId part, const std::string& name) const;  ///< null: unknown

  bool told() const { return told_; }                               ///< a table has come
  std::uint32_t meshes_waiting() const { return meshes_waiting_; }  ///< then another one comes
  std::uint32_t meshes_too_large() const { return meshes_too_large_; }
  std::uint32_t left_out() const { return left_out_; }

 private:
  using List = std::shared_ptr<const std::vector<FeatureInfo>>;
  std::map<PartId, List> of_part_;
  bool told_ = false;
  std::uint32_t meshes_waiting_ = 0, meshes_too_large_ = 0, left_out_ = 0;
};

}  // namespace mortise
