#include "client/tools/check/check_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "client/report/cells.h"
#include "common/io/step/step_document.h"

namespace mortise {
namespace {

// The tree as it is folded up: children in the order in which they come first.
struct Node {
  std::string name;
  const TreeRow* part = nullptr;
  std::vector<Node> below;
};

void add(Node& node, const TreeRow& row, std::size_t from) {
  const std::size_t to = std::min(row.path.find('/', from), row.path.size());
  const std::string name = row.path.substr(from, to - from);
  auto found = std::find_if(node.below.begin(), node.below.end(),
                            [&](const Node& n) { return n.name == name; });
  if (found == node.below.end()) {
    node.below.push_back({name, nullptr, {}});
    found = std::prev(node.below.end());
  }
  if (to == row.path.size())
    found->part = &row;
  else
    add(*found, row, to + 1);
}

std::string list_of(const Node& node) {
  std::string html = "<ul>";
  for (const Node& n : node.below) {
    std::string line;
    if (n.part != nullptr) {
      if (!n.part->colour.empty())
        line += fmt::format("<span style=\"color:{}\">■</span> ", n.part->colour);
      line += escaped(n.name);
      if (n.part->worst != CollisionClass::kNone)
        line += fmt::format(" <b class=\"{0}\">{0}</b>", name_of(n.part->worst));
    } else {
      line = escaped(n.name);
    }
    html += n.below.empty() ? "<li>" + line + "</li>"
                            : "<li><details open><summary>" + line + "</summary>" + list_of(n) +
                                  "</details></li>";
  }
  return html + "</ul>";
}

}  // namespace

std::vector<TreeRow> tree_of(const OpenedScene& opened, const CheckReport& report) {
  std::map<PartId, CollisionClass> worst;
  for (const CheckedPair& pair : report.pairs) {
    if (pair.explained || pair.muted || pair.collision_class < CollisionClass::kPotential) continue;
    for (const auto& [a, b] : pair.all)
      for (const PartId id : {a, b}) worst[id] = std::max(worst[id], pair.collision_class);
  }
  StepDocument document;  // colours are kept in what the importer sent
  const auto& assembly = opened.scenario.assembly;
  if (assembly && assembly->sent)
    if (auto sent = decode_step(*assembly->sent)) document = std::move(*sent);
  std::vector<TreeRow> rows;
  std::size_t instance = 0;
  for (std::size_t i = 0; i < opened.scene.world.parts.size(); ++i) {
    TreeRow row;
    row.path = opened.scene.world.parts[i].name;
    row.worst = worst[opened.scene.world.parts[i].id];
    if (i < opened.scenario.parts.size() && opened.scenario.parts[i].mesh.given &&
        instance < document.instances.size()) {
      const StepInstance& of = document.instances[instance++];
      row.product = of.products;
      if (of.colour != kNoColour) row.colour = fmt::format("#{:06x}", of.colour & 0xffffffU);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Table tree_table(const std::vector<TreeRow>& rows) {
  Table table{"tree",
              "parts as the file names and colours them",
              {{"part"}, {"product"}, {"colour"}, {"worst"}},
              {}};
  for (const TreeRow& row : rows)
    table.rows.push_back({row.path, row.product, row.colour, name_of(row.worst)});
  return table;
}

std::string tree_section(const std::vector<TreeRow>& rows) {
  Node root;
  for (const TreeRow& row : rows) add(root, row, 0);
  return "<details><summary><b>Tree</b></summary>" + list_of(root) + "</details>";
}

}  // namespace mortise
