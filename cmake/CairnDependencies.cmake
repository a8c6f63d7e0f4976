# Debian's packages as imported targets cairn::*; each folder links only what DESIGN allows it.
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Protobuf 3.21 REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(ZLIB REQUIRED)
find_package(SQLite3 REQUIRED)

pkg_check_modules(CAIRN_ZMQ REQUIRED IMPORTED_TARGET libzmq)
pkg_check_modules(CAIRN_XXHASH REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(CAIRN_MICROHTTPD REQUIRED IMPORTED_TARGET libmicrohttpd)
# Debian calls the serial build so; what it calls hdf5 may be one for MPI.
pkg_search_module(CAIRN_HDF5 REQUIRED IMPORTED_TARGET hdf5-serial hdf5)

# Debian packs OpenCVConfig.cmake only with the 673 MB of libopencv-dev; the parts that we use need no more than this.
find_path(CAIRN_OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(part core imgproc imgcodecs)
  find_library(CAIRN_OPENCV_${part} opencv_${part} REQUIRED)
  add_library(cairn_opencv_${part} INTERFACE)
  add_library(cairn::opencv_${part} ALIAS cairn_opencv_${part})
  target_include_directories(cairn_opencv_${part} SYSTEM INTERFACE ${CAIRN_OPENCV_INCLUDE})
  target_link_libraries(cairn_opencv_${part} INTERFACE ${CAIRN_OPENCV_${part}})
endforeach()

if(BUILD_TESTING OR NOT DEFINED BUILD_TESTING)
  find_package(GTest REQUIRED)
endif()
