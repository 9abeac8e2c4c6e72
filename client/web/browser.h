#pragma once
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "client/web/feed.h"
#include "client/web/gateway_state.h"
#include "client/web/limits.h"
#include "client/web/stream.h"

namespace mortise::web {

/// One page: a WebSocket with a valid token. It lives until its connection ends, and the feed is
/// told at once.
class Browser final : public Viewer, public std::enable_shared_from_this<Browser> {
 public:
  using Request = beast::http::request<beast::http::empty_body>;
  using CloseCode = beast::websocket::close_code;

  Browser(GatewayState& state, Stream stream, Bearer bearer);
  void start(Request request);

  Role role() const override { return bearer_.role; }
  const std::string& bound_name() const override { return bearer_.name; }
  void say(SharedBytes text) override;
  void say_views(SharedBytes text) override;
  void changed(const std::vector<PartId>& parts, SharedBytes frame) override;
  void show_scene(SharedBytes scene) override;
  std::uint64_t folded_frames() const override { return outbox_.folded(); }

  /// Closes with this reason after the present write, or after a short time at the latest.
  void end(CloseCode code, const std::string& reason);
  /// Closes the connection when it has been stalled or silent for too long. Called regularly.
  void check(double now_s);

 private:
  void read();
  void take(const std::string& text);
  void refuse(const std::string& what);
  void write_next();
  void write(Outbox::Message message);
  void close();
  void failed(beast::error_code error);
  void drop();
  void note(Incident incident, const std::string& what);

  GatewayState& state_;
  beast::websocket::stream<Stream> socket_;
  const Bearer bearer_;
  const std::string peer_;
  Request request_;
  beast::flat_buffer buffer_;
  Outbox outbox_;
  Outbox::Message writing_;  ///< bytes: being written now
  Rate messages_, bad_;
  double writing_since_s_ = 0.0, close_by_s_ = 0.0;
  CloseCode close_code_ = CloseCode::none;
  std::string close_reason_;  ///< not empty: to be closed
  bool entered_ = false, closing_ = false, gone_ = false;
  bool goodbye_ = false;  ///< one of the two has ended it for good
};

}  // namespace mortise::web
