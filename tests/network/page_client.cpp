#include "tests/network/page_client.h"

#include <arpa/inet.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <deque>

#include "client/web/stream.h"

namespace mortise::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;

constexpr double kAnswer_s = 8.0;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

tcp::endpoint endpoint_of(int port) {
  return {asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port)};
}

std::string own_host(int port) { return "127.0.0.1:" + std::to_string(port); }

void run_for(asio::io_context& io, double seconds) {
  io.restart();
  io.poll();  // what is ready, also when there is no time at all
  io.run_for(std::chrono::microseconds(static_cast<std::int64_t>(seconds * 1e6)));
}

// A stream to the port, with the TLS handshake done; says whether it is.
bool connect(asio::io_context& io, web::Stream& stream) {
  if (!stream.has_tls()) return true;
  bool shaken = false;
  stream.async_handshake([&](beast::error_code error) { shaken = !error; },
                         asio::ssl::stream_base::client);
  run_for(io, kAnswer_s);
  return shaken;
}

asio::ssl::context* any_certificate() {
  static asio::ssl::context context(asio::ssl::context::tls_client);
  return &context;
}

}  // namespace

std::string HttpAnswer::field(const std::string& name) const {
  for (const auto& [key, value] : fields)
    if (beast::iequals(key, name)) return value;
  return {};
}

HttpAnswer http_request(int port, const std::string& target, const Fields& fields,
                        const std::string& method, bool tls) {
  asio::io_context io;
  tcp::socket socket(io);
  beast::error_code failed;
  socket.connect(endpoint_of(port), failed);
  if (failed) return {};
  web::Stream stream(std::move(socket), tls ? any_certificate() : nullptr);
  if (!connect(io, stream)) return {};
  http::request<http::empty_body> request;
  request.method_string(method);
  request.target(target);
  request.version(11);
  request.set(http::field::host, own_host(port));
  for (const auto& [name, value] : fields) request.set(name, value);
  http::async_write(stream, request, [](beast::error_code, std::size_t) {});
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.skip(method == "HEAD");
  parser.body_limit(std::uint64_t{1} << 30);
  bool read = false;
  http::async_read(stream, buffer, parser,
                   [&](beast::error_code error, std::size_t) { read = !error; });
  run_for(io, kAnswer_s);
  if (!read) return {};
  const auto& response = parser.get();
  HttpAnswer answer{static_cast<int>(response.result_int()), response.body(), {}};
  for (const auto& field : response)
    answer.fields.emplace_back(std::string(field.name_string()), std::string(field.value()));
  return answer;
}

RawConnection::RawConnection(int port) {
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(socket_);
    socket_ = -1;
  }
}
RawConnection::~RawConnection() {
  if (socket_ >= 0) ::close(socket_);
}
bool RawConnection::send(const std::string& bytes) {
  return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
         static_cast<ssize_t>(bytes.size());
}
std::string RawConnection::read(double limit_s, bool& closed) {
  const double end_s = now_s() + limit_s;
  std::string text;
  closed = socket_ < 0;
  while (!closed && now_s() < end_s) {
    pollfd wait{socket_, POLLIN, 0};
    if (::poll(&wait, 1, 20) <= 0) continue;
    char bytes[4096];
    const ssize_t count = ::recv(socket_, bytes, sizeof bytes, 0);
    if (count > 0) text.append(bytes, static_cast<std::size_t>(count));
    closed = count <= 0;
  }
  return text;
}

struct PageClient::Impl {
  asio::io_context io{1};
  std::unique_ptr<websocket::stream<web::Stream>> socket;
  beast::flat_buffer buffer;
  std::deque<std::pair<std::string, bool>> to_send;  ///< bytes; binary
  int status = 0, code = 0;
  std::string reason;
  bool open = false, writing = false;

  void read(PageClient& page) {
    socket->async_read(buffer, [this, &page](beast::error_code error, std::size_t) {
      if (error) {
        open = false;
        code = static_cast<int>(socket->reason().code);
        reason = std::string(socket->reason().reason.data(), socket->reason().reason.size());
        return;
      }
      const std::string bytes = beast::buffers_to_string(buffer.data());
      buffer.consume(buffer.size());
      page.take(bytes, socket->got_binary());
      read(page);
    });
  }
  void write() {
    if (writing || to_send.empty() || !open) return;
    writing = true;
    socket->binary(to_send.front().second);
    socket->async_write(asio::buffer(to_send.front().first),
                        [this](beast::error_code error, std::size_t) {
                          writing = false;
                          to_send.pop_front();
                          if (!error) write();
                        });
  }
};

