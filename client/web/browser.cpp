#include "client/web/browser.h"

#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/websocket/error.hpp>
#include <chrono>
#include <utility>

#include "client/web/admission.h"
#include "common/messages/names.h"

namespace mortise::web {
namespace {

namespace http = beast::http;
namespace websocket = beast::websocket;

constexpr double kGoodbye_s = 2.0;             // for the last words and the closing handshake
constexpr std::size_t kMostReasonBytes = 120;  // of a close frame
// What the kernel takes off us is as stale as what lies here, but cannot be folded.
constexpr int kKernelBuffer_bytes = 128 * 1024;

std::chrono::milliseconds in_ms(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1e3));
}

}  // namespace

Browser::Browser(GatewayState& state, Stream stream, Bearer bearer)
    : state_(state),
      socket_(std::move(stream)),
      bearer_(std::move(bearer)),
      peer_(socket_.next_layer().peer()),
      messages_(state.options.limits.messages_per_s, 2.0 * state.options.limits.messages_per_s),
      bad_(static_cast<double>(state.options.limits.bad_messages) / 10.0,
           static_cast<double>(state.options.limits.bad_messages)) {}

void Browser::start(Request request) {
  request_ = std::move(request);
  state_.browsers.insert(shared_from_this());
  const Limits& limits = state_.options.limits;
  beast::tcp_stream& tcp = socket_.next_layer().next_layer();
  tcp.expires_never();  // the WebSocket has time limits of its own
  beast::error_code ignored;
  tcp.socket().set_option(asio::socket_base::send_buffer_size(kKernelBuffer_bytes), ignored);
  websocket::stream_base::timeout times{};
  times.handshake_timeout = in_ms(limits.request_s);
  times.idle_timeout = in_ms(limits.silent_s);
  times.keep_alive_pings = true;
  socket_.set_option(times);
  socket_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
    response.set(http::field::sec_websocket_protocol, std::string(kSubprotocol));
  }));
  socket_.read_message_max(limits.message_bytes);
  socket_.auto_fragment(false);
  socket_.async_accept(request_, [self = shared_from_this()](beast::error_code error) {
    if (error) return self->failed(error);
    ++self->state_.traffic.browsers;
    self->entered_ = true;
    const Limits& l = self->state_.options.limits;
    self->say(text_of({{"type", "welcome"},
                       {"protocol", 1},
                       {"mode", self->state_.feed.mode()},
                       {"role", name_of(self->bearer_.role)},
                       {"name", self->bearer_.name},
                       {"report", static_cast<bool>(self->state_.options.report)},
                       {"log", static_cast<bool>(self->state_.options.log)},
                       {"limits",
                        {{"message_bytes", l.message_bytes},
                         {"messages_per_s", l.messages_per_s},
                         {"views_per_s", l.views_per_s}}}}));
    self->state_.feed.enter(*self);
    self->read();
  });
}

void Browser::say(SharedBytes text) {
  if (!close_reason_.empty() || gone_) return;
  outbox_.say(std::move(text));
  if (outbox_.unsent_bytes() > state_.options.limits.unsent_bytes) {
    note(Incident::kStalled, "takes events too slowly: " + std::to_string(outbox_.unsent_bytes()) +
                                 " bytes wait; closed");
    return end(CloseCode::try_again_later, "you take events too slowly");
  }
  write_next();
}

void Browser::say_views(SharedBytes text) {
  if (!close_reason_.empty() || gone_) return;
  outbox_.say_views(std::move(text));
  write_next();
}

void Browser::changed(const std::vector<PartId>& parts, SharedBytes frame) {
  if (!close_reason_.empty() || gone_) return;
  const std::uint64_t folded = outbox_.folded();
  outbox_.changed(parts, std::move(frame));
  state_.traffic.frames_folded += outbox_.folded() - folded;
  write_next();
}

void Browser::show_scene(SharedBytes scene) {
  outbox_.forget_changes();
  say(std::move(scene));
}

void Browser::end(CloseCode code, const std::string& reason) {
  if (!close_reason_.empty() || gone_) return;
  close_code_ = code;
  close_reason_ = reason;
  goodbye_ = code != CloseCode::try_again_later;
  close_by_s_ = state_.now_s() + kGoodbye_s;
  outbox_ = Outbox();  // no use to who is closed
  outbox_.say(text_of({{"type", "error"}, {"text", reason}, {"closing", true}}));
  write_next();
}

