#include "common/base/nearest_word.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace mortise {
namespace {

/// A shorter beginning is shared by chance.
constexpr std::size_t kLeastBeginning = 2;
/// Known words in one sentence; chosen: a line or two of a terminal.
constexpr std::size_t kMostListed = 12;

// The sign of micro, which Unicode has twice, is a u where only plain letters are known: µm is um.
std::string lower(std::string_view text) {
  std::string small(text);
  for (const std::string_view micro : {"\u00b5", "\u03bc"})
    for (std::size_t at = 0; (at = small.find(micro, at)) != small.npos;)
      small.replace(at, micro.size(), "u");
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] =
          std::min({last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1), last[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last.back();
}

bool one_begins_the_other(const std::string& a, const std::string& b) {
  return std::min(a.size(), b.size()) >= kLeastBeginning && (a.starts_with(b) || b.starts_with(a));
}

}  // namespace

std::string nearest_word(std::string_view word, const std::vector<std::string>& known) {
  const std::string wanted = lower(word);
  const std::string* best = nullptr;
  std::size_t fewest = 0;
  for (const std::string& candidate : known) {
    const std::string offered = lower(candidate);
    const std::size_t longer = std::max(wanted.size(), offered.size());
    const bool begins = one_begins_the_other(wanted, offered);
    const std::size_t count = edits(wanted, offered);
    if (!begins && (count >= longer || 2 * count > longer + 1)) continue;
    // A shared beginning counts as less than any other edit.
    const std::size_t rank =
        begins ? longer - std::min(wanted.size(), offered.size()) : 1000 + count;
    if (best != nullptr && rank >= fewest) continue;
    best = &candidate;
    fewest = rank;
  }
  return best == nullptr ? "" : *best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
  if (const std::string nearest = nearest_word(word, known); !nearest.empty())
    return "; did you mean '" + nearest + "'?";
  std::string list;
  for (std::size_t i = 0; i < std::min(kMostListed, known.size()); ++i)
    list += (i == 0 ? "" : ", ") + known[i];
  if (known.size() > kMostListed)
    list += " and " + std::to_string(known.size() - kMostListed) + " more";
  return "; known: " + list;
}

}  // namespace mortise
