#include "client/replay/commands.h"

#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "client/replay/explain.h"
#include "client/replay/explain_text.h"
#include "client/replay/output.h"
#include "client/replay/progress.h"
#include "common/io/build_info.h"
#include "common/io/log/log_chain.h"
#include "common/io/log/log_seal_check.h"
#include "common/io/log/replay.h"
#include "common/io/log/session_log_recover.h"
#include "common/io/report_json.h"
#include "common/messages/names.h"
#include "common/session/tick/statistics.h"

namespace mortise {
namespace {

using nlohmann::ordered_json;

// A log that cannot be opened or read is bad input, whatever the reason.
int say_bad_log(const Error& error) { return say(error, kExitBadInput); }

ordered_json gaps_of(const SessionLog& log) {
  ordered_json gaps = ordered_json::array();
  for (const LogGap& gap : log.gaps)
    gaps.push_back(
        {{"after_tick", gap.after_tick}, {"until_tick", gap.until_tick}, {"reason", gap.reason}});
  return gaps;
}

// One computation for verify and report; `on_tick` may be empty.
struct Verification {
  SessionLog log;
  ReplayReport report;
  int exit_code = kExitOk;
};
Result<Verification> verification_of(
    const VerifyOptions& options,
    const std::function<void(const World&, const StepReport&)>& on_tick) {
  auto log = read_files(options.log, options.more);
  if (!log) return log.error();
  print_notes(*log);
  Progress progress("computing again",
                    log->ticks.empty() ? 1.0 : static_cast<double>(log->ticks.back().tick));
  auto report = verify(*log, options.threads, [&](const World& world, const StepReport& tick) {
    progress.show(static_cast<double>(tick.tick));
    if (on_tick) on_tick(world, tick);
  });
  progress.end();
  if (!report) return fail(report.error().code, options.log.string() + ": " + report.error().text);
  if (!report->same_build)
    std::cerr << "recorded by another build (" << log->engine_version
              << "): compared within accuracy, not to the last bit\n";
  const int code = report->difference                ? kExitMismatch
                   : !report->not_verifiable.empty() ? kExitBadInput
                                                     : kExitOk;
  return Verification{std::move(*log), std::move(*report), code};
}

ordered_json json_of(const VerifyOptions& options, const Verification& verification) {
  const ReplayReport& report = verification.report;
  ordered_json document = {{"log", options.log.string()},
                           {"verified", verification.exit_code == kExitOk},
                           {"verified_to_tick", report.verified_to_tick},
                           {"ticks_logged", report.ticks_logged},
                           {"ticks_compared", report.ticks_compared},
                           {"idle_ticks", report.idle_ticks},
                           {"decisions", report.decisions},
                           {"increments", report.increments},
                           {"events_compared", report.events_compared},
                           {"checkpoints_compared", report.checkpoints_compared},
                           {"same_build", report.same_build},
                           {"bit_for_bit", report.bit_for_bit},
                           {"largest_pose_off_mm", report.largest_pose_off_mm},
                           {"complete", verification.log.complete},
                           {"difference", nullptr},
                           {"not_verifiable", report.not_verifiable},
                           {"notes", verification.log.notes}};
  if (!options.signed_by.empty()) document["signed"] = true;
  if (report.difference)
    document["difference"] = {{"tick", report.difference->tick}, {"what", report.difference->what}};
  return document;
}

void print_text(const Verification& verification) {
  const ReplayReport& report = verification.report;
  if (report.difference)
    std::cout << "DIFFERENT at tick " << report.difference->tick << ": " << report.difference->what
              << '\n';
  else if (!report.not_verifiable.empty())
    std::cout << "NOT VERIFIABLE after tick " << report.verified_to_tick << ": "
              << report.not_verifiable << '\n';
  std::cout << (verification.exit_code == kExitOk ? "verified: " : "agreed before that: ")
            << "up to tick " << report.verified_to_tick << ", " << report.ticks_compared << " of "
            << report.ticks_logged << " recorded ticks, " << report.idle_ticks << " idle ticks, "
            << report.increments << " increments, " << report.events_compared << " clash events, "
            << report.checkpoints_compared << " checkpoints"
            << (report.bit_for_bit ? ", bit for bit\n" : "");
  if (!report.bit_for_bit)
    std::cout << ", within accuracy; poses to " << report.largest_pose_off_mm << " mm\n";
}

ordered_json files_of(const InfoOptions& options) {
  std::vector<std::filesystem::path> paths = options.more;
  paths.insert(paths.begin(), options.log);
  if (options.more.empty()) paths = chain_from(options.log);
  ordered_json files = ordered_json::array();
  std::uint64_t bytes = 0;
  std::error_code ignored;
  for (const std::filesystem::path& path : paths) {
    files.push_back(path.filename().string());
    bytes += std::filesystem::file_size(path, ignored);
  }
  return {{"files", files}, {"bytes", bytes}};
}

ordered_json contents_of(const SessionLog& log) {
  std::uint64_t increments = 0, refused = 0, decisions = 0, events = 0, triangles = 0;
  std::map<std::string, std::uint64_t> begun;  // by worst class of ended or open clashes
  std::map<std::uint32_t, CollisionClass> worst;
  ordered_json users = ordered_json::array();
  for (const TickRecord& tick : log.ticks) {
    increments += tick.increments.size();
    refused += tick.report.refused.size();
    decisions += tick.decisions.size();
    events += tick.report.events.size();
    for (const ClashEvent& event : tick.report.events) worst[event.clash.value] = event.worst_class;
    for (const Decision& decision : tick.decisions)
      if (decision.kind == Decision::Kind::kJoin) users.push_back(decision.user_name);
  }
  for (const auto& [clash, worst_class] : worst) ++begun[std::string(name_of(worst_class))];
  for (const auto& [hash, mesh] : log.meshes) triangles += mesh.triangles.size();
  const TickRecord* first = log.ticks.empty() ? nullptr : &log.ticks.front();
  const TickRecord* last = log.ticks.empty() ? nullptr : &log.ticks.back();
  return {{"complete", log.complete},
          {"session", log.session},
          {"scenario", log.scenario_name},
          {"engine_version", log.engine_version},
          {"build_fingerprint", log.build_fingerprint},
          {"same_build", log.build_fingerprint == build_fingerprint()},
          {"parts", log.mesh_of_part.size()},
          {"meshes", log.meshes.size()},
          {"triangles", triangles},
          {"users", users},
          {"ticks", log.ticks.size()},
          {"first_tick", first != nullptr ? first->tick : 0},
          {"last_tick", last != nullptr ? last->tick : 0},
          {"duration_s",
           first != nullptr ? static_cast<double>(last->time_ns - first->time_ns) * 1e-9 : 0.0},
          {"decisions", decisions},
          {"increments", increments},
          {"refused", refused},
          {"clash_events", events},
          {"clashes_by_worst_class", begun},
          {"checkpoints", log.checkpoints.size()},
          {"goes_on_from", log.chain.previous},
          {"gaps", gaps_of(log)},
          {"notes", log.notes}};
}

}  // namespace

// Said before anything is computed: what was changed is not worth it.
int verify_signed(const VerifyOptions& options) {
  std::vector<std::filesystem::path> files{options.log};
  files.insert(files.end(), options.more.begin(), options.more.end());
  if (options.more.empty()) files = chain_from(options.log);
  const auto why_not = why_not_signed(files, options.signed_by);
  if (!why_not) return say_bad_log(why_not.error());
  if (why_not->empty()) return kExitOk;
  if (options.json)
    print({{"log", options.log.string()}, {"verified", false}, {"not_signed", *why_not}});
  else
    std::cout << "NOT SIGNED, or not unchanged: " << *why_not << '\n';
  return kExitMismatch;
}

int run_verify(const VerifyOptions& options) {
  if (!options.signed_by.empty())
    if (const int code = verify_signed(options); code != kExitOk) return code;
  const auto verification = verification_of(options, {});
  if (!verification) return say_bad_log(verification.error());
  if (options.json)
    print(json_of(options, *verification));
  else
    print_text(*verification);
  if (!options.signed_by.empty() && !options.json) std::cout << "signed, and unchanged since\n";
  return verification->exit_code;
}

int run_report(const VerifyOptions& options) {
  SessionStatistics statistics;
  SessionNames names;
  std::vector<std::string> last_names;  // by user, of whom the id is now
  const auto verification =
      verification_of(options, [&](const World& world, const StepReport& report) {
        statistics.add(report);
        if (names.parts.empty()) names = names_of(world);
        // An id that somebody took over was first the one's and then the other's: so are its sums.
        names.users.resize(world.users.size());
        last_names.resize(world.users.size());
        for (std::size_t i = 0; i < world.users.size(); ++i) {
          if (last_names[i] == world.users[i].name) continue;
          names.users[i] = last_names[i].empty() ? world.users[i].name
                                                 : names.users[i] + ", then " + world.users[i].name;
          last_names[i] = world.users[i].name;
        }
      });
  if (!verification) return say_bad_log(verification.error());
  if (options.json) {
    ordered_json document = json_of(options, *verification);
    document["statistics"] = mortise::json_of(statistics, names);
    print(document);
  } else {
    print_text(*verification);
    std::cout << '\n'
              << collision_table(statistics, names) << '\n'
              << stage_table(statistics.counters());
  }
  return verification->exit_code;
}

int run_explain(const ExplainOptions& options) {
  auto log = read_session(options.log);
  if (!log) return say_bad_log(log.error());
  print_notes(*log);
  Progress progress("computed again, ticks", 0.0);
  const auto chain =
      explain_clash(std::move(*log), ClashId{options.clash}, options.tick,
                    [&](std::uint64_t tick) { progress.show(static_cast<double>(tick)); });
  progress.end();
  if (!chain) return say_bad_log(chain.error());
  if (options.json)
    print(*chain);
  else
    std::cout << explain_text(*chain);
  return kExitOk;
}

int run_info(const InfoOptions& options) {
  const auto log = read_files(options.log, options.more);
  if (!log) return say_bad_log(log.error());
  ordered_json document = {{"log", options.log.string()}};
  document.update(files_of(options));
  document.update(contents_of(*log));
  if (options.json) {
    print(document);
    return kExitOk;
  }
  print_lines(document);
  return kExitOk;
}

int run_recover(const RecoverOptions& options) {
  const auto recovery = recover_session_log(options.log, options.out);
  if (!recovery)
    return recovery.error().code == Code::kRuntime
               ? say(recovery.error(), exit_code_of(Code::kRuntime))
               : say_bad_log(recovery.error());
  if (!recovery->not_replayable.empty()) {
    if (options.json)
      print({{"log", options.log.string()}, {"not_replayable", recovery->not_replayable}});
    return say({Code::kInvalidInput,
                "not replayable, and nothing was written: " + recovery->not_replayable},
               kExitNotReplayable);
  }
  if (options.json) {
    print({{"log", options.log.string()},
           {"out", options.out.string()},
           {"was_complete", recovery->was_complete},
           {"ticks", recovery->ticks},
           {"messages", recovery->messages},
           {"lost_chunks", recovery->lost_chunks},
           {"verified_to_tick", recovery->verified_to_tick},
           {"not_verified", recovery->not_verified},
           {"notes", recovery->notes}});
    return recovery->differs ? kExitMismatch : kExitOk;
  }
  for (const std::string& note : recovery->notes)
    std::cout << "lost or unexpected: " << note << '\n';
  std::cout << options.out.string() << ": " << recovery->ticks << " ticks, " << recovery->messages
            << " messages; " << recovery->lost_chunks << " chunks lost; "
            << (recovery->was_complete ? "the log had been closed" : "the log had not been closed")
            << "; verified up to tick " << recovery->verified_to_tick
            << (recovery->not_verified.empty() ? "" : ", not beyond: " + recovery->not_verified)
            << '\n';
  return recovery->differs ? kExitMismatch : kExitOk;
}

}  // namespace mortise
