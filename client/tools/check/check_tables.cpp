#include "client/tools/check/check_tables.h"

#include <fmt/format.h>

#include <algorithm>

#include "client/picture/picture.h"
#include "client/report/cells.h"
#include "client/report/html_page.h"
#include "client/report/html_sections.h"
#include "client/tools/check/check_text.h"
#include "client/tools/check/check_tree.h"
#include "common/messages/length_text.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

using Type = Table::Type;

// Bounds the page; the worst come first.
constexpr std::size_t kMostPictures = 20;

Json known(double x, bool is_known) { return is_known ? Json(x) : Json(nullptr); }

Table clash_table(const OpenedScene& opened, const CheckReport& report) {
  const SessionNames names = names_of(opened.scene.world);
  Table table{"clashes",
              "pairs of parts, in the order in which they are read",
              {{"part_a"},
               {"part_b"},
               {"class"},
               {"relation"},
               {"explained"},
               {"count", Type::kInteger},
               {"inside"},
               {"muted"},
               {"face_a"},
               {"face_b"},
               {"depth_lo_mm", Type::kNumber},
               {"depth_hi_mm", Type::kNumber},
               {"common_mm3", Type::kNumber},
               {"explained_mm3", Type::kNumber},
               {"thickness_mm", Type::kNumber},
               {"x_mm", Type::kNumber},
               {"y_mm", Type::kNumber},
               {"z_mm", Type::kNumber},
               {"relation_text"},
               {"reason"},
               {"explanation"}},
              {}};
  for (const CheckedPair& pair : report.pairs) {
    const Verdict v = pair.verdicts.empty() ? Verdict() : pair.verdicts.front();
    const bool has_volume = pair.common_mm3 >= 0.0;
    table.rows.push_back({names.part(pair.a),
                          names.part(pair.b),
                          class_word(pair),
                          name_of(pair.mating.relation),
                          pair.explained ? "yes" : "no",
                          pair.all.size(),
                          pair.inside,
                          pair.muted ? "yes" : "no",
                          v.face_a,
                          v.face_b,
                          v.delta_mm.lo,
                          v.delta_mm.hi,
                          known(pair.common_mm3, has_volume),
                          pair.mating.explained_mm3,
                          known(pair.thickness_mm, has_volume),
                          v.point_W.x(),
                          v.point_W.y(),
                          v.point_W.z(),
                          pair.mating.text,
                          pair.reason,
                          v.explanation});
  }
  return table;
}

// The same for people, as wide as a sheet of paper: what belongs together is one cell of some
// lines.
Table pairs_to_read(const OpenedScene& opened, const CheckReport& report) {
  const SessionNames names = names_of(opened.scene.world);
  Table table{
      "pairs",
      "in the order in which they are read; the other forms of the report have every figure",
      {{"pair"}, {"class"}, {"relation"}, {"depth"}, {"in common"}, {"deepest at, mm"}, {"why"}},
      {}};
  const auto line = [](const std::string& text) { return text.empty() ? "" : "\n" + text; };
  for (const CheckedPair& pair : report.pairs) {
    const Verdict v = pair.verdicts.empty() ? Verdict() : pair.verdicts.front();
    const auto part = [&](PartId id, const std::string& face) {
      return names.part(id) + (face.empty() ? "" : " · " + face);
    };
    const bool has_depth = !reads_as_zero(v.delta_mm.hi);
    std::string common;
    if (pair.common_mm3 >= 0.0)
      common = fmt::format("{:.6g} mm³\n{:.6g} explained\n{} thick", pair.common_mm3,
                           pair.mating.explained_mm3, length_text(pair.thickness_mm));
    table.rows.push_back(
        {part(pair.a, v.face_a) + "\n" + part(pair.b, v.face_b) +
             (pair.all.size() > 1 ? fmt::format("\n×{}", pair.all.size()) : "") +
             line(pair.inside) + (pair.muted ? "\nmuted" : ""),
         (pair.explained ? "explained " : "") + class_word(pair),
         std::string(name_of(pair.mating.relation)) + line(pair.mating.text),
         has_depth ? range_text(v.delta_mm) : "", common,
         has_depth
             ? fmt::format("{:.2f}\n{:.2f}\n{:.2f}", v.point_W.x(), v.point_W.y(), v.point_W.z())
             : "",
         pair.reason + (pair.reason.empty() ? v.explanation : line(v.explanation))});
  }
  return table;
}

