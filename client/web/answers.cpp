#include "client/web/answers.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "client/web/admission.h"
#include "common/messages/names.h"

namespace mortise::web {
namespace {

namespace http = boost::beast::http;
using http::status;

constexpr char kJson[] = "application/json";
constexpr std::string_view kUploads = "/upload/";
constexpr std::string_view kMeshes = "/mesh/", kMeshEnding = ".bin";

std::string_view view_of(boost::beast::string_view text) { return {text.data(), text.size()}; }

// Rows of /proc/self/statm are pages.
std::uint64_t resident_bytes() {
  std::uint64_t size = 0, resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%lu %lu", &size, &resident) != 2) resident = 0;
    std::fclose(file);
  }
  return resident * 4096;
}

// All of the text as a number, or none.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.begin(), text.end(), number);
  if (error != std::errc{} || end != text.end()) return std::nullopt;
  return number;
}

// "/clash/4.svg", "/clash/4.svg?tick=812"
std::optional<WantedPicture> picture_of(std::string_view target) {
  constexpr std::string_view kClashes = "/clash/", kEnding = ".svg", kTick = "?tick=";
  if (!target.starts_with(kClashes)) return std::nullopt;
  target.remove_prefix(kClashes.size());
  WantedPicture wanted;
  if (const auto at = target.find(kTick); at != std::string_view::npos) {
    wanted.until_tick = number_of<std::uint64_t>(target.substr(at + kTick.size()));
    if (!wanted.until_tick) return std::nullopt;
    target = target.substr(0, at);
  }
  if (!target.ends_with(kEnding)) return std::nullopt;
  target.remove_suffix(kEnding.size());
  const auto clash = number_of<std::uint32_t>(target);
  if (!clash) return std::nullopt;
  wanted.clash = *clash;
  return wanted;
}

constexpr std::string_view kGap = "/gap?";

// "/gap?a=3&b=5", "/gap?a=3&b=5&tick=812"
std::optional<WantedGap> gap_of(std::string_view target) {
  target.remove_prefix(kGap.size());
  WantedGap wanted;
  const auto take = [&](std::string_view key) -> std::optional<std::string_view> {
    if (!target.starts_with(key)) return std::nullopt;
    const std::string_view value = target.substr(key.size(), target.find('&') - key.size());
    target.remove_prefix(std::min(target.size(), key.size() + value.size() + 1));
    return value;
  };
  const auto a = take("a="), b = take("b=");
  const auto tick = target.empty() ? std::nullopt : take("tick=");
  if (!a || !b || !target.empty()) return std::nullopt;
  if (tick && !(wanted.tick = number_of<std::uint64_t>(*tick))) return std::nullopt;
  wanted.a = number_of<std::uint32_t>(*a).value_or(0);
  wanted.b = number_of<std::uint32_t>(*b).value_or(0);
  return wanted.a != 0 && wanted.b != 0 && wanted.a != wanted.b ? std::optional(wanted)
                                                                : std::nullopt;
}

Answer mesh(GatewayState& state, std::string_view path) {
  const std::string hash(path.substr(0, path.size() - kMeshEnding.size()));
  const MeshAnswer found = state.feed.mesh(hash);
  if (found.state == MeshAnswer::State::kHere) {
    return {status::ok,
            "application/octet-stream",
            found.bytes,
            {{"Cache-Control", "private, max-age=31536000, immutable"}}};
  }
  if (found.state == MeshAnswer::State::kAwaited) {
    // No error: browsers would tell it as one in their console.
    Answer answer = sentence(status::accepted, "this mesh has not arrived yet");
    answer.fields.emplace_back("Retry-After", "1");
    return answer;
  }
  return sentence(status::not_found, "the session has no part with this mesh");
}

Answer statistics(const GatewayState& state) {
  const Traffic& t = state.traffic;
  Json json{{"browsers", state.browsers.size()},
            {"connections", state.connections},
            {"resident_bytes", resident_bytes()},
            {"in_all",
             {{"connections", t.connections},
              {"requests", t.requests},
              {"browsers", t.browsers},
              {"closed", t.closed},
              {"messages_in", t.messages_in},
              {"texts_out", t.texts_out},
              {"frames_out", t.frames_out},
              {"bytes_out", t.bytes_out},
              {"frames_folded", t.frames_folded}}},
            {"incidents", state.incidents.counts()},
            {"feed", state.feed.statistics()}};
  return {status::ok, kJson, text_of(json), {{"Cache-Control", "no-store"}}};
}

Answer health(const GatewayState& state) {
  const std::string trouble = state.feed.trouble();
  return trouble.empty() ? sentence(status::ok, "ok")
                         : sentence(status::service_unavailable, trouble);
}

