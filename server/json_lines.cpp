#include "server/json_lines.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <spdlog/details/log_msg.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "common/base/json_text.h"

namespace mortise {
namespace {

std::string_view view_of(spdlog::string_view_t text) { return {text.data(), text.size()}; }

class JsonLines final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
    using namespace std::chrono;
    const auto since = message.time.time_since_epoch();
    const auto ms = duration_cast<milliseconds>(since).count() % 1000;
    nlohmann::ordered_json line;
    line["time"] = fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                               fmt::gmtime(system_clock::to_time_t(message.time)), ms);
    line["level"] = view_of(spdlog::level::to_string_view(message.level));
    line["program"] = view_of(message.logger_name);
    line["message"] = view_of(message.payload);
    const std::string text = json_text(line, -1) + "\n";
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::formatter> clone() const override {
    return std::make_unique<JsonLines>();
  }
};

}  // namespace

std::unique_ptr<spdlog::formatter> json_lines() { return std::make_unique<JsonLines>(); }

}  // namespace mortise
