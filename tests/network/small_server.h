#pragma once
#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "idl/dds_channel.h"
#include "tests/network/patience.h"

namespace mortise::test {

/// Seconds of a clock that never goes back.
double now_s();
void sleep_s(double seconds);

/// Calls `turn` each few milliseconds until `done` or the time is over; says whether it was done.
bool until(double limit_s, const std::function<bool()>& done, const std::function<void()>& turn);

/// A server without an engine: admits everybody, moves what it is told to, counts. What a session
/// needs to know of the wire, and nothing else.
class SmallServer {
 public:
  SmallServer(ServerChannel& channel, const std::string& session, std::uint32_t parts);

  /// One turn: take, answer, publish poses of moved parts, a snapshot when asked for.
  void turn();
  void publish_events(std::uint32_t count);
  Snapshot snapshot() const;

  ServerInput last_input;
  std::vector<LostUser> lost;
  std::uint64_t increments = 0, event_seq = 0, tick = 0, commands = 0, refused_at_door = 0;
  std::map<UserId, std::pair<ClientKey, std::string>> users;
  std::map<UserId, std::uint64_t> newest;  ///< increment
  std::vector<PartPose> parts;
  double longest_publish_s = 0.0;
  std::uint64_t slow_publishes = 0;  ///< longer than a writer may wait for a lock

 private:
  void note_publish(double start_s);

  ServerChannel& channel_;
  std::string session_;
};

/// A participant in a process of its own (program network_peer); ended with the object, by its id
/// and nobody else's.
class Child {
 public:
  /// role: "client" or "server"; lives for stay_s, then says goodbye.
  Child(const std::string& role, const DdsOptions& options, const std::string& name, double stay_s);
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  void signal(int number) const;
  /// Waits for its end; its exit code, -1 when it was killed or the time is over.
  int wait(double limit_s);

 private:
  pid_t pid_ = 0;
  bool ended_ = false;
};

ClashEvent some_event(std::uint64_t seq, std::uint64_t tick);

}  // namespace mortise::test
