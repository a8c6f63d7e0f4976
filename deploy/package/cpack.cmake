# What CPack needs to know to make a Debian package of the folder that ../package.sh has laid out, beside what it says itself:
# version, maintainer, that folder.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME cairn)
set(CPACK_PACKAGE_FILE_NAME cairn)  # while it is made
set(CPACK_PACKAGE_VENDOR Cairn)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "maps from robot logs")
set(CPACK_PACKAGE_DESCRIPTION
"Cairn turns robot logs into maps and learned landmarks, as batch jobs cut
into tasks that run on one machine or on many and give the same bits on either.
.
It takes poor sensors: odometry of any quality, landmarks that all look alike,
sonars, lasers. The package holds the command cairn, the worker that computes,
and services of systemd for both, which nothing starts by itself.")
set(CPACK_PACKAGING_INSTALL_PREFIX /)
set(CPACK_INCLUDE_TOPLEVEL_DIRECTORY OFF)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS adduser)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
foreach(file IN ITEMS conffiles postinst prerm postrm)
  list(APPEND CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/${file})
endforeach()