Answer file(const GatewayState& state, const Request& request, bool tls) {
  const std::string_view target = view_of(request.target());
  const auto found = state.page.find(target);
  if (!found) {
    if (target.starts_with("/three/") && !state.page.has_three()) {
      return sentence(
          status::not_found,
          "three.js is not installed: run `npm ci --omit=dev` in the folder of the page");
    }
    return sentence(status::not_found, "no such file of the page");
  }
  Answer answer{status::ok,
                found->type,
                found->bytes,
                {{"Cache-Control", "no-cache"}, {"ETag", found->etag}}};
  if (found->is_page) {
    answer.fields.emplace_back(
        "Content-Security-Policy",
        content_security_policy(*found->bytes, view_of(request[http::field::host]), tls));
  }
  if (view_of(request[http::field::if_none_match]) == found->etag) {
    answer.status = status::not_modified;
    answer.body = nullptr;
  }
  return answer;
}

bool is_own(GatewayState& state, const Request& request, const std::string& from) {
  const std::string_view host = view_of(request[http::field::host]);
  if (is_own_host(host, state.options.names)) return true;
  state.incidents.note(Incident::kWrongHost, from, "requested under a foreign host name",
                       state.now_s());
  return false;
}

// What to say to who has no good token.
std::optional<Answer> without_token(GatewayState& state, const Request& request,
                                    const std::string& from) {
  if (bearer_of(state.tokens, bearer_token(view_of(request[http::field::authorization]))))
    return std::nullopt;
  state.incidents.note(Incident::kWrongToken, from, "a request without a valid token",
                       state.now_s());
  Answer answer = sentence(status::unauthorized, "the token is missing or wrong");
  answer.fields.emplace_back("WWW-Authenticate", "Bearer");
  return answer;
}

// How an answer begins that tells why there is none; empty: of files.
const char* no_answer(Download download) {
  if (download == Download::kPicture) return "no picture: ";
  return download == Download::kGap ? "no gap: " : "";
}

Answer wrong_host() {
  return sentence(status::misdirected_request,
                  "requested under a foreign host name; --name allows it");
}

}  // namespace

Answer sentence(status code, const std::string& text) {
  return {code, "text/plain; charset=utf-8", std::make_shared<const std::string>(text + "\n"), {}};
}

Answer answer_to(GatewayState& state, const Request& request, bool tls, const std::string& from) {
  ++state.traffic.requests;
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    state.incidents.note(Incident::kBadRequest, from,
                         "a method other than GET, HEAD and POST of a file", state.now_s());
    Answer answer = sentence(status::method_not_allowed, "only GET and HEAD");
    answer.fields.emplace_back("Allow", "GET, HEAD");
    return answer;
  }
  if (!is_own(state, request, from)) return wrong_host();
  const std::string_view target = view_of(request.target());
  if (target == "/healthz") return health(state);
  if (target == "/ws") return sentence(status::upgrade_required, "this is a WebSocket");
  const bool is_mesh = target.starts_with(kMeshes) && target.ends_with(kMeshEnding) &&
                       target.size() > kMeshes.size() + kMeshEnding.size();
  if (!is_mesh && target != "/statistics") return file(state, request, tls);
  if (auto refused = without_token(state, request, from)) return *refused;
  return is_mesh ? mesh(state, target.substr(kMeshes.size())) : statistics(state);
}

bool brings_file(const Request& request) {
  return request.method() == http::verb::post && view_of(request.target()).starts_with(kUploads);
}

std::variant<std::string, Answer> admit_file(GatewayState& state, const Request& request,
                                             std::optional<std::uint64_t> length, bool tls,
                                             const std::string& from) {
  ++state.traffic.requests;
  if (!is_own(state, request, from)) return wrong_host();
  const std::string_view origin = view_of(request[http::field::origin]);
  if (!is_own_origin(origin, view_of(request[http::field::host]), tls, state.options.origins)) {
    state.incidents.note(Incident::kWrongOrigin, from, "a file of a foreign page", state.now_s());
    return sentence(status::forbidden, "a file of a foreign page; --origin allows it");
  }
  if (auto refused = without_token(state, request, from)) return *refused;
  if (!length) return sentence(status::length_required, "how many bytes will come?");
  const std::string ticket(view_of(request.target()).substr(kUploads.size()));
  const std::optional<std::size_t> announced = state.feed.begin_file(ticket);
  if (!announced) return sentence(status::not_found, "nobody waits for this file");
  if (*announced == *length) return ticket;
  state.feed.drop_file(ticket);
  return sentence(status::bad_request, "the file has another length than was announced");
}

Answer answer_to_file(GatewayState& state, const std::string& ticket,
                      std::vector<std::byte> bytes) {
  const Status taken = state.feed.take_file(ticket, std::move(bytes));
  return taken ? Answer{status::no_content, "text/plain; charset=utf-8", nullptr, {}}
               : sentence(status::gone, taken.error().text);
}

