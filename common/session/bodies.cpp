#include "common/session/bodies.h"

#include <algorithm>

namespace mortise {
namespace {

Vec3 reference_of(const Part& part) { return part.X_WP * part.solid->sphere().center_mm; }

}  // namespace

Body body_of(const World& world, std::uint32_t index) {
  Body body;
  const GroupId group = world.parts[index].group;
  if (!group) {
    const Part& part = world.parts[index];
    return {{index}, reference_of(part), part.solid->sphere().radius_mm};
  }
  for (std::uint32_t i = 0; i < world.parts.size(); ++i)
    if (world.parts[i].group == group) body.parts.push_back(i);
  for (const std::uint32_t i : body.parts) body.reference_W += reference_of(world.parts[i]);
  body.reference_W /= static_cast<double>(body.parts.size());
  for (const std::uint32_t i : body.parts) {
    const Part& part = world.parts[i];
    body.radius_mm = std::max(body.radius_mm, (reference_of(part) - body.reference_W).norm() +
                                                  part.solid->sphere().radius_mm);
  }
  return body;
}

std::vector<Relation> relations_of(const World& world, const Body& body) {
  std::vector<Relation> relations;
  const auto within = [&](PartId part) {
    return std::binary_search(body.parts.begin(), body.parts.end(), part.value - 1);
  };
  for (const Guide& guide : world.guides) {
    const PartId held = guide.constraint.held.part, other = guide.constraint.other.part;
    if (!within(held) || within(other)) continue;
    Relation relation = guide.relation;
    relation.a = moved(relation.a, world.find(held)->X_WP);
    relation.b = moved(relation.b, world.find(other)->X_WP);
    relations.push_back(relation);
  }
  return relations;
}

}  // namespace mortise
