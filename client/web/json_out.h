#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "client/web/frames.h"
#include "common/messages/channel.h"

namespace mortise::web {

using Json = nlohmann::ordered_json;

/// Class bits of parts (frames.h), by id; a missing part has 0.
using ClassBits = std::map<PartId, std::uint32_t>;

/// Messages to pages, as in protocol.md.
Json json_of(const Vec3& v);
Json json_of(const Pose& pose);  ///< {"p": [3], "q": [x, y, z, w]}
Json json_of(const PartInfo& part, std::uint32_t classes);
Json json_of(const UserInfo& user);
Json json_of(const ClashEvent& event);
Json json_of(const Decision& decision);
Json json_of(const Remark& remark);
Json json_of(const UnexaminedRow& row);
Json json_of(const SessionPulse& pulse);
Json percentiles_of(std::vector<double> samples_ms);  ///< null without any

/// A list under a key of a message: {"type": type, key: [...]}.
template <class Values>
Json message_of_list(const char* type, const char* key, const Values& values) {
  Json json{{"type", type}, {key, Json::array()}};
  for (const auto& value : values) json[key].push_back(json_of(value));
  return json;
}

struct Scene {
  std::string session, policy;
  std::uint64_t tick = 0;
  double tick_rate_hz = 0.0;
  std::vector<PartInfo> parts;
  std::vector<UserInfo> users;
  std::vector<ClashEvent> clashes;
  std::vector<Decision> standing;
  std::vector<PartNote> notes;
  std::vector<Remark> remarks;
};
Json json_of(const Scene& scene, const ClassBits& classes);

ClassBits class_bits_of(std::span<const ClashEvent> open);

/// The text of a frame. Invalid UTF-8 in names is replaced.
SharedBytes text_of(const Json& json);

}  // namespace mortise::web
