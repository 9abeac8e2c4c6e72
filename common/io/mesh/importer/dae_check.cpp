#include "common/io/mesh/importer/dae_check.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <unordered_map>
#include <vector>

#include "common/base/in_quotes.h"
#include "common/io/mesh/importer/nesting.h"

namespace mortise {
namespace {

/// More than any file; products of two of these fit into 64 bits.
constexpr std::uint64_t kMostOfDae = std::uint64_t{1} << 31U;

/// What an instance names, by its own name.
const std::map<std::string_view, std::string_view> kNamedByInstances = {
    {"instance_geometry", "geometry"},
    {"instance_controller", "controller"},
    {"instance_node", "node"},
    {"instance_visual_scene", "visual_scene"}};

/// The placements of a node, and of how many numbers each is.
const std::map<std::string_view, std::size_t> kPlacements = {
    {"matrix", 16}, {"translate", 3}, {"rotate", 4}, {"scale", 3}, {"lookat", 9}, {"skew", 7}};

template <class Number>
bool is_whole_word(std::string_view word, Number& number) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), number);
  return status == std::errc{} && end == word.data() + word.size();
}

/// Of an element or attribute, for a message.
std::string named(const pugi::xml_node& node) {
  const std::string id = node.attribute("id").value();
  return "<" + std::string(node.name()) + ">" + (id.empty() ? "" : " " + in_quotes(id));
}

class DaeCheck {
 public:
  /// One line; empty: nothing is wrong.
  std::string wrong(const pugi::xml_document& document) {
    for_each(document, [&](const pugi::xml_node& node) { note_id(node); });
    if (const std::string nested = wrong_with_nesting(holds(document), "elements"); !nested.empty())
      return nested;
    for_each(document, [&](const pugi::xml_node& node) {
      if (wrong_.empty()) check(node);
    });
    return wrong_;
  }

 private:
  template <class Visit>
  static void for_each(const pugi::xml_document& document, const Visit& visit) {
    for (pugi::xml_node node = document.first_child(); node;) {
      visit(node);
      pugi::xml_node next = node.first_child();
      for (; !next && node; node = node.parent()) next = node.next_sibling();
      node = next;
    }
  }

  /// What each element holds: what stands in it, and the node that it names.
  std::vector<std::vector<std::size_t>> holds(const pugi::xml_document& document) const {
    std::unordered_map<std::size_t, std::size_t> number;
    for_each(document,
             [&](const pugi::xml_node& node) { number.emplace(node.hash_value(), number.size()); });
    std::vector<std::vector<std::size_t>> holds(number.size());
    for_each(document, [&](const pugi::xml_node& node) {
      const std::size_t own = number[node.hash_value()];
      if (const auto above = number.find(node.parent().hash_value()); above != number.end())
        holds[above->second].push_back(own);
      if (std::string_view(node.name()) != "instance_node") return;
      if (const pugi::xml_node named = find("node", node.attribute("url").value()))
        holds[own].push_back(number[named.hash_value()]);
    });
    return holds;
  }

  void fault(const pugi::xml_node& node, const std::string& what) {
    if (wrong_.empty()) wrong_ = named(node) + " " + what;
  }

  void note_id(const pugi::xml_node& node) {
    const std::string_view kind = node.name(), id = node.attribute("id").value();
    if (id.empty()) return;
    const bool fresh = of_kind_[std::string(kind)].emplace(std::string(id), node).second;
    if (!fresh && (kind == "geometry" || kind == "float_array")) fault(node, "stands here twice");
  }

  /// The element of a kind that "#id" names.
  pugi::xml_node find(std::string_view kind, std::string_view name) const {
    const auto all = of_kind_.find(std::string(kind));
    if (all == of_kind_.end() || !name.starts_with('#')) return {};
    const auto found = all->second.find(std::string(name.substr(1)));
    return found == all->second.end() ? pugi::xml_node() : found->second;
  }

