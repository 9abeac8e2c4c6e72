#pragma once
#include <boost/asio/ssl/context.hpp>
#include <chrono>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <set>

#include "client/web/gateway.h"
#include "client/web/report_maker.h"

namespace mortise::web {

class Browser;
class HttpConnection;

/// Totals of what was served.
struct Traffic {
  std::uint64_t connections = 0, requests = 0, browsers = 0, messages_in = 0, texts_out = 0,
                frames_out = 0, bytes_out = 0, frames_folded = 0, closed = 0;
};

/// State that the connections of one gateway share. Used by its thread only; outlives them.
struct GatewayState {
  GatewayState(const GatewayOptions& o, const Tokens& t, PageFiles p, Feed& f, Incidents::Say say)
      : options(o), tokens(t), page(std::move(p)), feed(f), incidents(std::move(say)) {}

  double now_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  GatewayOptions options;
  Tokens tokens;
  PageFiles page;
  Feed& feed;
  Incidents incidents;
  std::optional<boost::asio::ssl::context> tls;
  std::set<std::shared_ptr<Browser>> browsers;
  std::list<HttpConnection*> waiting;  ///< for a request, the longest first
  std::size_t connections = 0;
  Traffic traffic;
  ReportMaker reports;
  bool ending = false;
};

}  // namespace mortise::web
