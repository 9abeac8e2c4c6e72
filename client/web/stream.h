#pragma once
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/compose.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ssl/stream_base.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

namespace boost::asio::ssl {
class context;
}

namespace mortise::web {

namespace asio = boost::asio;
namespace beast = boost::beast;

/// What is called once an operation has ended. Behind it any handler that Boost.Asio takes; the
/// operations below are compiled for this one alone, not for each that waits for them.
class WhenDone {
 public:
  template <class Handler>
  static WhenDone of(Handler&& handler) {
    WhenDone done;
    done.held_ = std::make_unique<Held<std::decay_t<Handler>>>(std::forward<Handler>(handler));
    return done;
  }
  void operator()(beast::error_code error, std::size_t bytes = 0) {
    // It may begin the next operation on the same stream.
    const std::unique_ptr<Any> held = std::move(held_);
    held->call(error, bytes);
  }

 private:
  struct Any {
    virtual ~Any() = default;
    virtual void call(beast::error_code error, std::size_t bytes) = 0;
  };
  template <class Handler>
  struct Held final : Any {
    explicit Held(Handler of) : handler(std::move(of)) {}
    void call(beast::error_code error, std::size_t bytes) override {
      if constexpr (std::is_invocable_v<Handler&, beast::error_code, std::size_t>)
        handler(error, bytes);
      else
        handler(error);
    }
    Handler handler;
  };
  std::unique_ptr<Any> held_;
};

/// The first few buffers of a sequence that are not empty: what an operation that moves *some*
/// bytes may be content with. A buffer sequence of Boost.Asio itself, of one type for all.
template <class Buffer>
class FewBuffers {
 public:
  template <class Buffers>
  explicit FewBuffers(const Buffers& all) {
    const auto end = asio::buffer_sequence_end(all);
    for (auto at = asio::buffer_sequence_begin(all); at != end && count_ < few_.size(); ++at)
      if (const Buffer buffer(*at); buffer.size() > 0) few_[count_++] = buffer;
  }
  const Buffer* begin() const { return few_.data(); }
  const Buffer* end() const { return few_.data() + count_; }

 private:
  std::array<Buffer, 16> few_;
  std::size_t count_ = 0;
};

/// A TCP connection with or without TLS, which is settled when it is made: what is written on it is
/// written and compiled once. An AsyncReadStream and AsyncWriteStream of Boost.Asio.
class Stream {
 public:
  using executor_type = beast::tcp_stream::executor_type;
  using next_layer_type = beast::tcp_stream;

  /// Without a context: no TLS.
  Stream(asio::ip::tcp::socket socket, asio::ssl::context* tls);
  Stream(Stream&&) noexcept;
  Stream& operator=(Stream&&) noexcept;
  ~Stream();

  executor_type get_executor() noexcept { return tcp_->get_executor(); }
  next_layer_type& next_layer() noexcept { return *tcp_; }
  const next_layer_type& next_layer() const noexcept { return *tcp_; }
  bool has_tls() const { return tls_ != nullptr; }

  template <class Handler>
  void async_handshake(Handler&& handler,
                       asio::ssl::stream_base::handshake_type as = asio::ssl::stream_base::server) {
    shake_hands(WhenDone::of(std::forward<Handler>(handler)), as);
  }
  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    read_some(FewBuffers<asio::mutable_buffer>(buffers),
              WhenDone::of(std::forward<Handler>(handler)));
  }
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    write_some(FewBuffers<asio::const_buffer>(buffers),
               WhenDone::of(std::forward<Handler>(handler)));
  }

  /// For messages: the other end's address and port.
  std::string peer() const;

 private:
  struct Tls;
  void shake_hands(WhenDone done, asio::ssl::stream_base::handshake_type as);
  void read_some(const FewBuffers<asio::mutable_buffer>& buffers, WhenDone done);
  void write_some(const FewBuffers<asio::const_buffer>& buffers, WhenDone done);
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
