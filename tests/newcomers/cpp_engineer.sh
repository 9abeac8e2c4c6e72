#!/usr/bin/env bash
# An engineer who writes C++: find_package(mortise COMPONENTS engine) in a project of one's own, then the components for files and sessions.
[ -e "$BUILD/lib/libmortise-engine.so" ] || skip "program absent: the shared libraries of this build"
for component in engine dev io client; do cmake --install "$BUILD" --prefix "$PWD/usr" --component $component >/dev/null; done # as the packages would
mkdir project
cat >project/CMakeLists.txt <<'CMAKE'
cmake_minimum_required(VERSION 3.25)
project(fits LANGUAGES CXX)
find_package(mortise REQUIRED COMPONENTS engine)
add_executable(fits fits.cpp)
target_link_libraries(fits PRIVATE mortise::engine)
CMAKE
cat >project/fits.cpp <<'CPP'
#include <mortise/mortise.h>

#include <cstdio>

using namespace mortise;

int main() {
  const auto plate = Part::generate("plate_with_bore", {{"bore_mm", 20}, {"facets", 32}}, "plate");
  const auto pin = Part::generate("dowel", {{"diameter_mm", 20}, {"length_mm", 40}, {"facets", 32}, {"phase_rad", 0.098}}, "pin");
  for (const char* fit : {"H7/g6", "H7/k6", "H7/p6"}) {
    Session s;
    const auto in_plate = s.add_fixed(plate), in_hand = s.add(pin, Pose(Eigen::Translation3d(0, 0, 30)));
    s.fit(in_plate, "", in_hand, "", fit);
    s.hold("ann", in_hand);
    s.place(in_hand, Pose(Eigen::Translation3d(0, 0, -10)));
    const auto judged = s.judge();
    if (!judged) return std::puts(judged.error().text.c_str()), 1;
    for (const Clash& c : judged->clashes) std::printf("%s %s: %s\n", fit, name_of(c.collision_class).c_str(), c.explanation.c_str());
  }
}
CPP
run cmake -S project -B project/build -DCMAKE_PREFIX_PATH="$PWD/usr"
run cmake --build project/build
run project/build/fits
saw '^H7/g6 fake'
saw '^H7/p6 real'
run cmake -S usr/share/doc/libmortise-dev/examples -B examples -DCMAKE_PREFIX_PATH="$PWD/usr"
run cmake --build examples
run examples/thirty_lines
saw 'H7/g6: the peg stands at z = 5.000 mm'
