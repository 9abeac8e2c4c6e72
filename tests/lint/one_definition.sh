#!/usr/bin/env bash
# A Debug build of the server and of the session's tests that the linker looks at as one program: a type that two files
# define differently is an error (-Wodr), and the tests run without optimisation and with Eigen's assertions, where such a
# clash shows itself. A build of its own: minutes, so it belongs to the soak tier. Folder of the build: $1.
set -eu
cd "$(dirname "$0")/../.."
build=${1:?usage: one_definition.sh BUILD_FOLDER}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-Og \
  -DCMAKE_CXX_FLAGS="-flto -Wodr -Werror=odr" \
  -DCMAKE_AR="$(command -v gcc-ar)" -DCMAKE_RANLIB="$(command -v gcc-ranlib)" > "$build.log"
cmake --build "$build" --target mortise-server test_session
"$build/bin/test_session" --gtest_brief=1
