#include "client/saved/saved_session.h"

#include <zip.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "client/tools/generate/write_mesh.h"
#include "common/base/in_quotes.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kScenario = "scenario.yaml", kMeshes = "meshes/", kMesh = ".obj",
                           kPart = ".mstp";

struct Discard {
  void operator()(zip_t* zip) const { zip_discard(zip); }
};
using Zip = std::unique_ptr<zip_t, Discard>;

struct CloseFile {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
struct FreeSource {
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};

std::string why(zip_error_t& reason) {
  std::string text = zip_error_strerror(&reason);
  zip_error_fini(&reason);
  return text;
}

std::string text_of(const SavedScenario::MeshFile& mesh) {
  if (mesh.with_stated) {
    const std::vector<std::byte>& bytes = *mesh.solid->mesh().stated;
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  std::ostringstream out;
  write_obj(mesh.solid->mesh(), {}, out);
  return std::move(out).str();
}

// Of what is saved: names of plain letters, in this folder or in that of the meshes.
bool is_saved_name(std::string_view name) {
  if (name == kScenario) return true;
  if (!name.starts_with(kMeshes) || !(name.ends_with(kMesh) || name.ends_with(kPart))) return false;
  name.remove_prefix(kMeshes.size());
  name.remove_suffix(name.ends_with(kMesh) ? kMesh.size() : kPart.size());
  return !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
    return (c < 0x80 && std::isalnum(c) != 0) || c == '_' || c == '-';
  });
}

Error not_saved(const fs::path& archive, const std::string& what) {
  return fail(Code::kInvalidInput,
              archive.filename().string() + ": " + what + "; give an archive that Save wrote");
}

Status is_free(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_empty(folder, error))
    return fail(Code::kInvalidInput, folder.string() + " is not empty; name a new folder");
  return ok();
}

Status make_folders(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder / kMeshes, error);
  if (!error) return ok();
  return fail(Code::kRuntime, folder.string() + " cannot be made: " + error.message());
}

Status not_written(const fs::path& file) {
  return fail(Code::kRuntime, file.string() + " could not be written");
}

Status write_file(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  return out.flush() ? ok() : not_written(file);
}

/// Reads an archive of a stranger.
class Unpacking {
 public:
  Unpacking(const fs::path& archive, const fs::path& folder, const SavedLimits& limits)
      : archive_(archive), folder_(folder), limits_(limits) {}

  Status run() {
    int error = 0;
    zip_.reset(zip_open(archive_.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &error));
    if (!zip_) {
      zip_error_t reason;
      zip_error_init_with_code(&reason, error);
      return not_saved(archive_, "is no archive that can be read (" + why(reason) + ")");
    }
    // All names are looked at before anything is written.
    if (Status named = take_names(); !named) return named;
    if (Status made = make_folders(folder_); !made) return made;
    for (const auto& [index, name] : entries_)
      if (Status taken = take(index, name); !taken) return taken;
    return ok();
  }

 private:
  Status take_names() {
    const zip_int64_t count = zip_get_num_entries(zip_.get(), 0);
    if (count > static_cast<zip_int64_t>(limits_.files))
      return not_saved(archive_, "holds " + std::to_string(count) + " files, more than " +
                                     std::to_string(limits_.files));
    std::set<std::string> names;
    for (zip_int64_t i = 0; i < count; ++i) {
      const auto index = static_cast<zip_uint64_t>(i);
      const char* text = zip_get_name(zip_.get(), index, 0);
      const std::string name = text != nullptr ? text : "";
      if (name == kMeshes) continue;  // a folder has no bytes
      if (!is_saved_name(name))
        return not_saved(archive_, "holds " + in_quotes(name) + ", which no saved session has");
      if (!names.insert(name).second) return not_saved(archive_, "holds " + name + " twice");
      entries_.emplace_back(index, name);
    }
    return names.contains(std::string(kScenario)) ? ok()
                                                  : not_saved(archive_, "holds no scenario.yaml");
  }