std::string picture_of(const OpenedScene& opened, const CheckedPair& pair) {
  const auto drawn = region_picture({&opened.scene.world, pair.a, pair.b, &pair.verdicts.front()},
                                    Canvas::Format::kSvg);
  return drawn ? *drawn : "";
}

std::string clash_section(const OpenedScene& opened, const CheckReport& report) {
  const SessionNames names = names_of(opened.scene.world);
  std::string html;
  std::size_t pictures = 0;
  for (const CheckedPair& pair : report.pairs) {
    if (pair.explained || pair.muted || pair.collision_class < CollisionClass::kPotential) continue;
    const Verdict& v = pair.verdicts.front();
    const std::string klass = class_word(pair);
    html += fmt::format(
        "<figure><figcaption><b class=\"{0}\">{0}</b> {1} × {2}{3}<br>{4}<br>relation: {5} {6} "
        "{7}</figcaption>",
        klass, escaped(names.part(pair.a)), escaped(names.part(pair.b)),
        pair.all.size() > 1 ? fmt::format(" ×{}", pair.all.size()) : "", escaped(v.explanation),
        name_of(pair.mating.relation), escaped(pair.mating.text), escaped(pair.reason));
    if (pictures++ < kMostPictures) html += picture_of(opened, pair);
    html += "</figure>";
  }
  if (pictures > kMostPictures)
    html +=
        fmt::format("<p class=\"dim\">{} more without a picture.</p>", pictures - kMostPictures);
  return html.empty() ? "<p>None.</p>" : html;
}

}  // namespace

std::vector<Table> check_tables(const OpenedScene& opened, const CheckReport& report) {
  const SessionNames names = names_of(opened.scene.world);
  std::vector<Table> tables{clash_table(opened, report)};
  Table near{"near",
             "pairs that are nearer than asked",
             {{"part_a"},
              {"part_b"},
              {"gap_lo_mm", Type::kNumber},
              {"gap_hi_mm", Type::kNumber},
              {"required_mm", Type::kNumber}},
             {}};
  for (const NearPair& pair : report.near)
    near.rows.push_back(
        {names.part(pair.a), names.part(pair.b), pair.gap_mm.lo, pair.gap_mm.hi, pair.required_mm});
  Table bodies{"not_judged", "what could not be judged, and why", {{"what"}}, {}};
  for (const std::string& what : report.not_judged) bodies.rows.push_back({what});
  Table statements{"statements",
                   "tolerances that the file itself states",
                   {{"statement"}, {"used"}, {"reason"}},
                   {}};
  if (opened.scenario.assembly)
    for (const auto& listed : opened.scenario.assembly->listed)
      statements.rows.push_back({listed.text, listed.used ? "yes" : "no", listed.reason});
  Table counts{"counts", "pairs by what they are", {{"what"}, {"count", Type::kInteger}}, {}};
  const Json summary = check_json(opened, report).at("counts");
  for (const auto& [what, count] : summary.items()) counts.rows.push_back({what, count});
  Table tree = tree_table(tree_of(opened, report));
  for (Table* table : {&near, &bodies, &statements, &counts, &tree})
    tables.push_back(std::move(*table));
  return tables;
}

