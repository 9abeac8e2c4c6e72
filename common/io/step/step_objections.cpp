#include "common/io/step/step_objections.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "common/io/step/step_document.h"
#include "common/math/types.h"

namespace mortise {
namespace {

constexpr std::string_view kUsage = "NEXT_ASSEMBLY_USAGE_OCCURRENCE";
constexpr std::string_view kOperator = "CARTESIAN_TRANSFORMATION_OPERATOR_3D";

// One place in an assembly: of which product in which.
struct Usage {
  int label = 0, parent = 0, child = 0;
};

std::vector<Usage> usages_of(const StepText& text) {
  std::vector<Usage> usages;
  for (const int label : text.labels_with(kUsage)) {
    const auto arguments = step_arguments(text.entity(label), kUsage);
    if (!arguments) continue;
    Usage usage{label, 0, 0};
    if (arguments->size() >= 5) {
      usage.parent = step_reference((*arguments)[3]);
      usage.child = step_reference((*arguments)[4]);
    }
    usages.push_back(usage);
  }
  return usages;
}

/// The tree of products, as the places in assemblies state it.
class ProductTree {
 public:
  explicit ProductTree(const StepText& text) : text_(text) {
    for (const Usage& usage : usages_of(text))
      if (usage.parent > 0 && usage.child > 0) places_of_[usage.parent].push_back(usage);
  }

  std::string refusal() {
    std::unordered_set<int> placed;
    for (const auto& [product, places] : places_of_)
      for (const Usage& usage : places) placed.insert(usage.child);
    double instances = 0.0;
    for (const auto& [product, places] : places_of_) {
      const Below below = below_of(product, 1);
      if (!refusal_.empty()) return refusal_;
      if (!placed.contains(product)) instances += below.instances;
    }
    if (instances > static_cast<double>(kMostStepInstances))
      return "it has more than " + std::to_string(kMostStepInstances) +
             " instances; export a part of the assembly";
    return {};
  }

 private:
  struct Below {
    double instances = 1.0;  // a product that holds none is one itself; a count may be huge
    std::size_t levels = 1;
  };

  Below below_of(int product, std::size_t depth) {
    const auto places = places_of_.find(product);
    if (places == places_of_.end()) return {};
    const auto [known, fresh] = below_.try_emplace(product);
    if (known->second) return *known->second;
    if (!fresh)
      refusal_ = step_place(text_, places->second.front().label) +
                 ": its assemblies contain each other; export it again";
    else if (depth > kMostStepLevels)
      refusal_ = too_deep();
    Below below{0.0, 1};
    for (const Usage& usage : places->second) {
      if (!refusal_.empty()) return {};
      const Below child = below_of(usage.child, depth + 1);
      below.instances += child.instances;
      below.levels = std::max(below.levels, child.levels + 1);
    }
    if (refusal_.empty() && below.levels > kMostStepLevels) refusal_ = too_deep();
    below_[product] = below;
    return below;
  }

  static std::string too_deep() {
    return "its assemblies are nested deeper than " + std::to_string(kMostStepLevels) +
           " levels; export it with fewer";
  }