void Browser::check(double now_s) {
  if (close_by_s_ > 0.0 && now_s > close_by_s_) return drop();
  const double stalled_s = state_.options.limits.stalled_s;
  if (!writing_.bytes || now_s - writing_since_s_ < stalled_s) return;
  note(Incident::kStalled,
       "took nothing for " + std::to_string(static_cast<int>(stalled_s)) + " s; closed");
  // The kernel must not go on offering what nobody takes.
  beast::error_code ignored;
  socket_.next_layer().next_layer().socket().set_option(asio::socket_base::linger(true, 0),
                                                        ignored);
  drop();
}

void Browser::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    if (error) return self->failed(error);
    if (self->gone_) return;
    const std::string text = beast::buffers_to_string(self->buffer_.data());
    self->buffer_.consume(self->buffer_.size());
    self->take(text);
    self->read();
  });
}

void Browser::take(const std::string& text) {
  ++state_.traffic.messages_in;
  if (!close_reason_.empty()) return;
  if (!messages_.take(state_.now_s())) {
    const std::string limit =
        std::to_string(static_cast<int>(state_.options.limits.messages_per_s));
    note(Incident::kFlood, "more than " + limit + " messages a second; closed");
    return end(CloseCode::policy_error, "more than " + limit + " messages a second");
  }
  if (!socket_.got_text()) return refuse("a binary frame: pages send text only");
  const auto message = read_page_message(text);
  if (!message) return refuse(message.error().text);
  if (Status taken = state_.feed.take(*this, *message); !taken)
    say(text_of({{"type", "error"}, {"text", taken.error().text}}));
}

void Browser::refuse(const std::string& what) {
  note(Incident::kMalformed, what);
  if (bad_.take(state_.now_s())) return say(text_of({{"type", "error"}, {"text", what}}));
  end(CloseCode::policy_error, "too many messages that were not understood; the last: " + what);
}

void Browser::write_next() {
  if (writing_.bytes || closing_ || gone_ || !entered_) return;
  auto message = outbox_.next(
      [this](const std::vector<PartId>& parts) { return state_.feed.frame(*this, parts); });
  if (message) return write(std::move(*message));
  if (!close_reason_.empty()) close();
}

void Browser::write(Outbox::Message message) {
  writing_ = std::move(message);
  writing_since_s_ = state_.now_s();
  socket_.binary(writing_.binary);
  ++(writing_.binary ? state_.traffic.frames_out : state_.traffic.texts_out);
  state_.traffic.bytes_out += writing_.bytes->size();
  socket_.async_write(asio::buffer(*writing_.bytes),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        self->writing_.bytes.reset();
                        // Somebody else ends the connection, and is not done with it.
                        if (error == asio::error::operation_aborted) return;
                        if (error) return self->failed(error);
                        self->write_next();
                      });
}

void Browser::close() {
  closing_ = true;
  socket_.async_close({close_code_, close_reason_.substr(0, kMostReasonBytes)},
                      [self = shared_from_this()](beast::error_code) { self->drop(); });
}

void Browser::failed(beast::error_code error) {
  if (gone_) return;
  if (error == websocket::error::closed) {
    const auto code = socket_.reason().code;  // what a browser says when its page is left
    goodbye_ = goodbye_ || code == CloseCode::normal || code == CloseCode::going_away;
  } else if (error == beast::error::timeout) {
    note(Incident::kSilent, entered_ ? "no answer to a ping; closed" : "no handshake in time");
  } else if (error == websocket::error::message_too_big) {
    note(
        Incident::kOversized,
        "a message over " + std::to_string(state_.options.limits.message_bytes) + " bytes; closed");
  } else if (error == websocket::condition::protocol_violation ||
             error == websocket::condition::handshake_failed) {
    note(Incident::kMalformed, "not a valid WebSocket: " + error.message() + "; closed");
  }
  drop();
}

void Browser::drop() {
  if (gone_) return;
  gone_ = true;
  ++state_.traffic.closed;
  if (entered_) {
    if (goodbye_)
      state_.feed.leave(*this);
    else
      state_.feed.lose(*this);
  }
  socket_.next_layer().next_layer().close();
  state_.browsers.erase(shared_from_this());
}

void Browser::note(Incident incident, const std::string& what) {
  state_.incidents.note(incident, peer_, what, state_.now_s());
}

}  // namespace mortise::web
