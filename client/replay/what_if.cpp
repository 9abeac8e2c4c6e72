#include "client/replay/what_if.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <optional>

#include "common/io/log/replay.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

using Row = SessionStatistics::ClashRow;

constexpr CollisionClass kClasses[] = {CollisionClass::kReal, CollisionClass::kPotential,
                                       CollisionClass::kFake};

// Ticks that two clashes have in common; a clash that has not ended goes on for ever.
std::int64_t common_ticks(const Row& x, const Row& y) {
  const auto end = [](const Row& row) {
    return row.end_tick == 0 ? std::int64_t{1} << 60 : static_cast<std::int64_t>(row.end_tick);
  };
  const auto begin = static_cast<std::int64_t>(std::max(x.begin_tick, y.begin_tick));
  return std::min(end(x), end(y)) - begin;
}

// Where both last until the end, places tell which is which.
double apart_mm(const Row& x, const Row& y) { return (x.worst.point_W - y.worst.point_W).norm(); }

// A clash of one session that may be a clash of the other.
struct Likeness {
  ClashPair pair;
  std::int64_t ticks = 0;
  double apart_mm = 0.0;
};

std::vector<Likeness> likenesses(const Clashes& before, const Clashes& after) {
  std::map<std::pair<PartId, PartId>, std::vector<std::size_t>> of_pair;
  for (std::size_t i = 0; i < before.rows.size(); ++i)
    of_pair[{before.rows[i].a, before.rows[i].b}].push_back(i);
  std::vector<Likeness> found;
  for (std::size_t j = 0; j < after.rows.size(); ++j) {
    const Row& row = after.rows[j];
    for (const std::size_t i : of_pair[{row.a, row.b}])
      if (const std::int64_t ticks = common_ticks(before.rows[i], row); ticks >= 0)
        found.push_back({{i, j}, ticks, apart_mm(before.rows[i], row)});
  }
  std::stable_sort(found.begin(), found.end(), [](const Likeness& x, const Likeness& y) {
    return x.ticks != y.ticks ? x.ticks > y.ticks : x.apart_mm < y.apart_mm;
  });
  return found;
}

CollisionClass class_of(const Clashes& clashes, std::size_t index) {
  return index == ClashPair::kNone ? CollisionClass::kNone : clashes.rows[index].worst_class;
}

Json json_of(const Clashes& clashes, std::size_t index) {
  if (index == ClashPair::kNone) return nullptr;
  const Row& row = clashes.rows[index];
  return {{"class", name_of(row.worst_class)},
          {"clash", row.clash.value},
          {"begin_tick", row.begin_tick},
          {"end_tick", row.end_tick == 0 ? Json(nullptr) : Json(row.end_tick)},
          {"verdict", json_of(row.worst)}};
}

std::string counted(const Clashes& clashes) {
  const auto count = by_class(clashes);
  std::string text;
  for (const CollisionClass c : kClasses)
    text += (text.empty() ? "" : ", ") + std::to_string(count[static_cast<std::size_t>(c)]) + " " +
            std::string(name_of(c));
  return text;
}

std::string told(const Clashes& clashes, std::size_t index) {
  if (index == ClashPair::kNone) return "no clash";
  const Row& row = clashes.rows[index];
  char since[48];
  std::snprintf(since, sizeof since, " (from %.2f s)",
                static_cast<double>(row.begin_tick) / clashes.tick_rate_hz);
  return std::string(name_of(row.worst_class)) + since + ": " + row.worst.explanation;
}

std::string pair_name(const ClashPair& pair, const Clashes& before, const Clashes& after) {
  const Row& row =
      pair.after != ClashPair::kNone ? after.rows[pair.after] : before.rows[pair.before];
  return before.names.pair(row.a, row.b);
}

}  // namespace

std::array<std::uint64_t, 4> by_class(const Clashes& clashes) {
  std::array<std::uint64_t, 4> count{};
  for (const Row& row : clashes.rows) ++count[static_cast<std::size_t>(row.worst_class)];
  return count;
}

std::vector<ClashPair> changed_clashes(const Clashes& before, const Clashes& after) {
  std::vector<ClashPair> pairs = matched(before, after);
  std::erase_if(pairs, [&](const ClashPair& pair) {
    return class_of(before, pair.before) == class_of(after, pair.after);
  });
  // What matters most first; the order of the session within.
  std::stable_sort(pairs.begin(), pairs.end(), [&](const ClashPair& x, const ClashPair& y) {
    const auto weight = [&](const ClashPair& p) {
      return std::max(class_of(before, p.before), class_of(after, p.after));
    };
    return weight(x) > weight(y);
  });
  return pairs;
}

