#pragma once
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "client/bot/behaviour.h"
#include "client/bot/options.h"

namespace mortise {

/// What one process of bots measured: its report, and the samples that are needed to merge it with
/// others.
struct ProcessReport {
  nlohmann::ordered_json document;
  std::vector<double> latency_ms, event_latency_ms;
  std::map<std::uint64_t, std::uint64_t> stream_blocks;  ///< see stream_digest.h
};

std::vector<std::uint8_t> to_bytes(const ProcessReport& report);
/// False when the bytes are no report: the process ended before it could write one.
bool from_bytes(const std::vector<std::uint8_t>& bytes, ProcessReport& report);

/// p50, p90, p99 and max by nearest rank, 0 without samples; and their number.
nlohmann::ordered_json percentiles(std::vector<double> values);

/// The outcome of attempts to insert parts; null without any.
nlohmann::ordered_json insertions_json(const std::vector<std::unique_ptr<Behaviour>>& behaviours);

/// One document of all processes: counts are sums, percentiles are of all samples, and
/// `streams` says whether all saw the same sequence of events.
nlohmann::ordered_json merged(const std::vector<ProcessReport>& reports);

/// Two parts whatever comes first, as key of the document's `worst_classes`.
std::string pair_key(const std::string& part_a, const std::string& part_b);

/// The limit that expects a clash, besides limit_names().
inline constexpr const char* kExpectClash = "expect_clash";

/// Names that --limit knows, with their meaning.
const std::vector<std::pair<std::string, std::string>>& limit_names();

/// A limit and its outcome.
struct LimitResult {
  Limit limit;
  std::string meaning;
  double figure = 0.0;
  bool holds = false;
};
std::vector<LimitResult> check_limits(const nlohmann::ordered_json& document,
                                      const std::vector<Limit>& limits);
nlohmann::ordered_json json_of(const std::vector<LimitResult>& results);

/// The limits as a JUnit document, a test case each.
std::string junit(const std::vector<LimitResult>& results, double seconds);

}  // namespace mortise
