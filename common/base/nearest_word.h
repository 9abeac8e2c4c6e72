#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace mortise {

/// The known word that was meant by a mistyped one: one that begins with it or the reverse, else
/// the one that is fewest edits away (insertions, removals, replacements, swapped neighbours; small
/// and capital letters are the same, and so are µ and u). Empty where none is near: more than half
/// of it would change.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

/// "; did you mean 'policy'?", or "; known: a, b, c" where none is near; of many the first ones.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

}  // namespace mortise
