// mortise-import: reads one mesh file for another program of the house and writes its triangles to
// stdout. Not meant for people. It runs alone, with limits, because a hostile file can crash the
// reader.
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <new>
#include <string>

#include "common/io/mesh/importer/confined.h"
#include "common/io/mesh/importer/read_with_assimp.h"

int main(int argc, char** argv) {
  if (argc != 5) return 2;  // file, extension, bytes of memory, seconds
  mortise::confine_this_process(std::strtoull(argv[3], nullptr, 10),
                                std::strtoull(argv[4], nullptr, 10));
  mortise::RawSoup soup;
  try {
    soup = mortise::read_with_assimp(argv[1], argv[2]);
    return mortise::write_all(STDOUT_FILENO, mortise::encode(soup)) ? 0 : 1;
  } catch (const std::bad_alloc&) {
    soup = {};
    soup.refusal = "std::bad_alloc";
  } catch (const std::exception& error) {
    soup = {};
    soup.refusal = error.what();
  }
  return mortise::write_all(STDOUT_FILENO, mortise::encode(soup)) ? 0 : 1;
}
