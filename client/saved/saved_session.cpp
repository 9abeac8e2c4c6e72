#include "client/saved/saved_session.h"

#include <zip.h>

#include <fstream>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

#include "client/tools/generate/write_mesh.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

struct Discard {
  void operator()(zip_t* zip) const { zip_discard(zip); }
};
using Zip = std::unique_ptr<zip_t, Discard>;

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

Status make_folders(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder / kSavedMeshes, error);
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

}  // namespace

Status is_free(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_empty(folder, error))
    return fail(Code::kInvalidInput, folder.string() + " is not empty; name a new folder");
  return ok();
}

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
  return write_file(folder / kSavedScenario, saved.yaml);
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
  std::vector<std::pair<std::string, std::string>> files{{std::string(kSavedScenario), saved.yaml}};
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

}  // namespace mortise
