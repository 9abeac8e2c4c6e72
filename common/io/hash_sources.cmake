# cmake -DROOT=<tree> -DOUT=<file.cpp> -P hash_sources.cmake: one hash over everything that decides a verdict, so that a
# log knows whether it was recorded by these very sources. OUT.d names the sources and their folders for the build: a folder
# changes when a source comes or goes.
file(GLOB_RECURSE sources RELATIVE ${ROOT} ${ROOT}/common/*.h ${ROOT}/common/*.cpp)
list(SORT sources)
set(all "")
set(depends "")
foreach(source IN LISTS sources)
  file(SHA256 ${ROOT}/${source} hash)
  string(APPEND all "${source} ${hash}\n")
  get_filename_component(folder ${ROOT}/${source} DIRECTORY)
  list(APPEND depends ${ROOT}/${source} ${folder})
endforeach()
list(REMOVE_DUPLICATES depends)
list(JOIN depends " " depends)
string(SHA256 hash "${all}")
string(SUBSTRING ${hash} 0 32 hash)
file(WRITE ${OUT}.d "${OUT}: ${depends}\n")
file(CONFIGURE OUTPUT ${OUT} CONTENT "namespace mortise {\nextern const char* const kEngineSources;\nconst char* const kEngineSources = \"${hash}\";\n}  // namespace mortise\n")
