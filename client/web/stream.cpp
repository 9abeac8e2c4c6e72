#include "client/web/stream.h"

#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>

namespace mortise::web {

struct Stream::Tls : asio::ssl::stream<beast::tcp_stream&> {
  using asio::ssl::stream<beast::tcp_stream&>::stream;
};

Stream::Stream(asio::ip::tcp::socket socket, asio::ssl::context* tls)
    : tcp_(std::make_unique<beast::tcp_stream>(std::move(socket))) {
  if (tls != nullptr) tls_ = std::make_unique<Tls>(*tcp_, *tls);
}
Stream::Stream(Stream&&) noexcept = default;
Stream& Stream::operator=(Stream&&) noexcept = default;
Stream::~Stream() = default;

void Stream::shake_hands(WhenDone done, asio::ssl::stream_base::handshake_type as) {
  tls_->async_handshake(as, std::move(done));
}

void Stream::read_some(const FewBuffers<asio::mutable_buffer>& buffers, WhenDone done) {
  if (tls_)
    tls_->async_read_some(buffers, std::move(done));
  else
    tcp_->async_read_some(buffers, std::move(done));
}

void Stream::write_some(const FewBuffers<asio::const_buffer>& buffers, WhenDone done) {
  if (tls_)
    tls_->async_write_some(buffers, std::move(done));
  else
    tcp_->async_write_some(buffers, std::move(done));
}

std::string Stream::peer() const {
  boost::system::error_code error;
  const auto end = tcp_->socket().remote_endpoint(error);
  return error ? "a closed connection"
               : end.address().to_string() + ":" + std::to_string(end.port());
}

}  // namespace mortise::web
