#include "tests/golden/played_session.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"

namespace mortise::test {
namespace {

// What is asked for in a tick: grabs and releases, then increments.
struct Wishes {
  std::vector<Command> commands;
  std::vector<Increment> increments;
};

std::uint64_t ticks_of(double seconds, double rate_hz) {
  return static_cast<std::uint64_t>(std::llround(std::max(seconds * rate_hz, 1.0)));
}

// By tick, counted from 1. Users join in tick 1.
std::map<std::uint64_t, Wishes> schedule(const Play& play, const World& world,
                                         const std::map<std::string, UserId>& users) {
  std::map<std::uint64_t, Wishes> wishes;
  std::map<UserId, std::uint64_t> next_seq, next_command;
  for (const Play::Act& act : play.acts) {
    const Part* part = world.find_part(act.part);
    const UserId user = users.at(act.user);
    const PartId id = part != nullptr ? part->id : PartId{};
    std::uint64_t tick =
        2 + static_cast<std::uint64_t>(std::llround(act.at_s * world.tick_rate_hz));
    wishes[tick].commands.push_back({user, id, ++next_command[user], CommandKind::kGrab});
    for (const Play::Step& step : act.steps) {
      const std::uint64_t count = ticks_of(step.seconds, world.tick_rate_hz);
      const double share = 1.0 / static_cast<double>(count);
      for (std::uint64_t i = 0; i < count; ++i, ++tick) {
        if (step.by_mm.isZero() && step.rotate_rad.isZero()) continue;
        wishes[tick].increments.push_back(
            {user, id, ++next_seq[user], share * step.by_mm, share * step.rotate_rad});
      }
    }
    if (act.release)
      wishes[tick].commands.push_back({user, id, ++next_command[user], CommandKind::kRelease});
  }
  return wishes;
}

// Moves what each user sends to later ticks, in order: a stall begins in one of forty ticks and
// lasts for up to eight.
std::map<std::uint64_t, Wishes> late(const std::map<std::uint64_t, Wishes>& wishes,
                                     std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::map<UserId, std::uint64_t> not_before;
  std::map<std::uint64_t, Wishes> arrived;
  const auto arrival = [&](UserId user, std::uint64_t tick) {
    std::uint64_t& earliest = not_before[user];
    if (earliest < tick) earliest = random() % 40 == 0 ? tick + random() % 8 : tick;
    return earliest;
  };
  for (const auto& [tick, wish] : wishes) {
    for (const Command& command : wish.commands)
      arrived[arrival(command.user, tick)].commands.push_back(command);
    for (const Increment& increment : wish.increments)
      arrived[arrival(increment.user, tick)].increments.push_back(increment);
  }
  return arrived;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

Result<PlayedSession> play_session(const std::string& scenario_name, const std::string& yaml,
                                   const Play& play, int threads, const StepSwitches& switches,
                                   std::uint64_t arrival_seed) {
  auto reading = read_scenario_text(yaml, scenario_name);
  if (!reading) return reading.error();
  if (!reading->usable()) return fail(Code::kInvalidInput, reading->findings.front().text);
  auto scene = load_scene(reading->scenario, default_meshes());
  if (!scene) return scene.error();
  if (!scene->usable()) return fail(Code::kInvalidInput, scene->findings.front().text);

  PlayedSession session{.header = {}, .scene = std::move(*scene), .ticks = {}};
  World& world = session.scene.world;
  session.header = log_header(session.scene, world.name, scenario_name, yaml);

  std::map<std::string, UserId> users;
  std::uint32_t next_id = 1;
  for (const std::string& name : play.users()) users[name] = UserId{next_id++};
  auto wishes = schedule(play, world, users);
  if (arrival_seed != 0) wishes = late(wishes, arrival_seed);

  Scratch scratch(threads);
  scratch.impl().switches = switches;
  const std::uint64_t last_tick = wishes.empty() ? 1 : wishes.rbegin()->first;
  for (std::uint64_t tick = 1; tick <= last_tick; ++tick) {
    TickRecord record;
    record.tick = tick;
    record.time_ns = std::llround(static_cast<double>(tick) / world.tick_rate_hz * 1e9);
    if (tick == 1)
      for (const std::string& name : play.users()) {
        record.decisions.push_back({Decision::Kind::kJoin, users[name], PartId{}, name});
        apply_decision(world, record.decisions.back());
      }
    if (const auto wish = wishes.find(tick); wish != wishes.end()) {
      for (const Command& command : wish->second.commands) {
        Decision decision;
        const Reply reply = apply_command(world, command, decision);
        if (reply.refusal != Refusal::kNone) return fail(Code::kRuntime, reply.text);
        record.decisions.push_back(decision);
      }
      record.increments = wish->second.increments;
    }
    record.report = step(world, record.increments, scratch);
    session.ticks.push_back(std::move(record));
  }
  return session;
}

Result<PlayedSession> play_session(const std::filesystem::path& scenario,
                                   const std::filesystem::path& play, int threads,
                                   const StepSwitches& switches, std::uint64_t arrival_seed) {
  auto acts = read_play(play);
  if (!acts) return acts.error();
  return play_session(scenario.filename().string(), text_of(scenario), *acts, threads, switches,
                      arrival_seed);
}

Status write_log(const PlayedSession& session, const std::filesystem::path& file) {
  auto writer = SessionLogWriter::create(file, session.header);
  if (!writer) return writer.error();
  for (const TickRecord& tick : session.ticks) (*writer)->record(tick);
  return (*writer)->close();
}

}  // namespace mortise::test
