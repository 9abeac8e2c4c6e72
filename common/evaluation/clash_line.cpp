#include "common/evaluation/clash_line.h"

#include <algorithm>
#include <cctype>

#include "common/evaluation/open_bracket.h"
#include "common/evaluation/threshold_text.h"
#include "common/messages/length_text.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

// Longer ones are shortened so that room for the names of the parts is left.
constexpr std::size_t kFitColumns = 20, kNoteColumns = 26, kLeastPairColumns = 11;

bool starts_code_point(char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }

// The first `count` code points, or all after the first `count`.
std::size_t byte_of(const std::string& text, std::size_t count) {
  std::size_t at = 0;
  for (; at < text.size(); ++at)
    if (starts_code_point(text[at]) && count-- == 0) break;
  return at;
}

std::string shortened(const std::string& text, std::size_t columns) {
  const std::size_t has = columns_of(text);
  if (has <= columns) return text;
  const std::size_t kept = columns > 0 ? columns - 1 : 0, tail = kept / 2;
  return text.substr(0, byte_of(text, kept - tail)) + "…" + text.substr(byte_of(text, has - tail));
}

std::string padded(const std::string& text, std::size_t columns) {
  return text + std::string(columns - std::min(columns, columns_of(text)), ' ');
}

std::string class_word(const Verdict& verdict) {
  std::string word(name_of(verdict.collision_class));
  for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return word;
}

std::string pair_text(const ClashLine& clash, std::size_t columns) {
  const std::size_t names = columns - std::min<std::size_t>(columns, 3);
  const std::size_t a = columns_of(clash.part_a), b = columns_of(clash.part_b);
  const std::size_t half = names / 2;
  const std::size_t of_a = b <= half ? names - b : std::max(half, names - std::min(names, b));
  const std::string left = shortened(clash.part_a, std::min(a, of_a));
  return left + " × " + shortened(clash.part_b, names - std::min(names, columns_of(left)));
}

// "H7/p6" of "Ø20 H7/p6": the size is that of the parts. Nothing where other faces than those of
// the fit decided.
std::string fit_code(const ClashLine& clash) {
  if (clash.fit.empty() || clash.verdict->explanation.find(clash.fit) == std::string::npos)
    return "";
  const std::size_t blank = clash.fit.find(' ');
  const bool sized = clash.fit.starts_with("Ø") && blank != std::string::npos &&
                     clash.fit.find(' ', blank + 1) == std::string::npos;
  return shortened(sized ? clash.fit.substr(blank + 1) : clash.fit, kFitColumns);
}

bool says(const Verdict& v, const char* words) {
  return v.explanation.find(words) != std::string::npos;
}

// As the sentence has it, which knows how closely.
std::string probability_of(const Verdict& v) {
  const std::size_t at = v.explanation.find("P(interference)");
  if (at == std::string::npos) return probability_text({v.probability, v.probability});
  return v.explanation.substr(at, v.explanation.find('%', at) + 1 - at);
}

// Where no probability is known: how deep, and what that has to be for a real clash.
std::string depth_of(const Verdict& v) {
  const Interval& delta = v.delta_mm;
  const bool gap = delta.hi < 0.0;
  std::string text = gap ? "gap " : "overlap ";
  if (!is_open(delta))
    text += range_text(gap ? -delta : Interval{std::max(delta.lo, 0.0), delta.hi});
  else if (gap || delta.lo >= 0.0)
    text += "at least " + length_text(gap ? -delta.hi : delta.lo);
  else
    text += "at most " + length_text(delta.hi);
  if (says(v, "by estimate")) return text + ", by estimate";
  const bool decides = !reads_as_zero(v.real_above_mm) && v.real_above_mm > delta.hi;
  return decides && states_real(v) ? text + ", " + real_text(v.real_above_mm) : text;
}

std::string how_much(const ClashLine& clash) {
  const Verdict& v = *clash.verdict;
  if (says(v, "no inside") || says(v, "a part is open here"))
    return "depth not known, a part is open";
  const std::string code = fit_code(clash);
  const std::string in_fit = code.empty() ? "" : " in " + code;
  if (v.collision_class == CollisionClass::kPotential)
    return (has_probability(v) ? probability_of(v) : depth_of(v)) + in_fit;
  const std::string least = (is_open(v.delta_mm) ? "at least " : "");
  const std::string margin = least + length_text(v.margin_mm);
  if (v.collision_class != CollisionClass::kReal) return margin + " to spare" + in_fit;
  if (!code.empty()) return margin + " beyond " + code;
  return reads_as_zero(v.real_above_mm) ? margin + " deep"
                                        : margin + " beyond tolerance and mesh error";
}

std::string said_of(const ClashLine& clash) {
  std::string text = how_much(clash);
  const std::string& why = clash.verdict->explanation;
  if (why.find(kSamePartTwice) != std::string::npos) text += ", " + kSamePartTwice;
  if (why.find(kWhollyInside) != std::string::npos) text += ", one inside the other";
  if (clash.more_places > 0)
    text +=
        ", +" + std::to_string(clash.more_places) + (clash.more_places == 1 ? " place" : " places");
  if (!clash.note.empty()) text += "   " + shortened(clash.note, kNoteColumns);
  return text;
}

}  // namespace

std::size_t columns_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), starts_code_point));
}

std::vector<std::string> clash_lines(std::span<const ClashLine> clashes) {
  std::size_t class_columns = 0, said_columns = 0, pair_columns = 0;
  for (const ClashLine& clash : clashes) {
    class_columns = std::max(class_columns, columns_of(class_word(*clash.verdict)));
    said_columns = std::max(said_columns, columns_of(said_of(clash)));
    pair_columns = std::max(pair_columns, columns_of(clash.part_a) + 3 + columns_of(clash.part_b));
  }
  const std::size_t taken = class_columns + 2 + 3 + said_columns;
  const std::size_t room = kClashLineColumns - std::min(kClashLineColumns, taken);
  pair_columns = std::min(pair_columns, std::max(room, kLeastPairColumns));
  std::vector<std::string> lines;
  for (const ClashLine& clash : clashes)
    lines.push_back(shortened(padded(class_word(*clash.verdict), class_columns) + "  " +
                                  padded(pair_text(clash, pair_columns), pair_columns) + "   " +
                                  said_of(clash),
                              kClashLineColumns));
  return lines;
}

std::string clash_line(const ClashLine& clash) { return clash_lines(std::span(&clash, 1)).front(); }

std::string pair_line(const std::string& word, const std::string& part_a, const std::string& part_b,
                      const std::string& said) {
  const std::size_t taken = columns_of(word) + 2 + 3 + columns_of(said);
  const std::size_t room = kClashLineColumns - std::min(kClashLineColumns, taken);
  const ClashLine pair{part_a, part_b, nullptr, "", 0, ""};
  const std::size_t whole = columns_of(part_a) + 3 + columns_of(part_b);
  const std::size_t columns = std::min(whole, std::max(room, kLeastPairColumns));
  return shortened(word + "  " + pair_text(pair, columns) + "   " + said, kClashLineColumns);
}

std::string coloured_line(const std::string& line, CollisionClass collision_class) {
  int code = 2;  // faint: no class
  if (collision_class == CollisionClass::kReal) code = 31;
  if (collision_class == CollisionClass::kPotential) code = 33;
  if (collision_class == CollisionClass::kFake) code = 34;
  const std::size_t end = std::min(line.find(' '), line.size());
  return "\033[" + std::to_string(code) + "m" + line.substr(0, end) + "\033[0m" + line.substr(end);
}

}  // namespace mortise
