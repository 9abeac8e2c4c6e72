#include "tests/network/large_scene.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <string>
#include <thread>

#include "client/client.h"
#include "common/messages/mesh_bytes.h"
#include "server/scheduling.h"

namespace mortise::test {
namespace {

constexpr std::size_t kMesh_bytes = 5'000'000;

std::vector<std::byte> generated_mesh(int number) {
  const std::size_t points = kMesh_bytes / 48;  // 24 of a point and two triangles of 12 for each
  std::vector<Vec3> points_mm(points);
  for (std::size_t i = 0; i < points; ++i) {
    points_mm[i] = Vec3(number, static_cast<double>(i % 1000), static_cast<double>(i / 1000));
  }
  std::vector<std::array<std::uint32_t, 3>> triangles(2 * points);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto a = static_cast<std::uint32_t>(i % (points - 2));
    triangles[i] = {a, a + 1, a + 2};
  }
  return mesh_to_bytes(points_mm, triangles);
}

}  // namespace

Result<SceneServed> serve_scene(const DdsOptions& options, int meshes, int joiners) {
  auto channel = open_server_channel(options);
  if (!channel) return channel.error();
  SmallServer server(**channel, options.session, 100);
  SceneServed served;
  for (int i = 0; i < meshes; ++i) {
    const std::vector<std::byte> mesh = generated_mesh(i);
    served.bytes += mesh.size();
    (*channel)->publish_mesh("mesh" + std::to_string(i), mesh);
  }
  Beat quiet, loaded;
  // As the program does where it is permitted.
  (void)run_before_others();
  quiet.run(2.0, 60.0, [&] { server.turn(); });

  run_as_others();
  std::mutex mutex;
  std::atomic<int> whole{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < joiners; ++i) {
    threads.emplace_back([&, i] {
      const double start_s = now_s();
      auto own = open_client_channel(options);
      if (!own) return;
      Client client(**own);
      client.add_user("joiner" + std::to_string(i), "observer");
      std::size_t got = 0;
      if (until(
              30.0, [&] { return got == served.bytes && client.synced() && client.user_id(0); },
              [&] {
                for (const MeshBytes& mesh : client.poll().meshes) got += mesh.bytes.size();
              })) {
        const std::lock_guard lock(mutex);
        served.slowest_s = std::max(served.slowest_s, now_s() - start_s);
        ++whole;
      }
    });
  }
  (void)run_before_others();
  for (int i = 0; i < 60 && whole < joiners; ++i) loaded.run(0.5, 60.0, [&] { server.turn(); });
  run_as_others();
  for (std::thread& thread : threads) thread.join();
  served.whole = whole;
  served.undisturbed_p99_ms = 1e3 * percentile(quiet.lateness_s, 0.99);
  served.lateness_p99_ms = 1e3 * percentile(loaded.lateness_s, 0.99);
  return served;
}

}  // namespace mortise::test
