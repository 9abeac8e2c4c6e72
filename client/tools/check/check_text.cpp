#include "client/tools/check/check_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "client/tools/check/check_tree.h"
#include "common/evaluation/tolerance.h"
#include "common/messages/length_text.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

constexpr double kTellsDepth = 2.0;  // an upper end beyond so many times the lower says nothing

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

// The last pieces of each path that no other part ends with.
std::vector<std::string> short_names(const World& world) {
  std::map<std::string, std::size_t> ends;
  const auto for_ends = [](const std::string& path, auto visit) {
    for (std::size_t at = path.rfind('/'); at != std::string::npos && at > 0;
         at = path.rfind('/', at - 1))
      if (!visit(path.substr(at + 1))) return;
    visit(path);
  };
  for (const Part& part : world.parts)
    for_ends(part.name, [&](const std::string& end) {
      ++ends[end];
      return true;
    });
  std::vector<std::string> names;
  for (const Part& part : world.parts) {
    names.push_back(part.name);
    for_ends(part.name, [&](const std::string& end) {
      if (ends[end] > 1) return true;
      names.back() = end;
      return false;
    });
  }
  return names;
}

class TextWriter {
 public:
  TextWriter(const OpenedScene& opened, const CheckReport& report, CheckTextStyle style)
      : opened_(opened),
        world_(opened.scene.world),
        report_(report),
        style_(style),
        names_(short_names(world_)) {}

  std::string run() {
    head();
    section("Real clashes that nothing explains", 31, [](const CheckedPair& p) {
      return p.collision_class == CollisionClass::kReal && !p.explained && !p.muted;
    });
    section("Potential clashes", 33, [](const CheckedPair& p) {
      return p.collision_class == CollisionClass::kPotential && !p.explained && !p.muted;
    });
    explained();
    contacts();
    near();
    not_judged();
    statements();
    for (const std::string& note : report_.notes) text_ += "note: " + note + "\n";
    return std::move(text_);
  }

 private:
  const std::string& name(PartId id) const { return names_[id.value - 1]; }

  std::string title(const std::string& text, int code) const {
    return style_.color ? fmt::format("\n\033[{};1m{}\033[0m\n", code, text) : "\n" + text + "\n";
  }

  void head() {
    const CheckCounts& c = report_.counts;
    text_ = fmt::format(
        "{}: {} of {} distinct products; {} near each other\n"
        "{} unexplained real, {} explained real, {} potential, {} contacts, {} fake",
        opened_.scenario.file, counted(report_.parts, "part", "parts"), report_.products,
        counted(report_.candidate_pairs, "pair", "pairs"), c.unexplained_real, c.explained_real,
        c.potential, c.contacts, c.fake);
    if (c.explained_potential > 0)
      text_ += fmt::format(", {} explained potential", c.explained_potential);
    if (report_.asks_gaps) text_ += fmt::format(", {} too near", c.near);
    text_ += fmt::format(", {} not judged", c.not_judged);
    if (c.muted > 0) text_ += fmt::format(", {} muted inside of what is bought", c.muted);
    text_ += "\n";
  }

  std::string face(PartId id, const std::string& face) const {
    const Part& part = *world_.find(id);
    if (face.empty()) return {};
    for (const Feature& feature : part.features)
      if (feature.name == face && feature.surface.radius_mm > 0.0)
        return "." + face + " Ø" + size_text(2.0 * feature.surface.radius_mm);
    return "." + face;
  }

  std::string times(const CheckedPair& pair) const {
    std::string text;
    if (pair.all.size() > 1) text = fmt::format("  ×{}", pair.all.size());
    if (!pair.inside.empty()) text += (text.empty() ? "  " : ", ") + ("inside " + pair.inside);
    return text;
  }

  std::string way_out(const CheckedPair& pair, const Verdict& v) const {
    if (v.separation_way == SeparationWay::kNone || !(v.gpd_mm.hi > 0.0)) return {};
    const Vec3& shift = v.separation_translation_mm;
    if (!(shift.norm() > 0.0)) return {};
    const Vec3 n = shift.normalized();
    return fmt::format("{} moved {} towards ({:.2f}, {:.2f}, {:.2f})", name(pair.a),
                       length_text(shift.norm()), n.x(), n.y(), n.z());
  }

