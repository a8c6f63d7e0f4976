# What CPack needs to know to make a Debian package of the folder that ../package.sh has laid out, beside what it says itself:
# version, maintainer, that folder. The environment's PACKAGE is the package's name; DEPENDS, what it needs beside libraries.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME $ENV{PACKAGE})
set(CPACK_DEBIAN_PACKAGE_DEPENDS $ENV{DEPENDS})
set(CPACK_PACKAGE_FILE_NAME cairn)  # while it is made
set(CPACK_PACKAGE_VENDOR Cairn)
set(CPACK_PACKAGING_INSTALL_PREFIX /)
set(CPACK_INCLUDE_TOPLEVEL_DIRECTORY OFF)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

if(CPACK_PACKAGE_NAME STREQUAL cairn-images)
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "maps from robot logs: images")
  set(CPACK_PACKAGE_DESCRIPTION
"What \"cairn import images\" decodes images with, and what finds AprilTags
for \"cairn import bag --tags\". It is apart from cairn since
OpenCV's decoders depend on much that nothing else there needs.")
else()
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "maps from robot logs")
  set(CPACK_PACKAGE_DESCRIPTION
"Cairn turns robot logs into maps and learned landmarks, as batch jobs cut
into tasks that run on one machine or on many and give the same bits on either.
.
It takes poor sensors: odometry of any quality, landmarks that all look alike,
sonars, lasers. The package holds the command cairn, the worker that computes,
services of systemd for both, which nothing starts by itself, and the Python
package cairn, which needs python3-h5py.")
  set(CPACK_DEBIAN_PACKAGE_SUGGESTS "cairn-images, python3-h5py, python3-matplotlib")
  foreach(file IN ITEMS conffiles postinst prerm postrm)
    list(APPEND CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/${file})
  endforeach()
endif()
