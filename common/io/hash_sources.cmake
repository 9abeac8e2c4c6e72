# cmake -DROOT=<tree> -DOUT=<file.cpp> -P hash_sources.cmake: one hash over everything that decides a verdict, so that a
# log knows whether it was recorded by these very sources.
file(GLOB_RECURSE sources RELATIVE ${ROOT} ${ROOT}/common/*.h ${ROOT}/common/*.cpp)
list(SORT sources)
set(all "")
foreach(source IN LISTS sources)
  file(SHA256 ${ROOT}/${source} hash)
  string(APPEND all "${source} ${hash}\n")
endforeach()
string(SHA256 hash "${all}")
string(SUBSTRING ${hash} 0 32 hash)
file(WRITE ${OUT} "namespace mortise {\nextern const char* const kEngineSources;\nconst char* const kEngineSources = \"${hash}\";\n}  // namespace mortise\n")
