#pragma once
#include <string>

#include "common/messages/channel.h"

namespace mortise {

/// Who outside of the session knows which server leads it. A word of that one is written at a place
/// that most of its site agree on: this server leads, and that one, or nobody, may take over. So a
/// server that goes on alone and one that takes over cannot both succeed, whatever the net does.
class Fencing {
 public:
  virtual ~Fencing() = default;
  /// May clients be told now what `has_it` has too (empty: what this server alone has)? Implies
  /// that no other server can lead without it. Never blocks.
  virtual bool may_say(const ClientKey& has_it) const = 0;
  /// From now on this server, and no other, may take over (empty: nobody). It has all that was
  /// said. Returns at once; may_say() tells when it is so.
  virtual void ask(const ClientKey& who_may_take_over) = 0;
  /// Why this server must end, and what it has not said is never said; empty: it may go on.
  virtual std::string barred() const = 0;
};

}  // namespace mortise
