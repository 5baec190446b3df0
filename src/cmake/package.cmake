# Packages for machines that have nothing of ours: a .deb and a .tar.gz, both made by `cmake --build BUILD --target package`
# (preset `package`). They hold MuJoCo's library and the shared libraries that the program and the library need (FCL, assimp,
# libpng, and theirs), with the licence of each: the names and versions of those differ from one distribution to the next,
# and one package is to run on all. What stays outside: the C and C++ runtime, and EGL, which only --png asks for.

# Libraries are copied when this component is installed, which `cmake --install BUILD` alone does not.
install(CODE "
  set(program \"$<$<TARGET_EXISTS:mjcf-pdg>:$<TARGET_FILE:mjcf-pdg>>\")
  set(library \"$<$<STREQUAL:$<TARGET_PROPERTY:mjcf_pdg,TYPE>,SHARED_LIBRARY>:$<TARGET_FILE:mjcf_pdg>>\")
  set(own_names \"$<TARGET_FILE_NAME:mujoco::mujoco>\" \"$<TARGET_FILE_NAME:mjcf_pdg>\")
  set(library_dir \"${private_dir}/bundled\")
  set(licence_dir \"${CMAKE_INSTALL_DOCDIR}/bundled\")
  include(\"${PROJECT_SOURCE_DIR}/src/cmake/bundle_libraries.cmake\")"
  COMPONENT bundled_libraries EXCLUDE_FROM_ALL)

set(CPACK_GENERATOR "DEB;TGZ")
set(CPACK_PACKAGE_NAME mjcf-pdg)
set(CPACK_PACKAGE_VENDOR "mjcf-pdg")
set(CPACK_PACKAGE_CONTACT "the developers of mjcf-pdg")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};mjcf_pdg;ALL;/"
                                 "${PROJECT_BINARY_DIR};mjcf_pdg;bundled_libraries;/")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)  # finds the C and C++ runtime's least versions
set(CPACK_PROJECT_CONFIG_FILE "${PROJECT_SOURCE_DIR}/src/cmake/package_options.cmake")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libegl1, libgl1-mesa-dri")  # pictures
include(CPack)
