# cmake -D ROOT=… -D FILES=a;b;… -D OUT=… -P hash_sources.cmake: a header with the hash of those files (names below ROOT).
set(all "")
foreach(file ${FILES})
  file(SHA256 ${ROOT}/${file} hash)
  string(APPEND all "${hash} ${file}\n")
endforeach()
string(SHA256 hash "${all}")
string(SUBSTRING ${hash} 0 16 hash)
file(WRITE ${OUT} "// Made by cmake/hash_sources.cmake.\n#pragma once\n#define CAIRN_SOURCES \"${hash}\"\n")
