#include "server/json_lines.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "common/base/json_text.h"

namespace mortise {

std::string json_line(const LogMessage& message) {
  using namespace std::chrono;
  const auto ms = duration_cast<milliseconds>(message.time.time_since_epoch()).count() % 1000;
  nlohmann::ordered_json line;
  line["time"] = fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                             fmt::gmtime(system_clock::to_time_t(message.time)), ms);
  line["level"] = name_of(message.level);
  line["program"] = message.program;
  line["message"] = message.text;
  return json_text(line, -1) + "\n";
}

}  // namespace mortise
