#include "common/io/mesh/sandbox.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <functional>

#include "common/io/mesh/mesh_import.h"
#include "tests/support/effort.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MORTISE_NEEDS_SANDBOX GTEST_SKIP() << "sanitizer: it reads /proc and starts threads"
#else
#define MORTISE_NEEDS_SANDBOX
#endif

void put(const fs::path& file, const std::string& bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

/// A tetrahedron, whose 12 indices are in the file of this name.
std::string tetra_that_names(const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[
{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},
{"buffer":1,"byteOffset":0,"byteLength":12}],"buffers":[{"byteLength":48,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/"},
{"byteLength":12,"uri":")" +
         uri + "\"}]}";
}
const std::string kIndices("\0\2\1\0\1\3\0\3\2\1\2\3", 12);

class NamedFile : public testing::Test {
 protected:
  NamedFile() {
    put(folder_.path() / "outside.bin", kIndices);
    put(meshes_ / "beside.bin", kIndices);
    put(meshes_ / "below/deeper.bin", kIndices);
  }
  std::string imported(const std::string& uri) {
    put(meshes_ / "part.gltf", tetra_that_names(uri));
    return said_of(meshes_ / "part.gltf");
  }
  static std::string said_of(const fs::path& file) {
    const auto mesh = import_mesh(file, 1.0, {10.0, 1ULL << 30U});
    if (!mesh) return mesh.error().text;
    EXPECT_EQ(mesh->mesh.triangles.size(), 4U);
    return "imported";
  }
  test::TestFolder folder_;
  fs::path meshes_ = folder_.path() / "meshes";
};

TEST_F(NamedFile, OfItsOwnFolderIsRead) {
  EXPECT_EQ(imported("beside.bin"), "imported");
  EXPECT_EQ(imported("below/deeper.bin"), "imported");
  EXPECT_EQ(imported("below/../beside.bin"), "imported");
  fs::create_symlink("below/deeper.bin", meshes_ / "linked.bin");
  EXPECT_EQ(imported("linked.bin"), "imported");
  put(meshes_ / "part.gltf", tetra_that_names("beside.bin"));
  fs::create_symlink("meshes/part.gltf", folder_.path() / "link.gltf");
  EXPECT_NE(said_of(folder_.path() / "link.gltf").find("cannot be read"), std::string::npos);
  const fs::path before = fs::current_path();
  fs::current_path(meshes_);
  EXPECT_EQ(said_of("part.gltf"), "imported");
  fs::current_path(before);
}

TEST_F(NamedFile, OfAnotherFolderIsRefusedByName) {
  fs::create_symlink("../outside.bin", meshes_ / "link.bin");
  fs::create_directory_symlink("..", meshes_ / "up");
  put(folder_.path() / "meshes2/outside.bin", kIndices);  // whose name begins as that of the folder
  for (const char* uri : {"../outside.bin", "link.bin", "up/outside.bin", "below/../../outside.bin",
                          "../meshes2/outside.bin"}) {
    const std::string said = imported(uri);
    EXPECT_NE(said.find(std::string(uri) + "', which lies outside of its folder; put it beside"),
              std::string::npos)
        << uri << ": " << said;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  }
  EXPECT_NE(imported((folder_.path() / "outside.bin").string()), "imported");
}

TEST_F(NamedFile, ThatIsNoFileIsNotWaitedFor) {
  ASSERT_EQ(mkfifo((meshes_ / "pipe.bin").c_str(), 0600), 0);
  const auto begun = std::chrono::steady_clock::now();
  EXPECT_NE(imported("pipe.bin"), "imported");
  EXPECT_NE(imported("below"), "imported");
  EXPECT_NE(imported("nowhere.bin"), "imported");
  if (test::timed()) {
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(20));
  }
}

/// What `act` returns in a process of its own, within the sandbox of a file.
int in_sandbox(const fs::path& file, const std::function<int()>& act, bool helpers = false) {
  const pid_t child = fork();
  if (child == 0) {
    const Allowance allowance{4ULL << 30U, 4ULL << 30U, 60, getppid()};
    _exit(enter_sandbox(allowance, file, helpers) ? act() : 99);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int opens(const fs::path& file, int flags) { return open(file.c_str(), flags, 0600) >= 0 ? 1 : 0; }

TEST(Sandbox, OpensNothingOutsideOfTheFolder) {
  MORTISE_NEEDS_SANDBOX;
  const test::TestFolder folder;
  const fs::path mesh = folder.path() / "meshes/a.stl", other = folder.path() / "outside.bin";
  put(mesh, "x");
  put(other, "x");
  EXPECT_EQ(in_sandbox(mesh, [&] { return opens(mesh, O_RDONLY); }), 1);
  EXPECT_EQ(in_sandbox(mesh, [&] { return opens(mesh, O_RDWR); }), 0);
  EXPECT_EQ(in_sandbox(mesh, [&] { return opens(mesh, O_RDONLY | O_TRUNC); }), 0);
  EXPECT_EQ(in_sandbox(mesh, [&] { return opens(mesh.parent_path() / "n", O_CREAT); }), 0);
  EXPECT_EQ(in_sandbox(mesh, [&] { return unlink(mesh.c_str()) == 0 ? 1 : 0; }), 0);
  EXPECT_TRUE(fs::exists(mesh));
  EXPECT_EQ(in_sandbox(folder.path() / "missing.stl", [] { return 1; }), 99);
  const int landlock = static_cast<int>(syscall(444, nullptr, 0, 1));  // its version
  if (landlock < 1) GTEST_SKIP() << "machine: a kernel without Landlock";
  EXPECT_EQ(in_sandbox(mesh, [&] { return opens(other, O_RDONLY); }), 0);
  EXPECT_EQ(in_sandbox(mesh, [&] { return opens("/etc/passwd", O_RDONLY); }), 0);
  EXPECT_EQ(in_sandbox(mesh, [&] { return opens("/proc/self/maps", O_RDONLY); }), 0);
}

TEST(Sandbox, DoesNothingButCompute) {
  MORTISE_NEEDS_SANDBOX;
  const test::TestFolder folder;
  const fs::path mesh = folder.path() / "a.stl";
  put(mesh, "x");
  const auto can = [&](const std::function<bool()>& act, bool helpers = false) {
    return in_sandbox(
               mesh, [&] { return act() ? 1 : 0; }, helpers) == 1;
  };
  for (const bool helpers : {false, true}) {
    EXPECT_FALSE(can([] { return socket(AF_INET, SOCK_DGRAM, 0) >= 0; }, helpers));
    EXPECT_FALSE(can([] { return socket(AF_UNIX, SOCK_STREAM, 0) >= 0; }, helpers));
    EXPECT_FALSE(can([] { return kill(getppid(), 0) == 0; }, helpers));
    EXPECT_FALSE(can([] { return setpgid(0, getppid()) == 0; }, helpers));
    EXPECT_FALSE(can([] { return execl("/bin/true", "true", nullptr) == 0; }, helpers));
    EXPECT_FALSE(can(
        [] {
          return mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC,
                      MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) != MAP_FAILED;
        },
        helpers));
  }
  EXPECT_FALSE(can([] { return fork() >= 0; }));
  EXPECT_TRUE(can(
      [] {
        const pid_t helper = fork();
        if (helper == 0) _exit(socket(AF_INET, SOCK_DGRAM, 0) >= 0 ? 1 : 0);
        int status = 1;
        return helper > 0 && waitpid(helper, &status, 0) == helper && status == 0;
      },
      true));
  EXPECT_EQ(in_sandbox(mesh, []() -> int { abort(); }), 128 + SIGABRT);
}

TEST(Sandbox, EndsWithItsParent) {
  const test::TestFolder folder;
  put(folder.path() / "a.stl", "x");
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    if (fork() == 0) {
      const bool in =
          enter_sandbox({4ULL << 30U, 4ULL << 30U, 60, getppid()}, folder.path() / "a.stl");
      (void)!write(ends[1], in ? "y" : "n", 1);
      for (;;) sleep(1);
    }
    for (;;) pause();
  }
  close(ends[1]);
  char said = 0;
  ASSERT_EQ(read(ends[0], &said, 1), 1);
  EXPECT_EQ(said, 'y');
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  EXPECT_EQ(read(ends[0], &said, 1), 0);  // which returns when both have ended
  close(ends[0]);
}

TEST(Sandbox, MemoryGrowsWithTheFile) {
  constexpr std::uint64_t kMost = 4ULL << 30U;
  EXPECT_EQ(memory_for(65, kMost) >> 20U, 1024U);
  EXPECT_EQ(memory_for(16U << 20U, kMost) >> 20U, 2048U);
  EXPECT_EQ(memory_for(UINT64_MAX, kMost), kMost);
  EXPECT_EQ(memory_for(0, 1000), 1000U);
  const auto back = allowance_of(word_of({1, 2, 3, 4}));
  ASSERT_TRUE(back);
  EXPECT_EQ(word_of(*back), "1:2:3:4");
  EXPECT_FALSE(allowance_of("1:2:3"));
}

TEST(Sandbox, ProcessorTimeAndMemoryEnd) {
  MORTISE_NEEDS_SANDBOX;
  const test::TestFolder folder;
  put(folder.path() / "a.stl", "x");
  const auto ended = [&](const Allowance& allowance, const auto& act) {
    const pid_t child = fork();
    if (child == 0) {
      Allowance own = allowance;
      own.parent = getppid();
      _exit(enter_sandbox(own, folder.path() / "a.stl") ? act() : 99);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  };
  EXPECT_EQ(ended({1ULL << 30U, 1ULL << 30U, 1, 0},
                  [] {
                    for (;;) std::atomic_signal_fence(std::memory_order_seq_cst);
                    return 0;
                  }),
            128 + SIGXCPU);
  // As for a file of a megabyte; then another one comes, of eight.
  const auto room = [] {
    void* block = mmap(nullptr, 600U << 20U, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return block != MAP_FAILED;
  };
  EXPECT_EQ(ended({512U << 20U, 1ULL << 30U, 9, 0},
                  [&] {
                    const bool before = room();
                    grant_memory_for(8U << 20U);
                    const bool after = room();
                    grant_memory_for(UINT64_MAX);
                    return granted_memory_bytes() == 1ULL << 30U && !before && after ? 1 : 0;
                  }),
            1);
}

}  // namespace
}  // namespace mortise
