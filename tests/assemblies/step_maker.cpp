// Makes the STEP assemblies that tests ask for, writes one again, and tells what OpenCASCADE says
// of one. A program of its own, because nothing else links OpenCASCADE.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/assemblies/exact_pairs.h"
#include "tests/assemblies/made_assemblies.h"

int main(int argc, char** argv) {
  using namespace mortise::test;
  const auto is = [&](const char* command, int arguments) {
    return argc == 2 + arguments && std::string(argv[1]) == command;
  };
  bool well = false;
  if (is("tensioner", 1)) well = write_tensioner(argv[2]);
  if (is("arm", 2)) well = write_arm(argv[2], std::atoi(argv[3]));
  if (is("random", 2)) well = write_random(argv[2], std::atoi(argv[3]));
  if (is("odd", 2)) well = write_odd(argv[2], argv[3]);
  if (is("rewrite", 2)) well = rewrite(argv[2], argv[3]);
  if (is("exact", 1)) well = print_exact_pairs(argv[2]);
  std::fflush(stdout);
  _exit(well ? 0 : 1);
}