namespace {

// The scene with which a changed session begins. A log with another mesh is a copy, kept in `own`.
Result<LoadedScene> changed_scene(const SessionLog& log, const std::vector<Change>& changes,
                                  std::optional<SessionLog>& own) {
  if (log.begin && !changes.empty())
    return fail(Code::kInvalidInput,
                "the log goes on from " + log.chain.previous +
                    ", and what would have been before cannot be known from it: give the first "
                    "file of the session");
  for (const Change& change : changes) {
    if (change.kind != Change::Kind::kMesh) continue;
    if (!own) own = log;
    if (const Status status = change_log(*own, change); !status) return status.error();
  }
  auto scene = scene_of(own ? *own : log);
  if (!scene) return scene.error();
  for (const Change& change : changes)
    if (const Status status = change_world(scene->world, change); !status) return status.error();
  return scene;
}

}  // namespace

Status check_changes(const SessionLog& log, const std::vector<Change>& changes) {
  std::optional<SessionLog> own;
  const auto scene = changed_scene(log, changes, own);
  return scene ? ok() : Status(scene.error());
}

Result<Clashes> clashes_with(const SessionLog& log, const std::vector<Change>& changes) {
  std::optional<SessionLog> own;
  auto scene = changed_scene(log, changes, own);
  if (!scene) return scene.error();
  World& world = scene->world;
  SessionStatistics statistics;
  const auto done = recompute(world, own ? *own : log, 1,
                              [&](const ReplayedTick& tick) { statistics.add(tick.computed); });
  if (!done) return done.error();
  std::vector<Row> rows;
  for (const auto& [id, row] : statistics.clashes()) rows.push_back(row);
  return Clashes{std::move(rows),
                 names_of(world),
                 world.tick_rate_hz,
                 done->ticks,
                 statistics.counters().not_examined,
                 done->stopped_early};
}

std::vector<ClashPair> matched(const Clashes& before, const Clashes& after) {
  std::vector<std::size_t> of_after(after.rows.size(), ClashPair::kNone);
  std::vector<bool> taken(before.rows.size(), false);
  for (const Likeness& like : likenesses(before, after)) {
    if (taken[like.pair.before] || of_after[like.pair.after] != ClashPair::kNone) continue;
    taken[like.pair.before] = true;
    of_after[like.pair.after] = like.pair.before;
  }
  std::vector<ClashPair> pairs;
  for (std::size_t j = 0; j < of_after.size(); ++j) pairs.push_back({of_after[j], j});
  for (std::size_t i = 0; i < taken.size(); ++i)
    if (!taken[i]) pairs.push_back({i, ClashPair::kNone});
  return pairs;
}

Json json_of(const Variant& variant, const Clashes& before) {
  Json document = {{"index", variant.index}, {"changes", variant.changes}};
  if (!variant.error.empty()) {
    document["error"] = variant.error;
    return document;
  }
  const Clashes& after = variant.clashes;
  const auto count = by_class(after);
  for (const CollisionClass c : kClasses)
    document["clashes"][std::string(name_of(c))] = count[static_cast<std::size_t>(c)];
  document["ticks"] = after.ticks;
  document["not_examined"] = after.not_examined;
  document["stopped_early"] = after.stopped_early;
  document["changed"] = Json::array();
  for (const ClashPair& pair : changed_clashes(before, after))
    document["changed"].push_back({{"pair", pair_name(pair, before, after)},
                                   {"before", json_of(before, pair.before)},
                                   {"after", json_of(after, pair.after)}});
  return document;
}

std::string text_of(const Variant& variant, const Clashes& before) {
  std::string text;
  for (const std::string& change : variant.changes) text += "with " + change + "\n";
  if (!variant.error.empty()) return text + "  no answer: " + variant.error + "\n";
  const Clashes& after = variant.clashes;
  text += "  clashes: " + counted(after) + "; before: " + counted(before) + "\n";
  if (after.not_examined > 0)
    text += "  " + std::to_string(after.not_examined) +
            " pairs of a tick were not examined to the end\n";
  if (!after.stopped_early.empty()) text += "  computed in part: " + after.stopped_early + "\n";
  const auto pairs = changed_clashes(before, after);
  if (pairs.empty()) text += "  no clash has another class\n";
  for (const ClashPair& pair : pairs)
    text += "  " + pair_name(pair, before, after) + "\n    was " + told(before, pair.before) +
            "\n    is  " + told(after, pair.after) + "\n";
  return text;
}

}  // namespace mortise
