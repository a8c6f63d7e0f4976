# With CAIRN_UNITY the sources of a target are compiled so many at a time: most of what a compiler does with one of ours is
# the standard library's templates, again for each file.
# As many as a folder may have; of tests fewer, each takes the compiler more memory.
set(CMAKE_UNITY_BUILD_BATCH_SIZE 30)
set(CAIRN_TEST_BATCH_SIZE 12)

# What no user waits for is optimised less, which takes the compiler two fifths less time, with sanitizers not at all. The bits
# of results are the same.
if(CAIRN_SANITIZE)
  set(CAIRN_COLD -O0)
else()
  set(CAIRN_COLD $<$<CONFIG:Release>:-Og>)
endif()

# cairn_library(NAME [COLD] SOURCES … DEPS …): one target per folder, its sources listed.
function(cairn_library name)
  cmake_parse_arguments(ARG "COLD" "" "SOURCES;DEPS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC cairn::flags ${ARG_DEPS})
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${CAIRN_UNITY})
  # Under a sanitizer only what computes is worth optimising.
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${CMAKE_SOURCE_DIR} OUTPUT_VARIABLE folder)
  if(ARG_COLD OR (CAIRN_SANITIZE AND NOT folder MATCHES "^pipelines"))
    target_compile_options(${name} PRIVATE ${CAIRN_COLD})
  endif()
  set_property(GLOBAL APPEND PROPERTY CAIRN_TARGETS ${name})
endfunction()

# cairn_program(NAME SOURCES … DEPS …): an executable that is installed. Says so plainly on a CPU below its target.
function(cairn_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES} $<TARGET_OBJECTS:cairn_cpu_check>)
  target_link_libraries(${name} PRIVATE cairn::flags ${ARG_DEPS})
  set_property(GLOBAL APPEND PROPERTY CAIRN_TARGETS ${name})
  # All programs in one folder, as when they are installed: `cairn` looks for cairn-worker beside itself.
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  install(TARGETS ${name} RUNTIME)
endfunction()

# cairn_test(NAME SOURCES … DEPS … [LABELS …] [PARTS N] [UNSANITIZED …]): one GoogleTest program per folder, a ctest entry per
# test. PARTS: an entry is one of so many parts of all tests, for they share what takes long to make. In a sanitizer's
# build, where a process takes long to start, there are two parts, which carry the sanitizer's name. UNSANITIZED: patterns
# of tests that compute for many seconds what shorter ones compute too; a sanitizer's build leaves them out.
include(GoogleTest)
# A limit is for tests that hang, not for slow machines: five times what a test may take on a loaded machine of two cores.
set(CAIRN_TEST_LIMIT_S 1500)
set(CAIRN_LONG_TEST_LIMIT_S 4500)
add_custom_target(cairn_unit_tests COMMENT "the unit tests")
function(cairn_test name)
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${CMAKE_SOURCE_DIR} OUTPUT_VARIABLE folder)
  if(NOT BUILD_TESTING)
    return()
  endif()
  string(REPLACE ";" "|" asked "${CAIRN_TESTS}")
  if(asked AND NOT folder MATCHES "^(${asked})$")
    return()
  endif()
  cmake_parse_arguments(ARG "" "PARTS" "SOURCES;DEPS;LABELS;UNSANITIZED" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE cairn::flags ${ARG_DEPS} GTest::gtest GTest::gtest_main)
  target_compile_options(${name} PRIVATE ${CAIRN_COLD})
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${CAIRN_UNITY} UNITY_BUILD_BATCH_SIZE ${CAIRN_TEST_BATCH_SIZE})
  add_dependencies(cairn_unit_tests ${name})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  set(entry "${name}")
  set(parts 2)
  if(CAIRN_SANITIZE)
    target_sources(${name} PRIVATE ${CMAKE_SOURCE_DIR}/cmake/sanitizer_options.cc)
    set(entry "${CAIRN_SANITIZE}: ${name}")
  elseif(ARG_PARTS)
    set(parts ${ARG_PARTS})
    set(ARG_UNSANITIZED "")
  else()
    set(cost 0)
    if(ARG_LABELS STREQUAL long)
      set(cost 100)  # first, as tests/end_to_end's
    endif()
    gtest_discover_tests(${name} DISCOVERY_TIMEOUT 600
      PROPERTIES TIMEOUT ${CAIRN_TEST_LIMIT_S} LABELS "${ARG_LABELS}" COST ${cost})
    return()
  endif()
  string(REPLACE ";" ":" left_out "${ARG_UNSANITIZED}")
  foreach(part RANGE 1 ${parts})
    math(EXPR index "${part} - 1")
    add_test(NAME "${entry}, part ${part} of ${parts}" COMMAND ${name} --gtest_brief=1 "--gtest_filter=-${left_out}")
    set_tests_properties("${entry}, part ${part} of ${parts}" PROPERTIES
      TIMEOUT ${CAIRN_TEST_LIMIT_S} LABELS "${ARG_LABELS}" COST 60
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${parts};GTEST_SHARD_INDEX=${index}")
  endforeach()
endfunction()
