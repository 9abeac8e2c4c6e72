#include "server/etcd_client.h"

#include <openssl/evp.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <sstream>

namespace mortise {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;

// An answer holds a lease or one key, some hundred bytes; etcd takes no request of more than 1.5
// MB.
constexpr std::size_t kMostAnswer_bytes = 1 << 20;

std::string base64(std::string_view text) {
  std::string out(4 * ((text.size() + 2) / 3) + 1, '\0');
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()),
                                   reinterpret_cast<const unsigned char*>(text.data()),
                                   static_cast<int>(text.size()));
  out.resize(static_cast<std::size_t>(size));
  return out;
}

std::string of_base64(const std::string& text) {
  std::string out(text.size() / 4 * 3 + 1, '\0');
  const int size = EVP_DecodeBlock(reinterpret_cast<unsigned char*>(out.data()),
                                   reinterpret_cast<const unsigned char*>(text.data()),
                                   static_cast<int>(text.size()));
  if (size < 0) return {};
  // It decodes the padding as well.
  const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0;
  out.resize(static_cast<std::size_t>(size) - padding);
  return out;
}

/// One request to one node.
class Exchange {
 public:
  std::optional<nlohmann::json> run(const std::pair<std::string, std::uint16_t>& node,
                                    const std::string& target, const std::string& body) {
    request_.method(http::verb::post);
    request_.target(target);
    request_.set(http::field::host, node.first + ":" + std::to_string(node.second));
    request_.set(http::field::content_type, "application/json");
    request_.body() = body;
    request_.prepare_payload();
    parser_.body_limit(kMostAnswer_bytes);
    stream_.expires_after(std::chrono::milliseconds(static_cast<int>(EtcdClient::kAnswer_s * 1e3)));
    stream_.async_connect({asio::ip::make_address_v4(node.first), node.second},
                          [this](beast::error_code error) {
                            if (!error) write();
                          });
    io_.run();
    if (!answered_) return std::nullopt;
    nlohmann::json answer = nlohmann::json::parse(parser_.get().body(), nullptr, false);
    if (!answer.is_object()) return std::nullopt;
    return answer;
  }

 private:
  void write() {
    http::async_write(stream_, request_, [this](beast::error_code error, std::size_t) {
      if (!error) read();
    });
  }
  // A stream of answers (lease/keepalive) has no end: the first line is enough.
  void read() {
    http::async_read(stream_, buffer_, parser_,
                     [this](beast::error_code error, std::size_t) { answered_ = !error; });
  }

  asio::io_context io_{1};
  beast::tcp_stream stream_{io_};
  beast::flat_buffer buffer_;
  http::request<http::string_body> request_;
  http::response_parser<http::string_body> parser_;
  bool answered_ = false;
};

}  // namespace

Result<EtcdClient> EtcdClient::open(const std::string& nodes) {
  EtcdClient client;
  std::istringstream list(nodes);
  for (std::string node; std::getline(list, node, ',');) {
    const std::string_view text =
        std::string_view(node).substr(node.starts_with("http://") ? 7 : 0);
    const std::size_t colon = text.rfind(':');
    const std::string host(text.substr(0, colon));
    boost::system::error_code error;
    (void)asio::ip::make_address_v4(host, error);
    std::uint16_t port = 0;
    if (colon != std::string_view::npos)
      std::from_chars(text.data() + colon + 1, text.data() + text.size(), port);
    if (error || port == 0)
      return fail(Code::kInvalidInput, "--etcd " + node + ": IPv4:PORT of a node is expected");
    client.nodes_.emplace_back(host, port);
  }
  if (client.nodes_.empty()) return fail(Code::kInvalidInput, "--etcd names no node");
  return client;
}

std::optional<nlohmann::json> EtcdClient::ask(const std::string& what,
                                              const nlohmann::json& request) {
  const std::string body = request.dump();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const std::size_t node = (last_ + i) % nodes_.size();
    auto answer = Exchange().run(nodes_[node], "/v3/" + what, body);
    if (!answer || answer->contains("error")) continue;
    last_ = node;
    return answer;
  }
  last_ = (last_ + 1) % nodes_.size();
  return std::nullopt;
}

std::optional<EtcdClient::Value> EtcdClient::read(const std::string& key) {
  const auto answer = ask("kv/range", {{"key", base64(key)}});
  if (!answer) return std::nullopt;
  const nlohmann::json& values = member(*answer, "kvs");
  if (!values.is_array() || values.empty()) return Value{};
  const nlohmann::json& text = member(values[0], "value");
  return Value{text.is_string() ? of_base64(text.get<std::string>()) : std::string(),
               number(values[0], "mod_revision")};
}

nlohmann::json EtcdClient::unchanged_since(const std::string& key, std::int64_t revision) {
  return {{"key", base64(key)},
          {"target", "MOD"},
          {"result", "EQUAL"},
          {"mod_revision", std::to_string(revision)}};
}

nlohmann::json EtcdClient::put(const std::string& key, const std::string& text,
                               std::int64_t lease) {
  return {{"request_put",
           {{"key", base64(key)}, {"value", base64(text)}, {"lease", std::to_string(lease)}}}};
}

const nlohmann::json& EtcdClient::member(const nlohmann::json& object, const char* name) {
  static const nlohmann::json none;
  const auto found = object.is_object() ? object.find(name) : object.end();
  return found == object.end() ? none : *found;
}

std::int64_t EtcdClient::number(const nlohmann::json& object, const char* name) {
  const nlohmann::json& text = member(object, name);
  return text.is_string() ? std::strtoll(text.get<std::string>().c_str(), nullptr, 10) : 0;
}

}  // namespace mortise
