#include "common/io/build_info.h"

#include "common/base/hash.h"

// Set for this file by common/io/CMakeLists.txt.
#if !defined(MORTISE_VERSION) || !defined(MORTISE_BUILD_TYPE) || !defined(MORTISE_COMPILE_FLAGS)
#error "the build must say version, build type and flags"
#endif

namespace mortise {

extern const char* const kEngineSources;  // written by hash_sources.cmake

namespace {

std::string architecture() {
#if defined(__x86_64__)
  return "x86_64";
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "other";
#endif
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __VERSION__;
#elif defined(__GNUC__)
  return "gcc " __VERSION__;
#else
  return "other";
#endif
}

}  // namespace

std::string engine_version() { return MORTISE_VERSION; }

std::map<std::string, std::string> build_info() {
  return {{"engine_version", engine_version()}, {"compiler", compiler()},
          {"build_type", MORTISE_BUILD_TYPE},   {"flags", MORTISE_COMPILE_FLAGS},
          {"architecture", architecture()},     {"sources", kEngineSources},
          {"fingerprint", build_fingerprint()}};
}

std::string toolchain_fingerprint() {
  const std::string all =
      compiler() + '\n' + MORTISE_BUILD_TYPE + '\n' + MORTISE_COMPILE_FLAGS + '\n' + architecture();
  return content_hash(std::as_bytes(std::span(all)));
}

std::string build_fingerprint() {
  const std::string all = engine_version() + '\n' + kEngineSources + '\n' + toolchain_fingerprint();
  return content_hash(std::as_bytes(std::span(all)));
}

std::string version_line(const std::string& program) {
  constexpr std::size_t kDigits = 12;  // enough to tell builds apart, short enough to read out
  return program + ' ' + engine_version() + ", build " + build_fingerprint().substr(0, kDigits);
}

}  // namespace mortise
