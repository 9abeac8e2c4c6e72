// mortise-import: reads one mesh file for another program of the house and writes its triangles to
// stdout. Not meant for people. It runs alone, with limits, because a hostile file can crash the
// reader.
#include <unistd.h>

#include <exception>
#include <new>
#include <optional>
#include <string>

#include "common/io/mesh/importer/read_with_assimp.h"
#include "common/io/mesh/sandbox.h"

namespace {

mortise::RawSoup too_much_memory() {
  mortise::RawSoup soup;
  soup.refusal = "reading it needs more than " +
                 std::to_string(mortise::granted_memory_bytes() >> 20U) +
                 " MB of memory; the file is damaged, or holds far more than its size says";
  return soup;
}

}  // namespace

int main(int argc, char** argv) {
  const auto allowed = argc == 4 ? mortise::allowance_of(argv[3]) : std::nullopt;
  if (!allowed) return 2;  // file, extension, what it may use
  if (!mortise::enter_sandbox(*allowed, argv[1])) return 1;
  mortise::RawSoup soup;
  try {
    soup = mortise::read_with_assimp(argv[1], argv[2]);
    if (soup.refusal.find("bad_alloc") == std::string::npos)
      return mortise::write_all(STDOUT_FILENO, mortise::encode(soup)) ? 0 : 1;
    soup = too_much_memory();  // assimp's own words for it
  } catch (const std::bad_alloc&) {
    soup = too_much_memory();
  } catch (const std::exception& error) {
    soup = {};
    soup.refusal = error.what();
  }
  return mortise::write_all(STDOUT_FILENO, mortise::encode(soup)) ? 0 : 1;
}
