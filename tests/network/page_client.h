#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "client/web/frames.h"

namespace mortise::test {

using Json = nlohmann::json;
using Fields = std::vector<std::pair<std::string, std::string>>;

/// What a server answered; status 0: nothing, or not in time.
struct HttpAnswer {
  int status = 0;
  std::string body;
  Fields fields;
  std::string field(const std::string& name) const;
};
/// One request on a connection of its own.
HttpAnswer http_request(int port, const std::string& target, const Fields& fields = {},
                        const std::string& method = "GET", bool tls = false);

/// A connection of bare bytes.
class RawConnection {
 public:
  explicit RawConnection(int port);
  ~RawConnection();
  bool send(const std::string& bytes);
  /// What comes until the other end closes or the time is over; `closed` says which.
  std::string read(double limit_s, bool& closed);

 private:
  int socket_ = -1;
};

struct PageClientOptions {
  int port = 0;
  std::string token;
  std::string protocols = {};  ///< empty: "mortise.1, token." and the token
  std::string origin = {};     ///< empty: the own; "none": no such field
  std::string host = {};       ///< empty: the own
  int receive_buffer_bytes = 0;
  bool tls = false;
};

/// A page without a browser: joins over WebSocket, keeps what it was told. Reads only while one of
/// its functions runs, so one that is left alone is a stopped browser.
class PageClient {
 public:
  explicit PageClient(const PageClientOptions& options);
  ~PageClient();  ///< drops the connection without a word
  PageClient(const PageClient&) = delete;
  PageClient& operator=(const PageClient&) = delete;

  int status() const;  ///< of the handshake: 101 when it is open
  bool is_open() const;
  /// Close code of the other end, 0 without one; why.
  int close_code() const;
  std::string close_reason() const;

  void send(const std::string& text);
  void send_json(const Json& json) { send(json.dump()); }
  void send_binary(const std::string& bytes);
  void run(double seconds);
  /// Reads until it is so; false when the time is over or the connection.
  bool wait(const std::function<bool()>& done, double limit_s = 8.0);
  /// Waits for the next message of a type, from `from` on; null when none comes.
  Json await(const std::string& type, double limit_s = 8.0);

  bool join(const std::string& name);
  bool command(Json command);  ///< waits for the reply, and says whether it was done
  void move(std::uint32_t part, double x_mm, double y_mm, double z_mm);
  void drop();  ///< as a crash does

  std::vector<Json> told;
  std::map<std::uint32_t, web::PartState> seen;
  std::uint64_t frames = 0, frame_bytes = 0, events = 0;
  std::function<void(const web::PoseFrame&)> on_frame;
  bool keeps_texts = true;

 private:
  struct Impl;
  void take(const std::string& bytes, bool binary);
  std::unique_ptr<Impl> impl_;
  std::size_t read_to_ = 0;
};

/// A certificate for 127.0.0.1 and its key, as PEM files in a folder; false when that failed.
bool write_certificate(const std::string& certificate_file, const std::string& key_file);

}  // namespace mortise::test
