#include "client/bot/tally.h"

#include <fmt/format.h>

#include <algorithm>

#include "client/bot/load_report.h"
#include "common/base/hash.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

std::string hex(std::uint64_t value) { return fmt::format("{:016x}", value); }

std::size_t place_of(Refusal reason) {
  return std::min<std::size_t>(static_cast<std::size_t>(reason), kRefusalCount - 1);
}

nlohmann::ordered_json by_reason(const std::array<std::uint64_t, kRefusalCount>& counts) {
  auto json = nlohmann::ordered_json::object();
  for (std::size_t i = 1; i < counts.size(); ++i) {
    if (counts[i] > 0) json[std::string(name_of(static_cast<Refusal>(i)))] = counts[i];
  }
  return json;
}

void add_verdict(StateHash& hash, const Verdict& verdict) {
  hash.add(static_cast<std::uint64_t>(verdict.collision_class));
  hash.add(verdict.delta_mm.lo);
  hash.add(verdict.delta_mm.hi);
  hash.add(verdict.fake_below_mm);
  hash.add(verdict.real_above_mm);
  for (int i = 0; i < 3; ++i) hash.add(verdict.point_W[i]);
}

void add_clash(StateHash& hash, const ClashEvent& event) {
  hash.add(std::uint64_t{event.clash.value});
  hash.add(std::uint64_t{event.part_a.value});
  hash.add(std::uint64_t{event.part_b.value});
  add_verdict(hash, event.verdict);
}

}  // namespace

void Tally::add(const ClientUpdate& update, const Client& client) {
  latency_ms_.insert(latency_ms_.end(), update.latency_ms.begin(), update.latency_ms.end());
  const std::vector<double> delays_ms = event_delay_.add(update, client);
  event_latency_ms_.insert(event_latency_ms_.end(), delays_ms.begin(), delays_ms.end());
  for (const SeenAck& ack : update.acks) {
    if (ack.user >= acknowledged_.size()) acknowledged_.resize(ack.user + 1, 0);
    acknowledged_[ack.user] = std::max(acknowledged_[ack.user], ack.seq);
  }
  for (const RefusedIncrement& refused : update.refused) {
    ++refused_[place_of(refused.reason)];
  }
  for (const Reply& reply : update.replies) {
    ++replies_;
    if (reply.refusal == Refusal::kNone) continue;
    ++commands_refused_;
    ++commands_refused_by_[place_of(reply.refusal)];
  }
  for (const ClashEvent& event : update.events) {
    if (first_seq_ == 0) first_seq_ = event.seq;
    last_seq_ = event.seq;
    stream_.add(event);
    ++events_;
    ++events_by_kind_[static_cast<std::size_t>(event.kind) & 3U];
    CollisionClass& worst = worst_[event.clash];
    worst = std::max({worst, event.worst_class, event.verdict.collision_class});
    add_pair(event, client);
    StateHash hash;
    hash.add(event_hash_);
    hash.add(event.seq);
    hash.add(event.tick);
    hash.add(static_cast<std::uint64_t>(event.kind));
    hash.add(std::uint64_t{event.user.value});
    hash.add(event.t_contact);
    hash.add(event.t_potential);
    hash.add(event.t_real);
    add_clash(hash, event);
    event_hash_ = hash.value();
  }
  if (update.resynced) {
    ++resyncs_;
    for (const auto& [id, clash] : client.open_clashes()) {
      worst_[id] = std::max(worst_[id], clash.worst_class);
      add_pair(clash, client);
    }
  }
  if (update.server_lost) ++server_losses_;
  if (update.pulse) {
    // Another server counts from zero.
    if (!first_pulse_ || update.pulse->not_examined < first_pulse_->not_examined ||
        update.pulse->missed_deadlines < first_pulse_->missed_deadlines)
      first_pulse_ = update.pulse;
    last_pulse_ = update.pulse;
  }
  meshes_ += update.meshes.size();
}