std::string check_page(const OpenedScene& opened, const CheckReport& report) {
  const std::vector<Table> tables = check_tables(opened, report);
  std::string html =
      page_begin(opened.scenario.file) +
      fmt::format(
          "<p class=\"dim\">{} parts of {} distinct products; {} pairs near each other</p><div "
          "class=\"cards\">",
          report.parts, report.products, report.candidate_pairs);
  for (const auto& row : table_named(tables, "counts").rows) {
    std::string name = row[0].get<std::string>();
    std::replace(name.begin(), name.end(), '_', ' ');
    html += fmt::format("<div class=\"card\"><b>{}</b>{}</div>", row[1].get<std::size_t>(), name);
  }
  html += "</div><h2>Clashes that nothing explains</h2>" + clash_section(opened, report);
  html += tree_section(tree_of(opened, report));
  html += plain_table(pairs_to_read(opened, report), "All pairs");
  html += plain_table(table_named(tables, "near"), "Nearer than asked");
  html += plain_table(table_named(tables, "not_judged"), "Not judged");
  html += plain_table(table_named(tables, "statements"), "Tolerances that the file states");
  return html + page_end();
}

BcfProject check_bcf(const OpenedScene& opened, const CheckReport& report,
                     const std::string& date) {
  const SessionNames names = names_of(opened.scene.world);
  BcfProject project;
  project.id = "check " + opened.scenario.name;
  project.name = opened.scenario.name;
  project.statuses = {"new"};
  project.labels = {"real", "potential"};
  for (const CheckedPair& pair : report.pairs) {
    if (pair.explained || pair.muted || pair.collision_class < CollisionClass::kPotential) continue;
    const Verdict& v = pair.verdicts.front();
    const std::string klass(name_of(pair.collision_class));
    BcfTopic topic;
    topic.parts = {names.part(pair.a), names.part(pair.b)};
    topic.name = project.id + "/" + topic.parts[0] + "/" + topic.parts[1];
    topic.number = std::to_string(project.topics.size() + 1);
    topic.status = "new";
    topic.title = klass + ": " + topic.parts[0] + " × " + topic.parts[1] +
                  (pair.all.size() > 1 ? fmt::format(" (×{})", pair.all.size()) : "");
    topic.priority = bcf_priority(klass);
    topic.label = klass;
    topic.date = date;
    topic.description = v.explanation + (pair.reason.empty() ? "" : "; " + pair.reason);
    topic.point_W = v.point_W;
    topic.normal_W = v.normal_W;
    topic.size_mm = std::min(opened.scene.world.find(pair.a)->solid->sphere().radius_mm,
                             opened.scene.world.find(pair.b)->solid->sphere().radius_mm);
    if (project.topics.size() < kMostPictures) {
      const auto drawn =
          region_picture({&opened.scene.world, pair.a, pair.b, &v}, Canvas::Format::kPng);
      if (drawn) topic.png = *drawn;
    }
    project.topics.push_back(std::move(topic));
  }
  return project;
}

std::string check_junit(const OpenedScene& opened, const CheckReport& report) {
  const SessionNames names = names_of(opened.scene.world);
  std::string cases;
  std::size_t tests = 1, failures = 0;
  for (const CheckedPair& pair : report.pairs) {
    if (pair.muted || pair.collision_class < CollisionClass::kPotential) continue;
    ++tests;
    const bool failed = pair.collision_class == CollisionClass::kReal && !pair.explained;
    failures += failed;
    cases += fmt::format("  <testcase classname=\"{}\" name=\"{}\"", escaped(opened.scenario.name),
                         escaped(names.pair(pair.a, pair.b)));
    const std::string said = escaped(pair.verdicts.front().explanation);
    if (failed)
      cases += fmt::format("><failure message=\"real clash\">{}</failure></testcase>\n", said);
    else
      cases += fmt::format("><system-out>{}</system-out></testcase>\n", said);
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{0}\" tests=\"{1}\" "
      "failures=\"{2}\">\n  <testcase classname=\"{0}\" name=\"the assembly was judged\"/>\n{3}"
      "</testsuite>\n",
      escaped(opened.scenario.name), tests, failures, cases);
}

}  // namespace mortise