  void pair_lines(const CheckedPair& pair) {
    const Verdict& v = pair.verdicts.front();
    text_ += fmt::format("  {} × {}{}\n", name(pair.a), name(pair.b), times(pair));
    // Once the class is decided the upper end is left as it is.
    if (v.delta_mm.lo > 0.0 && v.delta_mm.hi > kTellsDepth * v.delta_mm.lo)
      text_ += fmt::format("      at least {} deep", length_text(v.delta_mm.lo));
    else if (v.delta_mm.lo > 0.0)
      text_ += fmt::format("      {} deep", range_text(v.delta_mm));
    else
      text_ += fmt::format("      {} apart", length_text(std::max(0.0, -v.delta_mm.hi)));
    if (pair.common_mm3 >= 0.0)
      text_ += fmt::format(", {:.3f} mm³ in common, {} thick", pair.common_mm3,
                           length_text(pair.thickness_mm));
    if (pair.verdicts.size() > 1) text_ += fmt::format(", {} places", pair.verdicts.size());
    const std::string faces = face(pair.a, v.face_a) + " / " + face(pair.b, v.face_b);
    if (faces.size() > 3) text_ += ", " + faces;
    text_ += "\n      " + v.explanation + "\n";
    const Vec3& at = v.point_W;
    text_ += fmt::format("      at ({:.3f}, {:.3f}, {:.3f}) mm", at.x(), at.y(), at.z());
    if (const std::string way = way_out(pair, v); !way.empty()) text_ += "; " + way;
    text_ += "\n";
    if (pair.mating.relation != MatingKind::kUnknown)
      text_ += fmt::format("      relation: {}{}\n", name_of(pair.mating.relation),
                           pair.mating.text.empty() ? "" : ", " + pair.mating.text);
    if (!pair.reason.empty()) text_ += "      " + pair.reason + "\n";
  }

  template <class Belongs>
  void section(const char* what, int code, Belongs belongs) {
    bool first = true;
    for (const CheckedPair& pair : report_.pairs) {
      if (!belongs(pair)) continue;
      if (first) text_ += title(what, code);
      first = false;
      pair_lines(pair);
    }
  }

  void explained() {
    std::map<std::string, std::vector<const CheckedPair*>> by_reason;
    for (const CheckedPair& pair : report_.pairs)
      if (pair.explained && !pair.muted)
        by_reason[std::string(name_of(pair.mating.relation))].push_back(&pair);
    if (by_reason.empty()) return;
    text_ += title("Explained overlaps", 34);
    for (const auto& [reason, pairs] : by_reason) {
      std::size_t count = 0;
      for (const CheckedPair* pair : pairs) count += pair->all.size();
      text_ += fmt::format("  {} ({}); --no-explain '{}' lists them as clashes\n", reason,
                           counted(count, "pair", "pairs"), reason);
      for (const CheckedPair* pair : pairs)
        text_ += fmt::format("      {} × {}{}: {}: {}\n", name(pair->a), name(pair->b),
                             times(*pair), class_word(*pair), pair->reason);
    }
  }

  void contacts() {
    std::map<std::string, std::size_t> counts;
    std::string list;
    for (const CheckedPair& pair : report_.pairs) {
      if (pair.collision_class != CollisionClass::kFake || pair.muted) continue;
      const std::string what =
          pair.is_contact ? fmt::format("{}{}", name_of(pair.mating.relation),
                                        pair.mating.text.empty() ? "" : ": " + pair.mating.text)
                          : std::string("meshes overlap, the surfaces are apart");
      counts[what] += pair.all.size();
      if (style_.verbose)
        list += fmt::format("      {} × {}{}: {}\n", name(pair.a), name(pair.b), times(pair), what);
    }
    if (counts.empty()) return;
    text_ += title("Contacts and false alarms", 34);
    for (const auto& [what, count] : counts)
      text_ += fmt::format("  {}: {}\n", counted(count, "pair", "pairs"), what);
    text_ += list;
  }

  void near() {
    if (!report_.asks_gaps) return;
    text_ += title("Nearer than required", 33);
    if (report_.near.empty()) text_ += "  none\n";
    for (const NearPair& pair : report_.near)
      text_ += fmt::format("  {} × {}: {} to {}, {} required\n", name(pair.a), name(pair.b),
                           length_text(pair.gap_mm.lo), length_text(pair.gap_mm.hi),
                           length_text(pair.required_mm));
  }

  void not_judged() {
    if (report_.not_judged.empty()) return;
    text_ += title("Not judged", 33);
    constexpr std::size_t kMost = 10;  // chosen: what clashes stays in sight
    for (std::size_t i = 0; i < report_.not_judged.size(); ++i) {
      if (!style_.verbose && i == kMost) {
        text_ +=
            fmt::format("  ... and {} more; -v lists all\n", report_.not_judged.size() - kMost);
        break;
      }
      text_ += "  " + report_.not_judged[i] + "\n";
    }
  }

