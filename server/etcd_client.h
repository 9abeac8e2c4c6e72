#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/result.h"

namespace mortise {

/// Asks the etcd of a site over its JSON gateway (version 3), one request after the other. Blocks
/// for at most kAnswer_s a node: for a thread beside the ticks.
class EtcdClient {
 public:
  /// Three silent nodes, asked one after the other, take 2.4 s: two rounds within a lease of
  /// EtcdFencing::kLease_s.
  static constexpr double kAnswer_s = 0.8;
  /// IPv4:PORT of its nodes, comma between; with or without "http://". Fails where one is none.
  static Result<EtcdClient> open(const std::string& nodes);

  /// The answer of the first node that has one, that of the last time first; none: nobody knows
  /// whether the request took effect, or will.
  std::optional<nlohmann::json> ask(const std::string& what, const nlohmann::json& request);

  struct Value {
    std::string text;
    std::int64_t revision = 0;  ///< of its last change; 0: there is none
  };
  /// What stands at a key now.
  std::optional<Value> read(const std::string& key);

  static nlohmann::json unchanged_since(const std::string& key, std::int64_t revision);
  static nlohmann::json put(const std::string& key, const std::string& text,
                            std::int64_t lease = 0);
  /// Of an answer: null, or 0, where it has none, whatever it is.
  static const nlohmann::json& member(const nlohmann::json& object, const char* name);
  static std::int64_t number(const nlohmann::json& object, const char* name);

 private:
  std::vector<std::pair<std::string, std::uint16_t>> nodes_;
  std::size_t last_ = 0;
};

}  // namespace mortise
