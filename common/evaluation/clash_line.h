#pragma once
#include <span>
#include <string>
#include <vector>

#include "common/messages/verdict.h"

namespace mortise {

/// One clash of a list for people: the worst region of a pair leads, the others are counted.
struct ClashLine {
  std::string part_a, part_b;
  const Verdict* verdict = nullptr;
  std::string fit;              ///< of the pair, "Ø20 H7/p6", or empty
  std::size_t more_places = 0;  ///< further regions of the pair
  std::string note;             ///< at the end, or empty: "clash 4 by ann"
};

/// What an explanation says where parts are not pressed into each other, but placed so.
inline const std::string kSamePartTwice = "the same part twice";
inline const std::string kWhollyInside = " lies wholly inside ";

/// "REAL  cover × bearing   0.5 µm beyond H7/p6", the columns of all lines aligned. At most
/// kClashLineColumns columns each; names that are too long lose their middle.
std::vector<std::string> clash_lines(std::span<const ClashLine> clashes);
std::string clash_line(const ClashLine& clash);
/// The same form of another word: "ENDED  cover × bearing   was real for 1.8 s".
std::string pair_line(const std::string& word, const std::string& part_a, const std::string& part_b,
                      const std::string& said);
/// Its first word in the colour of the class on a terminal.
std::string coloured_line(const std::string& line, CollisionClass collision_class);
inline constexpr std::size_t kClashLineColumns = 100;  ///< chosen: the width of most terminals

/// Columns of UTF-8 text on a terminal: code points.
std::size_t columns_of(const std::string& text);

}  // namespace mortise
