# The same targets under libFuzzer: bounded runs as tests, longer ones by hand, e.g.
#   build/release/bin/wire_fuzz -max_total_time=600 found tests/fuzz/corpus/wire
# In the preset "fuzz" clang compiles everything, with sanitizers. Elsewhere it compiles what reads strange bytes, with sanitizers and
# coverage, and takes the rest from the libraries of the build: that costs a minute instead of a quarter of an hour.
option(MORTISE_LIBFUZZER "All is compiled by clang for libFuzzer (preset fuzz)" OFF)
find_program(CLANGXX NAMES clang++ clang++-14)
if(CLANGXX)
  execute_process(COMMAND ${CLANGXX} -print-file-name=libclang_rt.fuzzer-${CMAKE_SYSTEM_PROCESSOR}.a OUTPUT_VARIABLE FUZZER_RUNTIME
    OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT IS_ABSOLUTE "${FUZZER_RUNTIME}")  # by name only: it looked and found none
    file(GLOB FUZZER_RUNTIME /usr/lib/llvm-*/lib/clang/*/lib/linux/libclang_rt.fuzzer-${CMAKE_SYSTEM_PROCESSOR}.a)
  endif()
endif()
if(NOT FUZZER_RUNTIME)
  set(none "skipped: no clang++ with the runtime of libFuzzer here; ./mortise setup installs clang and libclang-rt-14-dev")
  message(STATUS "libFuzzer: ${none}")
  add_test(NAME libfuzzer COMMAND ${CMAKE_COMMAND} -E echo ${none})
  set_tests_properties(libfuzzer PROPERTIES SKIP_REGULAR_EXPRESSION "skipped: ")
  return()
endif()
if(MORTISE_SANITIZE AND NOT MORTISE_LIBFUZZER)
  return()  # the sanitizers of another compiler; the runs of wire_fuzz_test are in this build
endif()

# fuzz_driver(name RUNS n SOURCES files): bin/NAME_fuzz, and its bounded run. SOURCES are compiled again by clang.
function(fuzz_driver name)
  cmake_parse_arguments(F "" "RUNS" "SOURCES" ${ARGN})
  set(driver ${name}_fuzz)
  add_executable(${driver} libfuzzer_main.cpp)
  target_compile_definitions(${driver} PRIVATE MORTISE_FUZZ_TARGET=fuzz_${name})
  if(MORTISE_LIBFUZZER)
    target_link_libraries(${driver} PRIVATE fuzz_${name}_target -fsanitize=fuzzer)
  else()
    set(instrumented -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined)
    target_sources(${driver} PRIVATE ${F_SOURCES})
    target_compile_options(${driver} PRIVATE ${instrumented} -O1 -g1 -w)
    # The libraries hold the same functions without instruments, in batches with others that are needed: the first ones count.
    target_link_options(${driver} PRIVATE -fsanitize=fuzzer,address,undefined LINKER:-z,muldefs)
    target_link_libraries(${driver} PRIVATE $<TARGET_PROPERTY:fuzz_${name}_target,LINK_LIBRARIES>)
    set(instead ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/instead_of_compiler.sh ${CLANGXX})
    set_target_properties(${driver} PROPERTIES CXX_COMPILER_LAUNCHER "${instead}" CXX_LINKER_LAUNCHER "${instead}")
  endif()
  # What is found goes into the build, never into the corpus that is kept.
  set(found ${CMAKE_CURRENT_BINARY_DIR}/found_${name})
  file(MAKE_DIRECTORY ${found})
  add_test(NAME ${name}_libfuzzer COMMAND ${driver} -runs=${F_RUNS} -max_total_time=25 -seed=1 -max_len=32768 -print_final_stats=1
    -artifact_prefix=${found}/ ${found} ${CMAKE_CURRENT_SOURCE_DIR}/corpus/${name})
  set_tests_properties(${name}_libfuzzer PROPERTIES TIMEOUT 120)
endfunction()

set(root ${CMAKE_SOURCE_DIR})
fuzz_driver(wire RUNS 400000 SOURCES wire_target.cpp ${root}/tests/unit/idl/samples.cpp ${root}/idl/datagram_guard.cpp ${root}/idl/convert.cpp
  ${root}/idl/chunks.cpp
  ${root}/server/tick_bytes.cpp ${root}/common/io/log/log_records.cpp)
fuzz_driver(inbox RUNS 200000 SOURCES inbox_target.cpp ${root}/server/inbox.cpp ${root}/server/increment_admission.cpp ${root}/server/command_queue.cpp
  ${root}/server/increment_order.cpp ${root}/server/sequence_window.cpp
  ${root}/common/session/world/commands.cpp ${root}/common/session/world/decisions.cpp ${root}/common/session/world/move_history.cpp)
fuzz_driver(log RUNS 200000 SOURCES log_target.cpp ${root}/common/io/log/mcap_reader.cpp ${root}/common/io/log/log_records.cpp
  ${root}/common/io/log/log_json.cpp ${root}/common/io/log/session_log_read.cpp ${root}/common/io/log/session_log_recover.cpp
  ${root}/common/io/log/log_checkpoint.cpp)