Download download_of(const Request& request) {
  if (request.method() != http::verb::get) return Download::kNone;
  if (request.target() == "/report.html") return Download::kReport;
  if (request.target() == "/scenario.zip") return Download::kScenario;
  if (picture_of(view_of(request.target()))) return Download::kPicture;
  if (view_of(request.target()).starts_with(kGap)) return Download::kGap;
  return request.target() == "/session.mcap" ? Download::kLog : Download::kNone;
}

ReportMaker::Make maker_of(Download download, const Request& request,
                           const GatewayOptions& options) {
  if (download == Download::kPicture) {
    if (!options.picture) return {};
    return [make = options.picture, wanted = *picture_of(view_of(request.target()))] {
      return make(wanted);
    };
  }
  if (download == Download::kGap) {
    const auto wanted = gap_of(view_of(request.target()));
    if (!options.gap || !wanted) return {};
    return [make = options.gap, wanted = *wanted] { return make(wanted); };
  }
  if (download == Download::kScenario) return options.scenario;
  return download == Download::kLog ? options.log : options.report;
}

std::optional<Answer> refusal_of(Download download, GatewayState& state, const Request& request,
                                 const std::string& from) {
  ++state.traffic.requests;
  if (!is_own(state, request, from)) return wrong_host();
  if (auto refused = without_token(state, request, from)) return refused;
  if (download == Download::kGap && !gap_of(view_of(request.target())))
    return sentence(status::bad_request, "no gap: /gap?a=PART&b=PART wants two parts");
  if (!maker_of(download, request, state.options))
    return sentence(status::not_found,
                    std::string(no_answer(download)) +
                        "this gateway knows no log; start it with --read-log FILE");
  if (!state.reports.is_busy() && !state.ending) return std::nullopt;
  Answer answer =
      sentence(status::service_unavailable, "another download is being made; ask again");
  answer.fields.emplace_back("Retry-After", "2");
  return answer;
}

Answer answer_with(Download download, Result<std::string> bytes) {
  if (!bytes && bytes.error().code == Code::kNotFound && *no_answer(download) != '\0')
    return sentence(status::not_found, no_answer(download) + bytes.error().text);
  if (!bytes) return sentence(status::internal_server_error, "not made: " + bytes.error().text);
  auto body = std::make_shared<const std::string>(std::move(*bytes));
  if (download == Download::kGap)
    return {status::ok, kJson, std::move(body), {{"Cache-Control", "no-store"}}};
  if (download == Download::kPicture)
    return {status::ok,
            "image/svg+xml",
            std::move(body),
            {{"Cache-Control", "no-store"},
             {"Content-Security-Policy", "default-src 'none'; sandbox"}}};
  if (download != Download::kReport) {
    const bool is_log = download == Download::kLog;
    const std::string name = is_log ? "session.mcap" : "scenario.zip";
    return {status::ok,
            is_log ? "application/octet-stream" : "application/zip",
            std::move(body),
            {{"Cache-Control", "no-store"},
             {"Content-Disposition", "attachment; filename=\"" + name + "\""}}};
  }
  return {status::ok,
          "text/html; charset=utf-8",
          std::move(body),
          {{"Cache-Control", "no-store"},
           {"Content-Disposition", "attachment; filename=\"report.html\""},
           // It is a page of its own, wherever somebody opens it.
           {"Content-Security-Policy", "sandbox allow-scripts"}}};
}

std::variant<Bearer, Answer> admit_browser(GatewayState& state, const Request& request, bool tls,
                                           const std::string& from) {
  ++state.traffic.requests;
  const auto refuse = [&](Incident incident, status code, const std::string& text) {
    state.incidents.note(incident, from, text, state.now_s());
    return sentence(code, text);
  };
  if (!is_own(state, request, from)) return wrong_host();
  if (request.target() != "/ws") return sentence(status::not_found, "the WebSocket is /ws");
  const std::string_view origin = view_of(request[http::field::origin]);
  if (!is_own_origin(origin, view_of(request[http::field::host]), tls, state.options.origins)) {
    return refuse(Incident::kWrongOrigin, status::forbidden,
                  "a WebSocket of a foreign page; --origin allows it");
  }
  const auto token = subprotocol_token(view_of(request[http::field::sec_websocket_protocol]));
  if (!token) {
    return refuse(Incident::kBadRequest, status::bad_request,
                  "a WebSocket that does not speak mortise.1");
  }
  const auto bearer = bearer_of(state.tokens, *token);
  if (!bearer) {
    return refuse(Incident::kWrongToken, status::unauthorized,
                  "a WebSocket whose token is missing or wrong");
  }
  if (state.ending || state.browsers.size() >= state.options.limits.browsers) {
    return refuse(Incident::kTooManyBrowsers, status::service_unavailable,
                  "there are " + std::to_string(state.browsers.size()) + " browsers already");
  }
  return *bearer;
}

}  // namespace mortise::web