  // The length in the archive's own list may be a lie: what comes out is counted.
  Status take(zip_uint64_t index, const std::string& name) {
    const std::unique_ptr<zip_file_t, CloseFile> file(zip_fopen_index(zip_.get(), index, 0));
    if (!file) return not_saved(archive_, name + " cannot be read: " + zip_strerror(zip_.get()));
    std::ofstream out(folder_ / name, std::ios::binary);
    std::array<char, 1 << 16> piece;
    for (;;) {
      const zip_int64_t read = zip_fread(file.get(), piece.data(), piece.size());
      if (read < 0) return not_saved(archive_, name + " is damaged");
      if (read == 0) break;
      bytes_ += static_cast<std::uint64_t>(read);
      if (bytes_ > limits_.bytes)
        return not_saved(archive_,
                         "unpacks to more than " + std::to_string(limits_.bytes) + " bytes");
      out.write(piece.data(), read);
      if (!out) break;
    }
    return out.flush() ? ok() : not_written(folder_ / name);
  }

  const fs::path& archive_;
  const fs::path& folder_;
  SavedLimits limits_;
  Zip zip_;
  std::vector<std::pair<zip_uint64_t, std::string>> entries_;
  std::uint64_t bytes_ = 0;
};

}  // namespace

Result<SavedSession> saved_session(const SessionLog& log, const OnReplayedTick& on_tick) {
  auto at = scene_at_last_checkpoint(log);
  if (!at) return at.error();
  World& world = at->scene.world;
  const auto done = recompute(world, log, 1, on_tick);
  if (!done) return done.error();
  const auto reading = scenario_of(log);
  if (!reading) return reading.error();
  auto saved = saved_scenario({log.scenario_yaml, reading->scenario, log.mesh_of_part}, world);
  if (!saved) return saved.error();
  return SavedSession{std::move(*saved), done->stopped_early};
}

Status write_folder(const SavedScenario& saved, const fs::path& folder) {
  if (Status free = is_free(folder); !free) return free;
  if (Status made = make_folders(folder); !made) return made;
  for (const SavedScenario::MeshFile& mesh : saved.meshes)
    if (Status written = write_file(folder / mesh.name, text_of(mesh)); !written) return written;
  return write_file(folder / kScenario, saved.yaml);
}

Result<std::string> zip_of(const SavedScenario& saved) {
  zip_error_t reason;
  zip_error_init(&reason);
  const std::unique_ptr<zip_source_t, FreeSource> all(
      zip_source_buffer_create(nullptr, 0, 0, &reason));
  const auto failed = [&](const std::string& text) {
    return fail(Code::kRuntime, "the archive cannot be made: " + text);
  };
  if (!all) return failed(why(reason));
  zip_source_keep(all.get());  // it outlives the archive, which frees its own share
  Zip zip(zip_open_from_source(all.get(), ZIP_TRUNCATE, &reason));
  if (!zip) {
    zip_source_free(all.get());
    return failed(why(reason));
  }
  std::vector<std::pair<std::string, std::string>> files{{std::string(kScenario), saved.yaml}};
  for (const SavedScenario::MeshFile& mesh : saved.meshes)
    files.emplace_back(mesh.name, text_of(mesh));
  for (const auto& [name, text] : files) {
    zip_source_t* source = zip_source_buffer(zip.get(), text.data(), text.size(), 0);
    if (source != nullptr && zip_file_add(zip.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8) >= 0)
      continue;
    if (source != nullptr) zip_source_free(source);
    return failed(zip_strerror(zip.get()));
  }
  if (zip_close(zip.get()) != 0) return failed(zip_strerror(zip.get()));
  (void)zip.release();
  zip_stat_t size;
  zip_source_stat(all.get(), &size);
  std::string bytes(size.size, '\0');
  if (zip_source_open(all.get()) != 0) return failed("its bytes cannot be read");
  const zip_int64_t read = zip_source_read(all.get(), bytes.data(), bytes.size());
  zip_source_close(all.get());
  if (read != static_cast<zip_int64_t>(bytes.size())) return failed("its bytes cannot be read");
  return bytes;
}

Status unpack(const fs::path& archive, const fs::path& folder, const SavedLimits& limits) {
  if (Status free = is_free(folder); !free) return free;
  std::error_code error;
  const bool was_there = fs::exists(folder, error);
  Status done = Unpacking(archive, folder, limits).run();
  if (done) return done;
  fs::remove_all(was_there ? folder / kMeshes : folder, error);
  fs::remove(folder / kScenario, error);
  return done;
}

}  // namespace mortise
