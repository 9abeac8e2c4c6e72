#pragma once
/// \file
/// A participant of a live session: joins the server over DDS, grabs parts, moves them, listens.
#include <mortise/judge.h>

namespace mortise::api {

/// Where a session is met.
struct ClientOptions {
  std::string session = "default";      ///< its name
  int domain = 0;                       ///< 0 to 232
  std::string interface = "127.0.0.1";  ///< own IPv4 address
  std::string server = {};              ///< hosts that may lead it, comma between; empty: this one
  std::string discovery_server = {};    ///< HOST[:PORT], comma between; empty: none
  int discovery_port = 0;               ///< of the server; 0: by the domain
  std::string keys = {};                ///< folder of an identity; empty: none
  std::string role = "designer";        ///< designer, observer or bot
  double wait_s = 10.0;                 ///< for the server and the answer
};

/// What a client knows of a part.
struct LivePart {
  std::string name;              ///< of the part
  Pose X_WP = Pose::Identity();  ///< where it stood last
  bool moving = false;           ///< may it be moved?
  std::string holder;            ///< user; empty: nobody
};

/// A clash begins, changes, ends or is reviewed.
struct LiveEvent {
  std::string kind;        ///< begin, change, end or review
  std::uint64_t tick = 0;  ///< of the session
  std::string user;        ///< who moved last; empty: nobody
  Clash clash;             ///< with its id
};

/// What came while a client listened.
struct Heard {
  std::vector<LiveEvent> events;     ///< in order, none twice
  std::vector<std::string> refused;  ///< moves and requests that were refused, and why
  bool server_lost = false;          ///< the client joins again by itself
};

/// One user of a live session. Whoever holds one calls listen() or another waiting function at
/// least five times a second, or counts as absent after 0.8 s. One thread at a time.
class Client {
 public:
  /// Joins as `user` and waits for the parts. Fails after wait_s, and when the server refuses.
  static Result<Client> join(const std::string& user, const ClientOptions& options = {});
  Client(Client&&) noexcept;             ///< the other one is empty then
  Client& operator=(Client&&) noexcept;  ///< the other one is empty then
  ~Client();                             ///< leaves

  std::vector<LivePart> parts() const;      ///< of the session, by number
  std::vector<Clash> open_clashes() const;  ///< the worst first
  Status grab(const std::string& part);     ///< waits for the answer; fails when refused
  Status release(const std::string& part);  ///< waits for the answer; fails when refused
  /// Sends a push: X_WP becomes dX_W * X_WP, as far as the session lets it. Returns at once; a
  /// refusal is heard later. Fails on an unknown part and on what is no rigid motion.
  Status move(const std::string& part, const Pose& dX_W);
  Heard listen(double seconds);  ///< takes what comes for so long, 0 to 3600 s
  bool server_present() const;   ///< is the server there?

  struct Impl;  ///< private

 private:
  explicit Client(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace mortise::api
