#include "client/web/recording_timeline.h"

#include <algorithm>
#include <utility>

#include "common/io/log/log_series.h"
#include "common/messages/names.h"

namespace mortise::web {
namespace {

// Of all clashes together, the worst first: about 1 MB.
constexpr std::size_t kMostPieces = 20000;
// As many as can be told apart.
constexpr std::size_t kMostColumns = 390;

Json marks_of(const Recording& recording) {
  Json marks = Json::array();
  for (const ClashEvent& event : recording.events) {
    if (event.kind != ClashEvent::Kind::kBegin && event.kind != ClashEvent::Kind::kEnd) continue;
    marks.push_back(
        {{"tick", event.tick},
         {"kind", name_of(event.kind)},
         {"clash", event.clash.value},
         {"class", name_of(event.kind == ClashEvent::Kind::kEnd ? event.worst_class
                                                                : event.verdict.collision_class)},
         {"a", event.part_a.value},
         {"b", event.part_b.value}});
  }
  return marks;
}

Json json_of(const DepthPiece& piece) {
  return Json::array({piece.from, piece.to, piece.klass, piece.least_mm, piece.most_mm,
                      piece.fake_below_mm, piece.real_above_mm});
}

Json depths_of(const Recording& recording) {
  DepthSeries series;
  std::map<std::uint64_t, const ClashEvent*> last;
  for (const ClashEvent& event : recording.events) {
    const Verdict& v = event.verdict;
    last[event.clash.value] = &event;
    add_event(
        series, event.clash.value, name_of(event.kind),
        {static_cast<double>(event.tick), static_cast<double>(recording.last_tick), v.delta_mm.lo,
         v.delta_mm.hi, v.fake_below_mm, v.real_above_mm, std::string(name_of(v.collision_class))});
  }
  std::vector<const ClashEvent*> worst_first;
  for (const auto& [clash, event] : last) worst_first.push_back(event);
  std::stable_sort(worst_first.begin(), worst_first.end(), [](const auto* a, const auto* b) {
    return std::pair(a->worst_class, a->worst_delta_mm.lo) >
           std::pair(b->worst_class, b->worst_delta_mm.lo);
  });
  Json depths = Json::array();
  std::size_t room = kMostPieces;
  for (const ClashEvent* event : worst_first) {
    const auto& pieces = series[event->clash.value];
    if (pieces.empty() || pieces.size() > room) continue;
    room -= pieces.size();
    Json json{{"clash", event->clash.value},
              {"a", event->part_a.value},
              {"b", event->part_b.value},
              {"top", largest_mm(pieces)},
              {"pieces", Json::array()}};
    for (const DepthPiece& piece : pieces) json["pieces"].push_back(json_of(piece));
    depths.push_back(std::move(json));
  }
  return depths;
}

Json tick_times_of(const Recording& recording) {
  std::vector<TimeColumn> columns;
  for (const log_json::TickTimes& times : recording.tick_times)
    columns.push_back({static_cast<double>(times.first_tick), static_cast<double>(times.last_tick),
                       static_cast<double>(times.ticks), times.sum_us, times.max_us});
  Json json = Json::array();
  for (const TimeColumn& column : joined_columns(columns, kMostColumns))
    json.push_back(Json::array({column.from, column.to, column.mean_us(), column.max_us}));
  return json;
}

}  // namespace

Json timeline_of(const Recording& recording) {
  return {{"type", "timeline"},
          {"first_tick", recording.first_tick},
          {"last_tick", recording.last_tick},
          {"tick_rate_hz", recording.tick_rate_hz},
          {"marks", marks_of(recording)},
          {"depths", depths_of(recording)},
          {"tick_times", tick_times_of(recording)},
          {"notes", recording.notes}};
}

}  // namespace mortise::web