PageClient::PageClient(const PageClientOptions& options) : impl_(std::make_unique<Impl>()) {
  tcp::socket tcp(impl_->io);
  tcp.open(tcp::v4());
  if (options.receive_buffer_bytes > 0)
    tcp.set_option(asio::socket_base::receive_buffer_size(options.receive_buffer_bytes));
  beast::error_code failed;
  tcp.connect(endpoint_of(options.port), failed);
  if (failed) return;
  tcp.set_option(tcp::no_delay(true));
  web::Stream stream(std::move(tcp), options.tls ? any_certificate() : nullptr);
  if (!connect(impl_->io, stream)) return;
  impl_->socket = std::make_unique<websocket::stream<web::Stream>>(std::move(stream));
  const std::string host = options.host.empty() ? own_host(options.port) : options.host;
  impl_->socket->read_message_max(0);
  impl_->socket->auto_fragment(false);
  impl_->socket->set_option(
      websocket::stream_base::decorator([&options, host](websocket::request_type& request) {
        request.set(http::field::sec_websocket_protocol, options.protocols.empty()
                                                             ? "mortise.1, token." + options.token
                                                             : options.protocols);
        const std::string own = (options.tls ? "https://" : "http://") + host;
        if (options.origin != "none")
          request.set(http::field::origin, options.origin.empty() ? own : options.origin);
      }));
  websocket::response_type response;
  bool answered = false;
  impl_->socket->async_handshake(response, host, "/ws", [&](beast::error_code error) {
    answered = true;
    impl_->open = !error;
    impl_->status = static_cast<int>(response.result_int());
  });
  wait([&] { return answered; });
  if (impl_->open) impl_->read(*this);
}
PageClient::~PageClient() { drop(); }

int PageClient::status() const { return impl_->status; }
bool PageClient::is_open() const { return impl_->open; }
int PageClient::close_code() const { return impl_->code; }
std::string PageClient::close_reason() const { return impl_->reason; }

void PageClient::take(const std::string& bytes, bool binary) {
  if (binary) {
    const auto frame = web::read_pose_frame(bytes);
    if (!frame) return;
    ++frames;
    frame_bytes += bytes.size();
    for (const web::PartState& part : frame->parts) seen[part.part.value] = part;
    if (on_frame) on_frame(*frame);
    return;
  }
  if (!keeps_texts) return;
  told.push_back(Json::parse(bytes, nullptr, false));
  if (told.back().is_object() && told.back().value("type", "") == "events")
    events += told.back()["events"].size();
}

void PageClient::send(const std::string& text) {
  impl_->to_send.emplace_back(text, false);
  impl_->write();
}
void PageClient::send_binary(const std::string& bytes) {
  impl_->to_send.emplace_back(bytes, true);
  impl_->write();
}

void PageClient::run(double seconds) { run_for(impl_->io, seconds); }

bool PageClient::wait(const std::function<bool()>& done, double limit_s) {
  const double end_s = now_s() + limit_s;
  while (!done()) {
    if (now_s() > end_s) return false;
    run(0.005);
  }
  return true;
}

Json PageClient::await(const std::string& type, double limit_s) {
  Json found;
  wait(
      [&] {
        while (read_to_ < told.size() && found.is_null()) {
          const Json& next = told[read_to_++];
          if (next.is_object() && next.value("type", "") == type) found = next;
        }
        return !found.is_null() || !impl_->open;
      },
      limit_s);
  return found;
}

bool PageClient::join(const std::string& name) {
  send_json(Json{{"type", "join"}, {"name", name}});
  return !await("joined").is_null();
}

bool PageClient::command(Json command) {
  command["type"] = "command";
  if (!command.contains("id")) command["id"] = 1;
  send_json(command);
  const Json reply = await("reply");
  return reply.is_object() && reply["done"].get<bool>();
}

void PageClient::move(std::uint32_t part, double x_mm, double y_mm, double z_mm) {
  send_json(Json{{"type", "move"}, {"part", part}, {"t", {x_mm, y_mm, z_mm}}});
}

void PageClient::drop() {
  if (!impl_->socket) return;
  impl_->socket->next_layer().next_layer().close();
  impl_->open = false;
  run(0.01);
}

bool write_certificate(const std::string& certificate_file, const std::string& key_file) {
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  const std::unique_ptr<X509, decltype(&X509_free)> certificate(X509_new(), X509_free);
  if (!key || !certificate) return false;
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -3600);
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), 3600);
  X509_set_pubkey(certificate.get(), key.get());
  X509_NAME* name = X509_get_subject_name(certificate.get());
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>("127.0.0.1"), -1, -1, 0);
  X509_set_issuer_name(certificate.get(), name);
  if (X509_sign(certificate.get(), key.get(), EVP_sha256()) == 0) return false;
  const auto written = [](const std::string& file, const auto& write) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(file.c_str(), "w"),
                                                              std::fclose);
    return out && write(out.get()) == 1;
  };
  return written(certificate_file,
                 [&](std::FILE* out) { return PEM_write_X509(out, certificate.get()); }) &&
         written(key_file, [&](std::FILE* out) {
           return PEM_write_PrivateKey(out, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
         });
}

}  // namespace mortise::test
