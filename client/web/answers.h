#pragma once
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/status.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "client/web/gateway_state.h"

namespace mortise::web {

using Request = boost::beast::http::request<boost::beast::http::empty_body>;

/// The answer to a request, before it is written.
struct Answer {
  boost::beast::http::status status = boost::beast::http::status::ok;
  std::string type = "text/plain; charset=utf-8";
  SharedBytes body;
  std::vector<std::pair<std::string, std::string>> fields = {};
};

/// One sentence as an answer.
Answer sentence(boost::beast::http::status status, const std::string& text);

/// Everything but WebSockets. `from` names the asker in messages.
Answer answer_to(GatewayState& state, const Request& request, bool tls, const std::string& from);

/// A mesh file of a page, which begins to come: POST to /upload/TICKET.
bool brings_file(const Request& request);
/// Its ticket, which is then used up, or the answer that refuses it.
std::variant<std::string, Answer> admit_file(GatewayState& state, const Request& request,
                                             std::optional<std::uint64_t> length, bool tls,
                                             const std::string& from);
Answer answer_to_file(GatewayState& state, const std::string& ticket, std::vector<std::byte> bytes);

/// The report takes seconds, so another thread makes it (report_maker.h). refusal_of() gives
/// the answer when there is none now.
/// The same holds for the session's log, for the scenario that it is saved as, and for the picture
/// of a clash or the gap of two parts.
enum class Download : std::uint8_t { kNone = 0, kReport, kLog, kScenario, kPicture, kGap };
Download download_of(const Request& request);
/// Empty: there is no log to make it of.
ReportMaker::Make maker_of(Download download, const Request& request,
                           const GatewayOptions& options);
std::optional<Answer> refusal_of(Download download, GatewayState& state, const Request& request,
                                 const std::string& from);
Answer answer_with(Download download, Result<std::string> bytes);

/// The bearer as whom this request may become a WebSocket, or the answer that refuses it.
std::variant<Bearer, Answer> admit_browser(GatewayState& state, const Request& request, bool tls,
                                           const std::string& from);

}  // namespace mortise::web