  void check(const pugi::xml_node& node) {
    const std::string_view kind = node.name();
    if (const auto names = kNamedByInstances.find(kind); names != kNamedByInstances.end())
      check_instance(node, names->second);
    if (const auto place = kPlacements.find(kind);
        place != kPlacements.end() && std::string_view(node.parent().name()) == "node")
      check_numbers(node, place->second);
    if (kind == "float_array") {
      if (const auto count = whole(node, "count", {})) check_numbers(node, *count);
    }
    if (kind == "p" || kind == "vcount") check_indices(node);
    if (kind == "accessor") check_accessor(node);
    if (kind == "unit") check_unit(node);
  }

  void check_instance(const pugi::xml_node& node, std::string_view kind) {
    const std::string_view name = node.attribute("url").value();
    if (!find(kind, name))
      fault(node, "names " + in_quotes(name) + ", and the file has no such " + std::string(kind));
  }

  /// Whole and not too large; nothing and a fault: it is not.
  std::optional<std::uint64_t> whole(const pugi::xml_node& node, const char* key,
                                     std::optional<std::uint64_t> otherwise) {
    const pugi::xml_attribute given = node.attribute(key);
    if (!given && otherwise) return otherwise;
    std::uint64_t number = 0;
    if (is_whole_word(given.value(), number) && number < kMostOfDae) return number;
    fault(node, "has the " + std::string(key) + " " + in_quotes(given.value()));
    return {};
  }

  /// Calls `good` with each word of the text in a node, until it says false.
  template <class Good>
  static std::size_t words_of(const pugi::xml_node& node, const Good& good) {
    constexpr std::string_view kBlanks = " \t\r\n";
    const std::string_view text = node.child_value();
    std::size_t words = 0;
    for (std::size_t at = text.find_first_not_of(kBlanks); at != std::string_view::npos;) {
      const std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
      if (!good(text.substr(at, end - at))) break;
      ++words;
      at = text.find_first_not_of(kBlanks, end);
    }
    return words;
  }

  void check_numbers(const pugi::xml_node& node, std::uint64_t wanted) {
    const std::size_t count = words_of(node, [&](std::string_view word) {
      double x = 0.0;
      const bool good = is_whole_word(word, x);
      if (!good)
        fault(node,
              "holds " + in_quotes(word) + ", which is no number" +
                  (word.find(',') == std::string_view::npos ? "" : " (decimals have a point)"));
      return good;
    });
    if (count != wanted)
      fault(node, "holds " + std::to_string(count) + " numbers, not " + std::to_string(wanted));
  }

  void check_indices(const pugi::xml_node& node) {
    words_of(node, [&](std::string_view word) {
      std::uint64_t index = 0;
      const bool good = is_whole_word(word, index);
      if (!good) fault(node, "holds " + in_quotes(word) + ", which is no index");
      return good;
    });
  }

  void check_accessor(const pugi::xml_node& node) {
    const std::string_view source = node.attribute("source").value();
    const pugi::xml_node array = find("float_array", source);
    if (!array) return;  // of names, or of nothing: assimp says so
    const auto count = whole(node, "count", {}), stride = whole(node, "stride", 1),
               offset = whole(node, "offset", 0), there = whole(array, "count", {});
    if (!count || !stride || !offset || !there) return;
    if (*offset + *count * *stride > *there)
      fault(node, "to " + in_quotes(source) + " reaches beyond its " + std::to_string(*there) +
                      " numbers");
  }

  void check_unit(const pugi::xml_node& node) {
    const pugi::xml_attribute metres = node.attribute("meter");
    double x = 0.0;
    if (metres && !(is_whole_word(metres.value(), x) && x > 0.0 &&
                    x <= static_cast<double>(std::numeric_limits<float>::max())))
      fault(node, "has " + in_quotes(metres.value()) + " metres");
  }

  std::map<std::string, std::map<std::string, pugi::xml_node>> of_kind_;
  std::string wrong_;
};

}  // namespace

std::string wrong_with_dae(std::string_view bytes) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(bytes.data(), bytes.size());
  if (!parsed) return "its XML is damaged or was cut off, at byte " + std::to_string(parsed.offset);
  return DaeCheck().wrong(document);
}

}  // namespace mortise
