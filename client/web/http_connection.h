#pragma once
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/serializer.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/vector_body.hpp>
#include <list>
#include <memory>
#include <optional>
#include <string>

#include "client/web/answers.h"
#include "client/web/stream.h"

namespace mortise::web {

/// One HTTP connection: request, answer, and so on; closed when the client is too slow for either.
/// An upgrade makes it a Browser.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(GatewayState& state, asio::ip::tcp::socket socket);
  ~HttpConnection();

  void start();
  void give_way();  ///< closes it in favour of a newer one

 private:
  using Response = beast::http::response<beast::http::span_body<const char>>;
  void read(double patience_s);
  void take();
  void begin_file();
  void read_file();
  void end_file();
  void make(Download download);
  void write(const Answer& answer);
  void failed(beast::error_code error);
  void wait_in_line();
  void leave_line();
  void note(Incident incident, const std::string& what);

  GatewayState& state_;
  Stream stream_;
  const std::string peer_;
  beast::flat_buffer buffer_;
  std::optional<beast::http::request_parser<beast::http::empty_body>> parser_;
  /// A file that comes, and its ticket.
  std::optional<beast::http::request_parser<beast::http::vector_body<std::byte>>> file_;
  std::string ticket_;
  SharedBytes body_;
  std::optional<Response> response_;
  std::optional<beast::http::response_serializer<beast::http::span_body<const char>>> serializer_;
  std::optional<std::list<HttpConnection*>::iterator> place_;
};

}  // namespace mortise::web
