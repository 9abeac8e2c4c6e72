#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace mortise {

/// The entities of a STEP file (ISO 10303-21) as text, for what the reader of the library does not
/// understand: measures that are complex entities, modifiers, tolerances of kinds that it has not.
/// Nothing is trusted: damage ends the search for entities and no more.
class StepText {
 public:
  explicit StepText(std::string text);

  /// "POSITION_TOLERANCE('a','',#1,#2)" of #label, or empty. Points into this object.
  std::string_view entity(int label) const;
  /// The labels of all entities that contain this text, ascending.
  std::vector<int> labels_with(std::string_view text) const;
  /// The labels of all entities, ascending.
  std::vector<int> labels() const { return labels_with({}); }
  /// The line of the file in which this entity begins, from 1; 0: there is no such entity.
  std::size_t line_of(int label) const;

 private:
  std::string text_;
  std::unordered_map<int, std::pair<std::size_t, std::size_t>> place_of_;  // begin, length
};

/// The keywords of an entity: one of a simple, several of a complex one.
std::vector<std::string> step_keywords(std::string_view entity);

/// The arguments of this keyword in an entity, as text without blanks at their ends; nothing when
/// the entity has no such keyword.
std::optional<std::vector<std::string_view>> step_arguments(std::string_view entity,
                                                            std::string_view keyword);

/// The labels that an entity names, in its order.
std::vector<int> step_references(std::string_view entity);

/// "#12" as 12; 0 when it is no reference.
int step_reference(std::string_view argument);

/// "0.2", or the number of a typed one: "LENGTH_MEASURE(0.2)".
std::optional<double> step_number(std::string_view argument);

}  // namespace mortise