void Tally::add_pair(const ClashEvent& event, const Client& client) {
  const auto a = client.parts().find(event.part_a), b = client.parts().find(event.part_b);
  if (a == client.parts().end() || b == client.parts().end()) return;
  CollisionClass& worst = worst_of_pair_[pair_key(a->second.info.name, b->second.info.name)];
  worst = std::max({worst, event.worst_class, event.verdict.collision_class});
}

std::uint64_t Tally::refused() const {
  std::uint64_t sum = 0;
  for (std::uint64_t count : refused_) sum += count;
  return sum;
}

std::string Tally::event_hash() const { return hex(event_hash_); }

nlohmann::ordered_json Tally::json() const {
  nlohmann::ordered_json json;
  json["latency_ms"] = percentiles(latency_ms_);
  json["event_latency_ms"] = percentiles(event_latency_ms_);
  json["events_without_increment"] = event_delay_.unmatched();
  json["refused"] = by_reason(refused_);
  json["replies"] = replies_;
  json["commands_refused"] = commands_refused_;
  json["commands_refused_by"] = by_reason(commands_refused_by_);
  json["commands_accepted"] = replies_ - commands_refused_;
  json["events"] = {{"count", events_},
                    {"first_seq", first_seq_},
                    {"last_seq", last_seq_},
                    {"begin", events_by_kind_[1]},
                    {"change", events_by_kind_[2]},
                    {"end", events_by_kind_[3]},
                    {"hash", event_hash()},
                    {"stream_hash", hex(stream_.hash())}};
  std::array<std::uint64_t, 4> by_class{};
  for (const auto& [id, worst] : worst_) ++by_class[static_cast<std::size_t>(worst) & 3U];
  json["clashes_seen"] = {{"real", by_class[3]}, {"potential", by_class[2]}, {"fake", by_class[1]}};
  json["worst_classes"] = nlohmann::ordered_json::object();
  for (const auto& [pair, worst] : worst_of_pair_)
    json["worst_classes"][pair] = std::string(name_of(worst));
  if (first_pulse_)
    json["server"] = {
        {"not_examined", last_pulse_->not_examined - first_pulse_->not_examined},
        {"missed_deadlines", last_pulse_->missed_deadlines - first_pulse_->missed_deadlines}};
  json["resyncs"] = resyncs_;
  json["server_losses"] = server_losses_;
  json["meshes"] = meshes_;
  return json;
}

std::string pose_hash(const Client& client) {
  StateHash hash;
  for (const auto& [id, part] : client.parts()) {
    hash.add(std::uint64_t{id.value});
    for (int i = 0; i < 4; ++i) hash.add(part.info.X_WP.q.coeffs()[i]);
    for (int i = 0; i < 3; ++i) hash.add(part.info.X_WP.p[i]);
  }
  return hex(hash.value());
}

std::string clash_hash(const Client& client) {
  StateHash hash;
  for (const auto& [id, clash] : client.open_clashes()) add_clash(hash, clash);
  return hex(hash.value());
}

nlohmann::ordered_json state_json(const Client& client) {
  nlohmann::ordered_json json;
  json["pose_hash"] = pose_hash(client);
  json["clash_hash"] = clash_hash(client);
  json["poses"] = nlohmann::ordered_json::object();
  for (const auto& [id, part] : client.parts()) {
    const Pose& X = part.info.X_WP;
    json["poses"][part.info.name] = {X.p.x(), X.p.y(), X.p.z(), X.q.w(), X.q.x(), X.q.y(), X.q.z()};
  }
  json["open_clashes"] = nlohmann::ordered_json::array();
  for (const auto& [id, clash] : client.open_clashes()) {
    json["open_clashes"].push_back(
        {{"clash", id.value},
         {"part_a", clash.part_a.value},
         {"part_b", clash.part_b.value},
         {"class", name_of(clash.verdict.collision_class)},
         {"delta_mm", {clash.verdict.delta_mm.lo, clash.verdict.delta_mm.hi}}});
  }
  return json;
}

}  // namespace mortise
