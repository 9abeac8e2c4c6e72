#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

namespace mortise {

using Triple = std::array<double, 3>;

/// The coordinates of a text file (OBJ, STL) with all digits that are written there; assimp keeps
/// floats. They are found again by the float that assimp made of them.
class WrittenDigits {
 public:
  /// Of the text that assimp read. What is no such text gives none.
  WrittenDigits(const std::string& text, const std::string& extension);

  /// The coordinates as written; null where none or several different ones became this float.
  const Triple* find(float x, float y, float z) const;

 private:
  struct Found {
    Triple written;
    bool several = false;
  };
  using Key = std::array<std::uint32_t, 3>;  // the bits of the floats
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  static Key key_of(float x, float y, float z);
  std::unordered_map<Key, Found, Hash> of_;
};

/// How far coordinates may be off for the way they are written: half of the last digit of the
/// largest, where so many of them use it that this is no design in round numbers, and where all of
/// them are floats half an ulp. 0: neither. `slack`: how far they may be off what was written, as a
/// share of each.
double written_quantum(const std::vector<Triple>& coordinates, double slack);

/// Half the distance to the next float.
double half_ulp(double x);

}  // namespace mortise
