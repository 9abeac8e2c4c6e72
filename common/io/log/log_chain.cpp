#include "common/io/log/log_chain.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>

#include "common/io/log/log_front.h"
#include "common/io/log/log_layout.h"
#include "common/io/log/mcap_reader.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

// What a file says of its place; none when it is no log, or the first of its session. Its head says
// so, unless that is damaged.
std::optional<LogChain> place_of(const fs::path& file) {
  std::optional<LogChain> chain;
  bool head_read = false, is_first = false;
  const McapHandler handler{
      .on_attachment = [&](const McapAttachment&) { head_read = true; },
      .on_metadata =
          [&](const std::string& name, const std::map<std::string, std::string>& values) {
            if (!log_front::is_whole(values)) return;
            const auto part = values.find("part");
            if (name == log_layout::kSessionMetadata)
              is_first = part == values.end() || part->second == "1";  // older ones do not say
            if (name != log_layout::kChainMetadata) return;
            const auto previous = values.find("previous");
            if (previous == values.end() || part == values.end()) return;
            chain = LogChain{previous->second, std::strtoull(part->second.c_str(), nullptr, 10)};
          },
      .is_enough = [&] { return chain || (head_read && is_first); }};
  if (!scan_mcap(file, handler)) return std::nullopt;
  return chain;
}

// By the name of the file that they go on from: the last of that name.
std::map<std::string, fs::path> followers_in(const fs::path& folder) {
  std::map<std::string, fs::path> followers;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".mcap" || !entry.is_regular_file(error)) continue;
    const auto place = place_of(entry.path());
    if (!place || place->part < 2) continue;
    fs::path& follower = followers[place->previous];
    if (follower.empty() || follower.filename() < entry.path().filename()) follower = entry.path();
  }
  return followers;
}

template <class T>
void append(std::vector<T>& to, std::vector<T>& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

// Puts `next` behind `log`; `file` for what there is to say.
Status join(SessionLog& log, SessionLog next, const std::string& file) {
  if (!next.begin)
    return fail(Code::kInvalidInput, file +
                                         ": begins a session of its own, or the state that it "
                                         "begins with is damaged; give the files of one "
                                         "session, in order");
  if (next.session != log.session || next.mesh_of_part != log.mesh_of_part)
    return fail(Code::kInvalidInput, file + ": is a log of another session");
  const std::uint64_t at = next.begin->state.tick;
  const auto beyond = [&](const auto& x) { return x.tick > at; };
  const std::uint64_t before = log.begin ? log.begin->state.tick : 0;
  if (at < before)
    return fail(Code::kInvalidInput, file + ": begins at tick " + std::to_string(at) +
                                         ", before the file that was to come first");
  // 1. What the file before has beyond the place where this one begins was not gone on from.
  const std::size_t left_out = std::erase_if(log.ticks, beyond);
  std::erase_if(log.checkpoints, beyond);
  std::erase_if(log.gaps, [&](const LogGap& gap) { return gap.after_tick >= at; });
  if (left_out > 0)
    log.notes.push_back(std::to_string(left_out) + " ticks after tick " + std::to_string(at) +
                        " are left out: " + file + " goes on from there without them");
  // 2. What is in neither.
  const std::uint64_t last = log.ticks.empty() ? before : log.ticks.back().tick;
  if (last < at)
    log.gaps.push_back({last, next.ticks.empty() ? 0 : next.ticks.front().tick,
                        "ticks up to " + std::to_string(at) + " are missing before " + file});
  // 3. The rest.
  for (auto& mesh : next.meshes)
    if (std::ranges::none_of(log.meshes, [&](auto& m) { return m.first == mesh.first; }))
      log.meshes.push_back(std::move(mesh));
  log.checkpoints.push_back(std::move(next.begin->state));
  append(log.ticks, next.ticks);
  append(log.checkpoints, next.checkpoints);
  append(log.gaps, next.gaps);
  append(log.notes, next.notes);
  append(log.times, next.times);
  for (const auto& [name, count] : next.counted) log.counted[name] += count;
  log.complete = next.complete;
  if (next.build_fingerprint != log.build_fingerprint) log.build_fingerprint = "several builds";
  return ok();
}

}  // namespace

std::vector<fs::path> chain_from(const fs::path& file) {
  std::vector<fs::path> files{file};
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const std::map<std::string, fs::path> followers = followers_in(folder);
  for (auto next = followers.find(file.filename().string());
       next != followers.end() && files.size() <= followers.size();
       next = followers.find(files.back().filename().string()))
    files.push_back(next->second);
  return files;
}

Result<SessionLog> read_session(std::span<const fs::path> files, const LogReading& reading) {
  auto log = read_session_log(files.front(), reading);
  if (!log) return log;
  double read = 0.0;
  LogReading further = reading;
  if (reading.on_progress)
    further.on_progress = [&](double share) { reading.on_progress(read + share); };
  for (const fs::path& file : files.subspan(1)) {
    read += 1.0;
    auto next = read_session_log(file, further);
    if (!next) return next.error();
    if (Status joined = join(*log, std::move(*next), file.string()); !joined) return joined.error();
  }
  return log;
}

Result<SessionLog> read_session(const fs::path& file, const LogReading& reading) {
  return read_session(chain_from(file), reading);
}

}  // namespace mortise