  void statements() {
    if (!opened_.scenario.assembly || opened_.scenario.assembly->listed.empty()) return;
    std::map<std::string, std::size_t> why;
    std::size_t used = 0;
    std::string list;
    for (const auto& listed : opened_.scenario.assembly->listed) {
      used += listed.used;
      if (!listed.used) ++why[listed.reason];
      list += fmt::format("      {}: {}\n", listed.text, listed.used ? "used" : listed.reason);
    }
    text_ += title("Tolerances that the file states", 34);
    text_ += fmt::format("  {} used\n", used);
    for (const auto& [reason, count] : why)
      text_ += fmt::format("  {} not used: {}\n", count, reason);
    if (style_.verbose) text_ += list;
  }

  const OpenedScene& opened_;
  const World& world_;
  const CheckReport& report_;
  CheckTextStyle style_;
  std::vector<std::string> names_;
  std::string text_;
};

Json tree_json(const OpenedScene& opened, const CheckReport& report) {
  Json tree = Json::array();
  for (const TreeRow& row : tree_of(opened, report))
    tree.push_back({{"part", row.path},
                    {"product", row.product},
                    {"colour", row.colour.empty() ? Json(nullptr) : Json(row.colour)},
                    {"worst", name_of(row.worst)}});
  return tree;
}

Json number_or_null(double x, bool known) { return known ? Json(x) : Json(nullptr); }

Json json_of(const CheckedPair& pair, const SessionNames& names) {
  Json entry;
  entry["a"] = names.part(pair.a);
  entry["b"] = names.part(pair.b);
  entry["class"] = name_of(pair.collision_class);
  entry["contact"] = pair.is_contact;
  entry["relation"] = name_of(pair.mating.relation);
  entry["relation_text"] = pair.mating.text;
  entry["explained"] = pair.explained;
  entry["reason"] = pair.reason;
  entry["count"] = pair.all.size();
  entry["inside"] = pair.inside;
  entry["muted"] = pair.muted;
  entry["accuracy_mm"] = pair.accuracy_mm;
  entry["common_mm3"] = number_or_null(pair.common_mm3, pair.common_mm3 >= 0.0);
  entry["thickness_mm"] = number_or_null(pair.thickness_mm, pair.common_mm3 >= 0.0);
  entry["explained_mm3"] = pair.mating.explained_mm3;
  entry["instances"] = Json::array();
  for (const auto& [a, b] : pair.all)
    entry["instances"].push_back(Json::array({names.part(a), names.part(b)}));
  entry["verdicts"] = Json::array();
  for (const Verdict& verdict : pair.verdicts) {
    entry["verdicts"].push_back(json_of(verdict));
    if (verdict.separation_blocker)
      entry["verdicts"].back()["separation"]["blocker"] = names.part(verdict.separation_blocker);
  }
  return entry;
}

}  // namespace

std::string class_word(const CheckedPair& pair) {
  return pair.is_contact ? "contact" : std::string(name_of(pair.collision_class));
}

std::string check_text(const OpenedScene& opened, const CheckReport& report, CheckTextStyle style) {
  return TextWriter(opened, report, style).run();
}

Json check_json(const OpenedScene& opened, const CheckReport& report) {
  const SessionNames names = names_of(opened.scene.world);
  const CheckCounts& c = report.counts;
  Json json;
  json["counts"] = {{"unexplained_real", c.unexplained_real},
                    {"explained_real", c.explained_real},
                    {"potential", c.potential},
                    {"fake", c.fake},
                    {"contacts", c.contacts},
                    {"near", c.near},
                    {"not_judged", c.not_judged},
                    {"explained_potential", c.explained_potential},
                    {"muted", c.muted}};
  json["schema"] = "mortise/check/1";
  json["file"] = opened.scenario.file;
  json["parts"] = report.parts;
  json["products"] = report.products;
  json["candidate_pairs"] = report.candidate_pairs;
  json["tree"] = tree_json(opened, report);
  json["pairs"] = Json::array();
  for (const CheckedPair& pair : report.pairs) json["pairs"].push_back(json_of(pair, names));
  json["min_gap_mm"] = report.min_gap_mm;
  json["near"] = Json::array();
  for (const NearPair& near : report.near)
    json["near"].push_back({{"a", names.part(near.a)},
                            {"b", names.part(near.b)},
                            {"gap_mm", json_of(near.gap_mm)},
                            {"required_mm", near.required_mm}});
  json["not_judged"] = report.not_judged;
  json["statements"] = Json::array();
  if (opened.scenario.assembly)
    for (const auto& listed : opened.scenario.assembly->listed)
      json["statements"].push_back(
          {{"text", listed.text}, {"used", listed.used}, {"reason", listed.reason}});
  json["notes"] = report.notes;
  return json;
}

}  // namespace mortise
