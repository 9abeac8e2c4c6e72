#pragma once

namespace mortise::test {

/// While one lives, participants that this process makes do not ask their own permissions before
/// they open an endpoint: a stranger with a Fast DDS of their own making. What the others hold
/// against them stays as it is.
struct Unruly {
  Unruly();
  ~Unruly();
  Unruly(const Unruly&) = delete;
  Unruly& operator=(const Unruly&) = delete;
};

}  // namespace mortise::test
