#include "client/web/admission.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>

namespace mortise::web {
namespace {

bool same_letters(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

// "name", "1.2.3.4", "[::1]", each with ":port" or without; empty when it is nothing such.
std::string_view without_port(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  if (host.ends_with(']') || colon == std::string_view::npos) return host;
  return is_port(host.substr(colon + 1)) ? host.substr(0, colon) : std::string_view();
}

bool is_address(std::string_view host) {
  unsigned char bytes[sizeof(in6_addr)];
  if (host.starts_with('[') && host.ends_with(']'))
    return inet_pton(AF_INET6, std::string(host.substr(1, host.size() - 2)).c_str(), bytes) == 1;
  return inet_pton(AF_INET, std::string(host).c_str(), bytes) == 1;
}

}  // namespace

bool is_own_host(std::string_view host, const std::vector<std::string>& names) {
  const std::string_view name = without_port(host);
  return is_address(name) || same_letters(name, "localhost") ||
         (!name.empty() && std::any_of(names.begin(), names.end(), [&](const std::string& own) {
           return same_letters(name, own);
         }));
}

bool is_own_origin(std::string_view origin, std::string_view host, bool tls,
                   const std::vector<std::string>& origins) {
  const std::string own = (tls ? "https://" : "http://") + std::string(host);
  return same_letters(origin, own) ||
         std::find(origins.begin(), origins.end(), origin) != origins.end();
}

std::string_view bearer_token(std::string_view authorization) {
  constexpr std::string_view kScheme = "Bearer ";
  if (!same_letters(authorization.substr(0, kScheme.size()), kScheme)) return {};
  return authorization.substr(kScheme.size());
}

std::optional<std::string_view> subprotocol_token(std::string_view protocols) {
  constexpr std::string_view kToken = "token.";
  bool speaks_ours = false;
  std::string_view token;
  while (!protocols.empty()) {
    std::string_view one = protocols.substr(0, protocols.find(','));
    protocols.remove_prefix(std::min(one.size() + 1, protocols.size()));
    while (one.starts_with(' ')) one.remove_prefix(1);
    while (one.ends_with(' ')) one.remove_suffix(1);
    if (one == kSubprotocol) speaks_ours = true;
    if (one.starts_with(kToken)) token = one.substr(kToken.size());
  }
  if (!speaks_ours) return std::nullopt;
  return token;
}

}  // namespace mortise::web
