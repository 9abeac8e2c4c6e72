// What a program of this build says of itself with --version, for those that are scripts.
#include <iostream>

#include "common/io/build_info.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::cout << mortise::version_line(argv[1]) << "\n";
}
