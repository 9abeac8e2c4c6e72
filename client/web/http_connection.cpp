#include "client/web/http_connection.h"

#include <boost/beast/core/buffers_range.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>

#include "client/web/browser.h"

namespace mortise::web {
namespace {

namespace http = beast::http;

// Of what it has sent, the end of the headers is missing.
bool came_partly(beast::error_code error) {
  return error == http::error::partial_message || error == beast::error::timeout;
}

std::chrono::milliseconds in_ms(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1e3));
}

}  // namespace

HttpConnection::HttpConnection(GatewayState& state, asio::ip::tcp::socket socket)
    : state_(state),
      stream_(std::move(socket), state.tls ? &*state.tls : nullptr),
      peer_(stream_.peer()) {
  ++state_.connections;
  ++state_.traffic.connections;
}

HttpConnection::~HttpConnection() {
  leave_line();
  --state_.connections;
}

void HttpConnection::wait_in_line() {
  leave_line();
  place_ = state_.waiting.insert(state_.waiting.end(), this);
}

void HttpConnection::leave_line() {
  if (place_) state_.waiting.erase(*place_);
  place_.reset();
}

void HttpConnection::give_way() {
  leave_line();
  stream_.next_layer().close();
}

void HttpConnection::note(Incident incident, const std::string& what) {
  state_.incidents.note(incident, peer_, what, state_.now_s());
}

void HttpConnection::start() {
  beast::error_code ignored;
  stream_.next_layer().socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  const double patience_s = state_.options.limits.request_s;
  if (!stream_.has_tls()) return read(patience_s);
  wait_in_line();
  stream_.next_layer().expires_after(in_ms(patience_s));
  stream_.async_handshake([self = shared_from_this(), patience_s](beast::error_code error) {
    if (!error) return self->read(patience_s);
    self->note(Incident::kTls, "no TLS handshake: " + error.message());
  });
}

void HttpConnection::read(double patience_s) {
  wait_in_line();
  parser_.emplace();
  parser_->header_limit(static_cast<std::uint32_t>(state_.options.limits.header_bytes));
  parser_->body_limit(state_.options.limits.upload_bytes);  // of files; nothing else has a body
  stream_.next_layer().expires_after(in_ms(patience_s));
  http::async_read_header(stream_, buffer_, *parser_,
                          [self = shared_from_this()](beast::error_code error, std::size_t) {
                            self->leave_line();
                            if (error) return self->failed(error);
                            if (brings_file(self->parser_->get())) return self->begin_file();
                            if (!self->parser_->is_done())
                              return self->failed(http::error::unexpected_body);
                            self->take();
                          });
}

void HttpConnection::begin_file() {
  const auto length = parser_->content_length();
  auto admitted = admit_file(state_, parser_->get(),
                             length ? std::optional<std::uint64_t>(*length) : std::nullopt,
                             stream_.has_tls(), peer_);
  if (const auto* refused = std::get_if<Answer>(&admitted)) return write(*refused);
  ticket_ = std::get<std::string>(admitted);
  file_.emplace(std::move(*parser_));
  file_->eager(true);
  parser_.emplace();  // its answer closes the connection
  read_file();
}

// Each piece must come in time; who has left is not waited for.
void HttpConnection::read_file() {
  stream_.next_layer().expires_after(in_ms(state_.options.limits.stalled_s));
  http::async_read_some(stream_, buffer_, *file_,
                        [self = shared_from_this()](beast::error_code error, std::size_t) {
                          if (!error && self->file_->is_done()) return self->end_file();
                          if (!error && self->state_.feed.awaits_file(self->ticket_))
                            return self->read_file();
                          self->state_.feed.drop_file(self->ticket_);
                          self->note(Incident::kSlowRequest, "a file that did not come whole");
                          self->stream_.next_layer().close();
                        });
}

void HttpConnection::end_file() {
  const Answer answer = answer_to_file(state_, ticket_, std::move(file_->get().body()));
  file_.reset();
  write(answer);
}

void HttpConnection::failed(beast::error_code error) {
  const bool has_begun = parser_->got_some() || buffer_.size() > 0;
  if (came_partly(error)) {
    if (has_begun) note(Incident::kSlowRequest, "a request that was not complete in time; closed");
    return;
  }
  const std::string category = error.category().name();
  if (category != "beast.http" || error == http::error::end_of_stream) return;
  note(Incident::kBadRequest, "not a valid request: " + error.message() + "; closed");
  parser_.emplace();  // what there is of it may not even have a version
  write(sentence(http::status::bad_request, "this request cannot be answered"));
}

void HttpConnection::take() {
  const Request& request = parser_->get();
  const std::size_t hosts = request.count(http::field::host);
  if (hosts > 1 || (hosts == 0 && request.version() >= 11)) {  // RFC 9112, section 3.2
    note(Incident::kBadRequest, "a request with no Host field, or with several");
    return write(sentence(http::status::bad_request, "one Host field is expected"));
  }
  if (const Download download = download_of(request); download != Download::kNone)
    return make(download);
  if (!beast::websocket::is_upgrade(request))
    return write(answer_to(state_, request, stream_.has_tls(), peer_));
  auto admitted = admit_browser(state_, request, stream_.has_tls(), peer_);
  if (const auto* refused = std::get_if<Answer>(&admitted)) return write(*refused);
  std::make_shared<Browser>(state_, std::move(stream_), std::get<Bearer>(admitted))
      ->start(parser_->release());
}

void HttpConnection::make(Download download) {
  if (auto refused = refusal_of(download, state_, parser_->get(), peer_)) return write(*refused);
  stream_.next_layer().expires_never();
  state_.reports.start(stream_.get_executor(), maker_of(download, parser_->get(), state_.options),
                       [self = shared_from_this(), download](Result<std::string> bytes) {
                         self->write(answer_with(download, std::move(bytes)));
                       });
}

void HttpConnection::write(const Answer& answer) {
  const Request& request = parser_->get();
  const bool whole = parser_->is_done();
  body_ = answer.body;
  response_.emplace(answer.status, request.version() == 0 ? 11 : request.version());
  response_->keep_alive(whole && request.keep_alive());
  response_->set(http::field::content_type, answer.type);
  response_->set("X-Content-Type-Options", "nosniff");
  response_->set("Referrer-Policy", "no-referrer");
  response_->set("Cross-Origin-Resource-Policy", "same-origin");
  for (const auto& [name, value] : answer.fields) response_->set(name, value);
  if (body_) response_->body() = {body_->data(), body_->size()};
  response_->prepare_payload();
  serializer_.emplace(*response_);
  stream_.next_layer().expires_after(in_ms(state_.options.limits.idle_s));
  const bool head_only = request.method() == http::verb::head;
  const auto then = [self = shared_from_this()](beast::error_code error, std::size_t) {
    if (!error && self->response_->keep_alive())
      return self->read(self->state_.options.limits.idle_s);
    self->stream_.next_layer().close();
  };
  if (head_only)
    http::async_write_header(stream_, *serializer_, then);
  else
    http::async_write(stream_, *serializer_, then);
}

}  // namespace mortise::web
