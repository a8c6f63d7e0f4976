# Compiler settings that every Cairn target shares, as the interface target cairn::flags.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# Debug information stays in the binaries of the release build only where asked for: it doubles link time.
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
if(CAIRN_SANITIZE)
  # Enough for stack traces with line numbers, at half the build time of -O2 -g.
  set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1")
endif()

if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(CAIRN_MARCH "x86-64-v3" CACHE STRING "Target of -march")
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  set(CAIRN_MARCH "armv8-a" CACHE STRING "Target of -march")
else()
  set(CAIRN_MARCH "" CACHE STRING "Target of -march")
endif()
set(CAIRN_TESTS "" CACHE STRING "Folders whose unit tests are built, as regular expressions (worker;schema.*); empty: all, end to end too")
set(CAIRN_SANITIZE "" CACHE STRING "Sanitizers, as -fsanitize takes them: address,undefined or thread")
# A user's compiler may warn of what ours does not; our checks (deploy/test.sh --all, the sanitizers' presets) switch it on.
option(CAIRN_WERROR "Warnings are errors" OFF)
option(CAIRN_UNITY "Several sources are compiled at a time; OFF for tools that look at one alone (clang-tidy, mutate.py)" ON)

find_program(CAIRN_CCACHE ccache)
if(CAIRN_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CAIRN_CCACHE})
endif()

add_library(cairn_flags INTERFACE)
add_library(cairn::flags ALIAS cairn_flags)
target_compile_options(cairn_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wnon-virtual-dtor
  # Compiled together, a name in one source seems to shadow another's.
  $<$<NOT:$<BOOL:${CAIRN_UNITY}>>:-Wshadow>
  $<$<BOOL:${CAIRN_WERROR}>:-Werror>
  # GCC tidies its memory less often: a tenth of its time, for a fifth more memory.
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-expand=300>
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=262144>
  # Same bits everywhere: no contraction behind our back, fma only where written.
  -ffp-contract=off
  $<$<BOOL:${CAIRN_MARCH}>:-march=${CAIRN_MARCH}>)
target_compile_definitions(cairn_flags INTERFACE
  CAIRN_VERSION="${PROJECT_VERSION}" CAIRN_MARCH="${CAIRN_MARCH}")
target_include_directories(cairn_flags INTERFACE ${CMAKE_SOURCE_DIR})
if(CAIRN_SANITIZE)
  target_compile_options(cairn_flags INTERFACE -fsanitize=${CAIRN_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all
    # In libstdc++'s own std::stable_sort.
    $<$<CXX_COMPILER_ID:Clang>:-Wno-deprecated-declarations>)
  target_link_options(cairn_flags INTERFACE -fsanitize=${CAIRN_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND NOT CAIRN_SANITIZE MATCHES "fuzzer")
    # The runtime within the program would bring an operator new that allocations_testing.cc cannot replace.
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-resource-dir OUTPUT_VARIABLE resources
      OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    target_link_options(cairn_flags INTERFACE -shared-libsan -Wl,-rpath,${resources}/lib/linux)
  endif()
  target_compile_definitions(cairn_flags INTERFACE CAIRN_SANITIZED)
endif()

add_library(cairn_cpu_check OBJECT ${CMAKE_SOURCE_DIR}/cmake/cpu_check.cc)
target_compile_definitions(cairn_cpu_check PRIVATE $<$<STREQUAL:${CAIRN_MARCH},x86-64-v3>:CAIRN_NEEDS_X86_64_V3>)
