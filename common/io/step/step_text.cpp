#include "common/io/step/step_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

namespace mortise {
namespace {

bool is_keyword(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

// The place after a string or comment that begins at i, else i.
std::size_t past_quoted(std::string_view text, std::size_t i) {
  if (text[i] == '\'') {
    const std::size_t end = text.find('\'', i + 1);
    return end == std::string_view::npos ? text.size() : end + 1;
  }
  if (text[i] == '/' && i + 1 < text.size() && text[i + 1] == '*') {
    const std::size_t end = text.find("*/", i + 2);
    return end == std::string_view::npos ? text.size() : end + 2;
  }
  return i;
}

// The place of the bracket that closes the one at `open`, or the end.
std::size_t closing(std::string_view text, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < text.size(); ++i) {
    if (const std::size_t past = past_quoted(text, i); past > i) {
      i = past - 1;
      continue;
    }
    depth += text[i] == '(' ? 1 : text[i] == ')' ? -1 : 0;
    if (depth == 0) return i;
  }
  return text.size();
}

// Calls visit(keyword, text between its brackets) for each record of an entity.
template <class Visit>
void for_records(std::string_view entity, Visit visit) {
  entity = trimmed(entity);
  if (entity.starts_with('(')) entity = entity.substr(1, closing(entity, 0) - 1);
  for (std::size_t i = 0; i < entity.size();) {
    if (!is_keyword(entity[i])) {
      i = std::max(past_quoted(entity, i), i + 1);
      continue;
    }
    const std::size_t begin = i;
    while (i < entity.size() && is_keyword(entity[i])) ++i;
    const std::string_view keyword = entity.substr(begin, i - begin);
    while (i < entity.size() && is_blank(entity[i])) ++i;
    if (i >= entity.size() || entity[i] != '(') continue;
    const std::size_t end = closing(entity, i);
    visit(keyword, entity.substr(i + 1, end - std::min(end, i + 1)));
    i = end + 1;
  }
}

}  // namespace

StepText::StepText(std::string text) : text_(std::move(text)) {
  const std::string_view all = text_;
  std::size_t begin = 0;  // of the statement
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (const std::size_t past = past_quoted(all, i); past > i) {
      i = past - 1;
      continue;
    }
    if (all[i] != ';') continue;
    const std::string_view statement = trimmed(all.substr(begin, i - begin));
    begin = i + 1;
    const std::size_t equals = statement.find('=');
    if (!statement.starts_with('#') || equals == std::string_view::npos) continue;
    const int label = step_reference(trimmed(statement.substr(0, equals)));
    if (label <= 0) continue;
    const std::string_view entity = trimmed(statement.substr(equals + 1));
    place_of_.try_emplace(label, static_cast<std::size_t>(entity.data() - all.data()),
                          entity.size());
  }
}

std::string_view StepText::entity(int label) const {
  const auto found = place_of_.find(label);
  if (found == place_of_.end()) return {};
  return std::string_view(text_).substr(found->second.first, found->second.second);
}

std::vector<int> StepText::labels_with(std::string_view text) const {
  std::vector<int> labels;
  for (const auto& [label, place] : place_of_)
    if (entity(label).find(text) != std::string_view::npos) labels.push_back(label);
  std::sort(labels.begin(), labels.end());
  return labels;
}

std::size_t StepText::line_of(int label) const {
  const auto found = place_of_.find(label);
  if (found == place_of_.end()) return 0;
  const auto end = text_.begin() + static_cast<std::ptrdiff_t>(found->second.first);
  return 1 + static_cast<std::size_t>(std::count(text_.begin(), end, '\n'));
}

std::vector<int> step_references(std::string_view entity) {
  std::vector<int> references;
  for (std::size_t i = 0; i < entity.size();) {
    if (entity[i] != '#') {
      i = std::max(past_quoted(entity, i), i + 1);
      continue;
    }
    const std::size_t end = std::min(entity.find_first_not_of("0123456789", i + 1), entity.size());
    if (const int label = step_reference(entity.substr(i, end - i)); label > 0)
      references.push_back(label);
    i = end;
  }
  return references;
}

std::vector<std::string> step_keywords(std::string_view entity) {
  std::vector<std::string> keywords;
  for_records(entity,
              [&](std::string_view keyword, std::string_view) { keywords.emplace_back(keyword); });
  return keywords;
}

std::optional<std::vector<std::string_view>> step_arguments(std::string_view entity,
                                                            std::string_view keyword) {
  std::optional<std::vector<std::string_view>> arguments;
  for_records(entity, [&](std::string_view its, std::string_view between) {
    if (its != keyword || arguments) return;
    arguments.emplace();
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= between.size(); ++i) {
      if (i == between.size() || between[i] == ',') {
        arguments->push_back(trimmed(between.substr(begin, i - begin)));
        begin = i + 1;
      } else if (between[i] == '(') {
        i = std::min(closing(between, i), between.size() - 1);
      } else if (const std::size_t past = past_quoted(between, i); past > i) {
        i = past - 1;
      }
    }
  });
  return arguments;
}

int step_reference(std::string_view argument) {
  int label = 0;
  if (!argument.starts_with('#')) return 0;
  const char* end = argument.data() + argument.size();
  const auto [rest, error] = std::from_chars(argument.data() + 1, end, label);
  return error == std::errc{} && rest == end && label > 0 ? label : 0;
}

std::optional<double> step_number(std::string_view argument) {
  argument = trimmed(argument);
  if (const std::size_t open = argument.find('('); open != std::string_view::npos)
    argument = trimmed(argument.substr(open + 1, closing(argument, open) - open - 1));
  if (argument.starts_with('+')) argument.remove_prefix(1);
  double value = 0.0;
  const char* end = argument.data() + argument.size();
  const auto [rest, error] = std::from_chars(argument.data(), end, value);
  if (error != std::errc{} || rest != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace mortise
