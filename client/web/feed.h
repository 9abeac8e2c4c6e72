#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/web/json_in.h"
#include "client/web/json_out.h"
#include "client/web/outbox.h"
#include "common/messages/role.h"

namespace mortise::web {

/// One connected page as a feed sees it. No call waits: unsent data is kept in the page's outbox.
class Viewer {
 public:
  virtual ~Viewer() = default;
  virtual Role role() const = 0;  ///< what its token allows
  /// The only name that its token lets it join under; empty: any.
  virtual const std::string& bound_name() const = 0;
  virtual void say(SharedBytes text) = 0;
  virtual void say_views(SharedBytes text) = 0;
  virtual void changed(const std::vector<PartId>& parts, SharedBytes frame) = 0;
  /// Says `scene`, which covers all changes so far.
  virtual void show_scene(SharedBytes scene) = 0;
  virtual std::uint64_t folded_frames() const = 0;
};

/// A mesh, as asked for by its hash.
struct MeshAnswer {
  enum class State : std::uint8_t { kUnknown = 0, kHere, kAwaited };
  State state = State::kUnknown;
  SharedBytes bytes;
};

/// Where pages get their session from: a live one, or a log. Used from one thread.
class Feed {
 public:
  virtual ~Feed() = default;
  virtual const char* mode() const = 0;  ///< "live" or "replay"
  virtual void enter(Viewer& viewer) = 0;
  virtual void leave(Viewer& viewer) = 0;  ///< frees what it held
  /// Its line broke without a goodbye: it may come back on another one.
  virtual void lose(Viewer& viewer) { leave(viewer); }
  /// Fails with a sentence for the page when the message makes no sense in this state.
  virtual Status take(Viewer& viewer, const PageMessage& message) = 0;
  /// Sends news to the viewers. Called every few milliseconds with a monotonic clock.
  virtual void turn(double now_s) = 0;
  /// A page was given this ticket for a file: how many bytes it announced. Each ticket counts once;
  /// take_file() or drop_file() ends it.
  virtual std::optional<std::size_t> begin_file(const std::string& /*ticket*/) {
    return std::nullopt;
  }
  virtual bool awaits_file(const std::string& /*ticket*/) const { return false; }
  virtual Status take_file(const std::string& /*ticket*/, std::vector<std::byte> /*bytes*/) {
    return fail(Code::kInvalidInput, "nobody waits for this file");
  }
  virtual void drop_file(const std::string& /*ticket*/) {}
  virtual SharedBytes frame(const Viewer& viewer, const std::vector<PartId>& parts) const = 0;
  virtual MeshAnswer mesh(const std::string& hash) const = 0;
  virtual std::string trouble() const = 0;  ///< why there is no session; empty: there is one
  virtual Json statistics() const = 0;
};

}  // namespace mortise::web
