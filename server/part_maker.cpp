#include "server/part_maker.h"

#include <unistd.h>

#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "common/base/hash.h"
#include "common/geometry/recognition/recognized.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/mesh/topology_report.h"
#include "common/io/scenario/brought_part.h"
#include "common/messages/mesh_bytes.h"
#include "common/session/guide/guidance.h"
#include "server/scheduling.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

/// A folder for one file, gone with this.
class OwnFolder {
 public:
  OwnFolder() {
    std::error_code error;
    std::string pattern = (fs::temp_directory_path(error) / "mortise-upload-XXXXXX").string();
    if (::mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  ~OwnFolder() {
    std::error_code error;
    if (!path_.empty()) fs::remove_all(path_, error);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  const fs::path& path() const { return path_; }  ///< empty: it could not be made

 private:
  fs::path path_;
};

Result<ImportedMesh> read_wire_mesh(const std::vector<std::byte>& bytes, const std::string& name) {
  const std::optional<WireMesh> mesh = mesh_from_bytes(bytes);
  if (!mesh) return fail(Code::kInvalidInput, name + ": is no mesh of this kind");
  std::vector<double> coordinates_mm;
  coordinates_mm.reserve(9 * mesh->triangles.size());
  for (const auto& triangle : mesh->triangles)
    for (const std::uint32_t corner : triangle)
      for (int k = 0; k < 3; ++k) {
        const double x = mesh->points_mm[corner][k];
        if (!(std::abs(x) <= kLargestCoordinate_mm))
          return fail(Code::kInvalidInput, name + ": a corner is out of the world");
        coordinates_mm.push_back(x);
      }
  return mesh_of_triangles(std::move(coordinates_mm), name);
}

Result<ImportedMesh> read_brought(const std::vector<std::byte>& bytes, const std::string& name) {
  Result<TriangleMesh> mesh = brought_mesh(bytes);
  if (!mesh) return fail(Code::kInvalidInput, name + ": " + mesh.error().text);
  return with_report(std::move(mesh).value(), name, "STEP");
}

// What the importer says, with the name that the sender gave in place of ours.
std::string told(std::string text, const std::string& path, const std::string& name) {
  for (std::size_t at = text.find(path); at != std::string::npos;
       at = text.find(path, at + name.size()))
    text.replace(at, path.size(), name);
  return text;
}

std::vector<std::byte> joined(std::vector<std::vector<std::byte>> pieces) {
  std::size_t length = 0;
  for (const std::vector<std::byte>& piece : pieces) length += piece.size();
  std::vector<std::byte> file;
  file.reserve(length);
  for (std::vector<std::byte>& piece : pieces) {
    file.insert(file.end(), piece.begin(), piece.end());
    piece = {};
  }
  return file;
}

Result<ImportedMesh> read_file(const PartMaker::Wish& wish, const std::vector<std::byte>& file) {
  const std::string ending = fs::path(wish.name).extension().string();
  if (ending == ".mmsh")
    return is_step_document(file) ? read_brought(file, wish.name) : read_wire_mesh(file, wish.name);
  const OwnFolder folder;
  const fs::path path = folder.path() / ("part" + ending);
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  out.close();
  if (folder.path().empty() || !out)
    return fail(Code::kRuntime, wish.name + ": this server has no room to read it");
  Result<ImportedMesh> mesh = import_mesh(path, wish.unit_mm);
  if (!mesh) return fail(mesh.error().code, told(mesh.error().text, path.string(), wish.name));
  for (std::string& note : mesh->report.notes)
    note = told(std::move(note), path.string(), wish.name);
  return mesh;
}

}  // namespace

struct PartMaker::Work {
  PartShapes::Make make;
  int threads = 1;
  std::mutex mutex;
  std::condition_variable wake;
  std::deque<Wish> wishes;
  std::vector<Made> made;
  std::vector<std::shared_ptr<const void>> discarded;
  bool stop = false;
  std::mutex publishing;  ///< held while `publish` is called: it is none any more after the end
  Publish publish;

  void run() {
    run_as_others();
    std::unique_lock lock(mutex);
    while (true) {
      wake.wait(lock, [this] { return stop || !wishes.empty() || !discarded.empty(); });
      if (stop) return;
      if (!discarded.empty()) {
        auto gone = std::exchange(discarded, {});
        lock.unlock();
        gone.clear();
        lock.lock();
        continue;
      }
      Wish wish = std::move(wishes.front());
      wishes.pop_front();
      lock.unlock();
      Made ready = made_of(std::move(wish));
      lock.lock();
      made.push_back(std::move(ready));
    }
  }

  Made made_of(Wish wish) try {
    Made ready;
    ready.key = wish.key;
    ready.quantum_mm = wish.quantum_mm;
    ready.as = wish.as;
    const bool is_file = !wish.solid;
    if (is_file) {
      const std::vector<std::byte> file = joined(std::exchange(wish.pieces, {}));
      if (content_hash(file) != wish.hash) {
        ready.text = wish.name + ": its bytes are not those that were announced";
        return ready;
      }
      Result<ImportedMesh> mesh = read_file(wish, file);
      if (!mesh) {
        ready.text = mesh.error().text;
        return ready;
      }
      add_notes(notes_of(mesh->report), ready.text);
      ready.quantum_mm = mesh->report.quantum_mm;
      wish.solid = std::make_shared<const Solid>(std::move(mesh->mesh));
    }
    const Solid& solid = *wish.solid;
    const PartShapes::Make& make_it = wish.as ? wish.as->make : make;
    ready.shape = std::make_shared<const PartShape>(make_it(wish.solid, ready.quantum_mm));
    if (is_file) add_notes(ready.shape->notes, ready.text);
    build_derived(*ready.shape, threads);
    if (solid.mesh().triangles.size() <= kRecognizedOnDemand) {
      const auto shown = recognized(solid);
      ready.recognized = {shown, &shown->features};
    }
    if (is_file) tell(solid, ready);
    return ready;
  } catch (const std::exception& error) {  // memory
    Made none;
    none.key = wish.key;
    none.text = wish.name + ": cannot be used: " + error.what();
    return none;
  }

  static void add_notes(const std::vector<std::string>& notes, std::string& text) {
    for (const std::string& note : notes) text += (text.empty() ? "" : "; ") + note;
  }

  // Clients get the mesh; a server that stands by what is stated of it as well.
  void tell(const Solid& solid, Made& ready) {
    const TriangleMesh& mesh = solid.mesh();
    const auto plain = std::make_shared<const std::vector<std::byte>>(
        mesh_to_bytes(mesh.points_mm, mesh.triangles));
    ready.mesh_bytes = mesh.stated ? mesh.stated : plain;
    const std::lock_guard lock(publishing);
    if (publish) publish(solid.hash(), *plain);
  }
};

PartMaker::PartMaker(PartShapes::Make make, int threads, Publish publish)
    : work_(std::make_shared<Work>()) {
  work_->make = std::move(make);
  work_->threads = threads;
  work_->publish = std::move(publish);
  std::thread([work = work_] { work->run(); }).detach();
}

PartMaker::~PartMaker() {
  {
    const std::lock_guard lock(work_->mutex);
    work_->stop = true;
    work_->wishes.clear();
  }
  work_->wake.notify_all();
  const std::lock_guard lock(work_->publishing);
  work_->publish = nullptr;
}

void PartMaker::make(Wish wish) {
  {
    const std::lock_guard lock(work_->mutex);
    work_->wishes.push_back(std::move(wish));
  }
  work_->wake.notify_all();
}

void PartMaker::discard(std::shared_ptr<const void> what) {
  if (!what) return;
  {
    const std::lock_guard lock(work_->mutex);
    work_->discarded.push_back(std::move(what));
  }
  work_->wake.notify_all();
}

std::vector<PartMaker::Made> PartMaker::take() {
  const std::lock_guard lock(work_->mutex);
  return std::exchange(work_->made, {});
}

}  // namespace mortise
