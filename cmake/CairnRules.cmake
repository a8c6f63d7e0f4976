# Which folder may link what: the table of folders as CMake sees it. tests/house/include_rules_test.cc holds the same
# table against every #include line; this one stops a wrong link line when the build is configured.
#
# CAIRN_LINKS_<folder>: regular expressions of folders of our own, and of targets of others.
set(CAIRN_LINKS_schema "Eigen3::.*|protobuf::.*|PkgConfig::CAIRN_XXHASH|cairn_proto")
set(CAIRN_LINKS_schema_store "schema|PkgConfig::CAIRN_HDF5")
set(CAIRN_LINKS_schema_wire "schema|PkgConfig::CAIRN_ZMQ")
set(CAIRN_LINKS_pipelines "schema|pipelines(/.*)?|Eigen3::.*|cairn::opencv_(core|imgproc)")
set(CAIRN_LINKS_datasets_common "schema(/store)?|ZLIB::.*")
set(CAIRN_LINKS_datasets_inspect "schema/store|datasets/common|nlohmann_json::.*")
set(CAIRN_LINKS_datasets_import "datasets/common|ZLIB::.*")
set(CAIRN_LINKS_datasets_simulate "datasets/(common|simulate)")
set(CAIRN_LINKS_datasets_simulate_corridor "datasets/(common|simulate)|pipelines/image_features")
set(CAIRN_LINKS_datasets_evaluate "datasets/common|datasets/evaluate/.*|nlohmann_json::.*")
set(CAIRN_LINKS_datasets_evaluate_matching "datasets/common")
set(CAIRN_LINKS_datasets_evaluate_maps "datasets/common|datasets/evaluate/matching")
set(CAIRN_LINKS_datasets_report
  "schema/store|datasets/common|datasets/evaluate(/.*)?|cairn::opencv_(core|imgproc)")
set(CAIRN_LINKS_datasets_export "schema/store|datasets/(common|evaluate/maps|report)|Eigen3::.*")
set(CAIRN_LINKS_datasets_reproduce "datasets/(common|report)|datasets/(evaluate|simulate)(/.*)?")
set(CAIRN_LINKS_datasets_images "datasets/import|cairn::opencv_(core|imgcodecs)")
set(CAIRN_LINKS_worker
  "schema(/.*)?|pipelines|worker(/.*)?|CLI11::.*|spdlog::.*|nlohmann_json::.*|Threads::Threads")
# The client; then the folders of the service, each built on those before it.
set(CAIRN_LINKS_coordinator "schema/wire")
set(CAIRN_LINKS_coordinator_core "schema")
set(CAIRN_LINKS_coordinator_store "schema(/.*)?|coordinator/core|SQLite::.*|Threads::Threads")
set(CAIRN_LINKS_coordinator_server "schema(/.*)?|coordinator/(core|store)")
set(CAIRN_LINKS_coordinator_local "schema(/.*)?|coordinator/(core|store|server)|Threads::Threads")
set(CAIRN_LINKS_coordinator_cli "schema(/.*)?|coordinator/cli/.*|CLI11::.*")
set(CAIRN_LINKS_coordinator_cli_common "schema(/.*)?|CLI11::.*")
set(CAIRN_LINKS_coordinator_cli_job_file
  "schema(/.*)?|coordinator|coordinator/(core|cli/common)|datasets/common|CLI11::.*|yaml-cpp(::.*)?|nlohmann_json::.*")
set(CAIRN_LINKS_coordinator_cli_output
  "schema(/.*)?|coordinator|coordinator/(store|cli/(common|job_file))|spdlog::.*|nlohmann_json::.*")
set(CAIRN_LINKS_coordinator_cli_commands
  "schema(/.*)?|coordinator|coordinator/(core|store|server|local|cli/(common|job_file|output))|datasets/.*|CLI11::.*|nlohmann_json::.*")
set(CAIRN_LINKS_coordinator_cli_commands_import
  "schema/store|coordinator/cli/(common|job_file|output)|datasets/(common|import)|CLI11::.*|nlohmann_json::.*")
set(CAIRN_LINKS_coordinator_cli_commands_simulate
  "schema/store|coordinator/cli/(common|output)|datasets/simulate(/.*)?|CLI11::.*")
set(CAIRN_LINKS_tests ".*")


# The expression for a folder: its own, or that of the nearest folder above it.
function(cairn_links_of folder result)
  while(folder)
    string(REPLACE "/" "_" key "${folder}")
    if(DEFINED CAIRN_LINKS_${key})
      set(${result} "${CAIRN_LINKS_${key}}" PARENT_SCOPE)
      return()
    endif()
    cmake_path(GET folder PARENT_PATH folder)
  endwhile()
  set(${result} "" PARENT_SCOPE)
endfunction()

# Every library and program of ours, after all folders have been read.
function(cairn_check_links)
  get_property(targets GLOBAL PROPERTY CAIRN_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(directory ${target} SOURCE_DIR)
    cmake_path(RELATIVE_PATH directory BASE_DIRECTORY ${CMAKE_SOURCE_DIR} OUTPUT_VARIABLE folder)
    cairn_links_of("${folder}" allowed)
    get_target_property(links ${target} LINK_LIBRARIES)
    foreach(link IN LISTS links)
      set(what "${link}")
      if(link STREQUAL "cairn::flags")
        continue()
      endif()
      if(TARGET ${link} AND NOT link MATCHES "::|^cairn_proto$")
        get_target_property(imported ${link} IMPORTED)
        if(NOT imported)
          get_target_property(link_directory ${link} SOURCE_DIR)
          cmake_path(RELATIVE_PATH link_directory BASE_DIRECTORY ${CMAKE_SOURCE_DIR} OUTPUT_VARIABLE what)
        endif()
      endif()
      if(NOT what STREQUAL folder AND NOT what MATCHES "^(${allowed})$")
        message(SEND_ERROR "${folder}/CMakeLists.txt: ${target} may not link ${link} (cmake/CairnRules.cmake)")
      endif()
    endforeach()
  endforeach()
endfunction()
