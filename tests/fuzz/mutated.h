#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>

namespace mortise::test {

/// One to four changes: bits, bytes, runs, lengths, cuts, insertions, and repeated pieces.
inline std::string mutated(std::string bytes, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (std::uint64_t changes = 1 + below(4); changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = below(bytes.size());
    switch (below(7)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(below(256));
        break;
      case 2:  // an interesting number where a length may be
        for (std::size_t i = at; i < std::min(at + 8, bytes.size()); ++i)
          bytes[i] = static_cast<char>(below(2) == 0 ? 0x00 : 0xff);
        break;
      case 3:
        bytes.resize(at);
        break;
      case 4:
        bytes.insert(at, below(64), static_cast<char>(below(256)));
        break;
      case 5:
        bytes.erase(at, below(256));
        break;
      default:
        bytes.insert(at, bytes.substr(below(bytes.size()), below(2048)));
    }
  }
  return bytes;
}

}  // namespace mortise::test