  const StepText& text_;
  std::map<int, std::vector<Usage>> places_of_;          // by the product that holds them
  std::unordered_map<int, std::optional<Below>> below_;  // nothing yet: still on the way down
  std::string refusal_;
};

Vec3 direction_of(const StepText& text, std::string_view argument, const Vec3& otherwise) {
  const auto arguments = step_arguments(text.entity(step_reference(argument)), "DIRECTION");
  if (!arguments || arguments->size() < 2) return otherwise;
  std::string_view list = arguments->back();
  if (!list.starts_with('(') || !list.ends_with(')')) return otherwise;
  list = list.substr(1, list.size() - 2);
  Vec3 v = Vec3::Zero();
  for (int i = 0; i < 3 && !list.empty(); ++i) {
    const std::size_t comma = std::min(list.find(','), list.size());
    v[i] = step_number(list.substr(0, comma)).value_or(0.0);
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return v;
}

// What an operator does beside a motion: "mirrors", "scales"; empty: nothing.
std::string beside_motion(const StepText& text, std::string_view entity) {
  // A simple entity has all arguments itself: ... axis 1, axis 2, origin, scale, axis 3. A complex
  // one has the first four in its general part.
  const auto own = step_arguments(entity, kOperator);
  if (!own || own->empty()) return {};
  auto general = step_arguments(entity, "CARTESIAN_TRANSFORMATION_OPERATOR");
  if (!general) general.emplace(own->begin(), own->end() - 1);
  if (general->size() < 4) return {};
  const auto at = [&](std::size_t from_end) { return (*general)[general->size() - from_end]; };
  if (at(1) != "$" && std::fabs(step_number(at(1)).value_or(1.0) - 1.0) > 1e-9) return "scales";
  const Vec3 z = direction_of(text, own->back(), Vec3::UnitZ());
  const Vec3 x = direction_of(text, at(4), Vec3::UnitX());
  const Vec3 y = direction_of(text, at(3), z.cross(x));
  return x.cross(y).dot(z) < 0.0 ? "mirrors" : "";
}

// Does this map show a shape, and not the sign of an annotation?
bool shows_shape(const StepText& text, int map) {
  const auto arguments = step_arguments(text.entity(map), "REPRESENTATION_MAP");
  if (!arguments || arguments->size() < 2) return false;
  const auto keywords = step_keywords(text.entity(step_reference((*arguments)[1])));
  return std::ranges::any_of(keywords, [](const std::string& keyword) {
    return keyword.ends_with("SHAPE_REPRESENTATION") && !keyword.starts_with("TESSELLATED") &&
           !keyword.starts_with("DRAUGHTING");
  });
}

// The labels of all that places a shape.
std::unordered_set<int> placing(const StepText& text) {
  std::unordered_set<int> labels;
  constexpr std::string_view kRelation = "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION";
  for (const int label : text.labels_with(kRelation))
    if (const auto arguments = step_arguments(text.entity(label), kRelation);
        arguments && !arguments->empty())
      labels.insert(step_reference(arguments->back()));
  for (const int label : text.labels_with("MAPPED_ITEM")) {
    const auto arguments = step_arguments(text.entity(label), "MAPPED_ITEM");
    if (arguments && arguments->size() >= 2 &&
        shows_shape(text, step_reference((*arguments)[arguments->size() - 2])))
      labels.insert(step_reference(arguments->back()));
  }
  return labels;
}

// Of a place in an assembly: the usages that each transformation is of, by way of the relation that
// names it and what depends on that.
std::unordered_multimap<int, int> usages_of_transformations(const StepText& text) {
  constexpr std::string_view kRelation = "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION";
  constexpr std::string_view kPlaced = "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION";
  std::unordered_multimap<int, int> usages;
  for (const int label : text.labels_with(kPlaced)) {
    const auto placed = step_arguments(text.entity(label), kPlaced);
    if (!placed || placed->size() != 2) continue;
    const auto relation = step_arguments(text.entity(step_reference((*placed)[0])), kRelation);
    const auto shape =
        step_arguments(text.entity(step_reference((*placed)[1])), "PRODUCT_DEFINITION_SHAPE");
    if (!relation || relation->empty() || !shape || shape->empty()) continue;
    const int usage = step_reference(shape->back());
    if (step_arguments(text.entity(usage), kUsage))
      usages.emplace(step_reference(relation->back()), usage);
  }
  return usages;
}

// How many relations and mapped items name this transformation?
std::size_t uses_of(const StepText& text, int label) {
  std::size_t uses = 0;
  for (const int by : text.labels_with("#" + std::to_string(label)))
    for (const int named : step_references(text.entity(by))) uses += named == label;
  return uses;
}

std::string odd_place(const StepText& text, int label, const std::string& what) {
  return step_place(text, label) + " " + what + " a part (" + std::string(kOperator) +
         "), which is not read; export such a part as one of its own";
}

/// What is wrong with operators: a refusal, or usages that can be left out alone.
struct OddPlaces {
  std::string refusal;
  std::map<int, std::string> usages;
};

OddPlaces odd_places(const StepText& text) {
  OddPlaces odd;
  const std::vector<int> operators = text.labels_with(kOperator);
  if (operators.empty()) return odd;
  const std::unordered_set<int> used = placing(text);
  std::optional<std::unordered_multimap<int, int>> usages;
  for (const int label : operators) {
    if (!used.contains(label)) continue;
    const std::string what = beside_motion(text, text.entity(label));
    if (what.empty()) continue;
    if (!usages) usages = usages_of_transformations(text);
    const auto [first, last] = usages->equal_range(label);
    const std::string why = odd_place(text, label, what);
    if (static_cast<std::size_t>(std::distance(first, last)) != uses_of(text, label)) {
      odd.refusal = why;
      return odd;
    }
    for (auto usage = first; usage != last; ++usage) odd.usages[usage->second] = why;
  }
  return odd;
}

}  // namespace

std::string step_place(const StepText& text, int label) {
  return "line " + std::to_string(text.line_of(label)) + ": #" + std::to_string(label);
}

std::string step_refusal(const StepText& text) {
  if (std::string refusal = ProductTree(text).refusal(); !refusal.empty()) return refusal;
  return odd_places(text).refusal;
}

std::map<int, std::string> step_left_out(const StepText& text) { return odd_places(text).usages; }

std::size_t step_places(const StepText& text) { return usages_of(text).size(); }

std::vector<std::string> step_crowded_points(const StepText& text) {
  for (const std::string_view kind : {"CARTESIAN_POINT", "DIRECTION"})
    for (const int label : text.labels_with(kind)) {
      const auto arguments = step_arguments(text.entity(label), kind);
      if (arguments && !arguments->empty() && std::ranges::count(arguments->back(), ',') > 2)
        return {step_place(text, label) + " " + std::string(kind) +
                " has more than three numbers; what is made of it may be wrong; export it again"};
    }
  return {};
}

std::vector<std::string> step_missing(const StepText& text) {
  const std::vector<int> labels = text.labels();
  const std::unordered_set<int> there(labels.begin(), labels.end());
  int by = 0, what = 0;  // the first
  std::size_t missing = 0;
  for (const int label : labels)
    for (const int named : step_references(text.entity(label))) {
      if (there.contains(named)) continue;
      if (missing++ == 0) by = label, what = named;
    }
  if (missing == 0) return {};
  return {step_place(text, by) + " names #" + std::to_string(what) + ", which is not in the file" +
          (missing > 1 ? " (the first of " + std::to_string(missing) + " such references)" : "") +
          "; what hangs on it is missing or in a wrong place; export it again"};
}

}  // namespace mortise
