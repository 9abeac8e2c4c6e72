#pragma once
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/compose.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace mortise::web {

namespace asio = boost::asio;
namespace beast = boost::beast;

/// A TCP connection with or without TLS, which is settled when it is made: what is written on it is
/// written and compiled once. An AsyncReadStream and AsyncWriteStream of Boost.Asio.
class Stream {
 public:
  using executor_type = beast::tcp_stream::executor_type;
  using next_layer_type = beast::tcp_stream;

  /// Without a context: no TLS.
  Stream(asio::ip::tcp::socket socket, asio::ssl::context* tls)
      : tcp_(std::make_unique<beast::tcp_stream>(std::move(socket))) {
    if (tls != nullptr) tls_ = std::make_unique<Tls>(*tcp_, *tls);
  }

  executor_type get_executor() noexcept { return tcp_->get_executor(); }
  next_layer_type& next_layer() noexcept { return *tcp_; }
  const next_layer_type& next_layer() const noexcept { return *tcp_; }
  bool has_tls() const { return tls_ != nullptr; }

  template <class Handler>
  void async_handshake(Handler&& handler,
                       asio::ssl::stream_base::handshake_type as = asio::ssl::stream_base::server) {
    tls_->async_handshake(as, std::forward<Handler>(handler));
  }
  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    if (tls_)
      tls_->async_read_some(buffers, std::forward<Handler>(handler));
    else
      tcp_->async_read_some(buffers, std::forward<Handler>(handler));
  }
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    if (tls_)
      tls_->async_write_some(buffers, std::forward<Handler>(handler));
    else
      tcp_->async_write_some(buffers, std::forward<Handler>(handler));
  }

  /// For messages: the other end's address and port.
  std::string peer() const {
    boost::system::error_code error;
    const auto end = tcp_->socket().remote_endpoint(error);
    return error ? "a closed connection"
                 : end.address().to_string() + ":" + std::to_string(end.port());
  }

 private:
  using Tls = asio::ssl::stream<beast::tcp_stream&>;
  // Behind pointers: the stream is moved while the TLS layer refers to the one below.
  std::unique_ptr<beast::tcp_stream> tcp_;
  std::unique_ptr<Tls> tls_;
};

/// Takes what still comes until the other end has closed too, and throws it away: to close a socket
/// with bytes unread resets the connection, and the other end may lose the words that were said
/// last. (What Beast 1.74 has for it stops at the first bytes that it reads.)
class Drain {
 public:
  explicit Drain(beast::tcp_stream& tcp) : tcp_(tcp), rest_(std::make_unique<Rest>()) {}

  template <class Self>
  void operator()(Self& self, beast::error_code error = {}, std::size_t = 0) {
    if (!begun_) {
      begun_ = true;
      beast::error_code ignored;
      tcp_.socket().shutdown(asio::socket_base::shutdown_send, ignored);
      tcp_.expires_after(kPatience);
    } else if (error) {
      tcp_.close();
      return self.complete(error == asio::error::eof ? beast::error_code() : error);
    }
    tcp_.async_read_some(asio::buffer(*rest_), std::move(self));
  }

 private:
  static constexpr std::chrono::seconds kPatience{2};
  using Rest = std::array<char, 4096>;
  beast::tcp_stream& tcp_;
  std::unique_ptr<Rest> rest_;  // the operation is moved while it is read into
  bool begun_ = false;
};

/// A WebSocket has said goodbye in its own words by then: TLS need not do it again.
template <class Handler>
void async_teardown(beast::role_type, Stream& stream, Handler&& handler) {
  asio::async_compose<Handler, void(beast::error_code)>(Drain(stream.next_layer()), handler,
                                                        stream);
}

}  // namespace mortise::web
