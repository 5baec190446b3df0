# Packages for machines that have nothing of ours: a .deb and a .tar.gz, both made by `cmake --build BUILD --target package`
# (preset `package`). They hold MuJoCo's library and the shared libraries that the program and the library need (FCL, OMPL, assimp,
# libpng, giflib, and theirs), with the licence of each: the names and versions of those differ from one distribution to the next,
# and one package is to run on all. What stays outside: the C and C++ runtime, EGL, which only pictures ask for, and GLFW and
# OpenGL, which only `view` loads.

# Libraries are copied when this component is installed, which `cmake --install BUILD` alone does not.
install(CODE "
  set(program \"$<$<TARGET_EXISTS:mjcf-pdg>:$<TARGET_FILE:mjcf-pdg>>\")
  set(library \"$<$<STREQUAL:$<TARGET_PROPERTY:mjcf_pdg,TYPE>,SHARED_LIBRARY>:$<TARGET_FILE:mjcf_pdg>>\")
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
# The runtime of this machine or a newer one. (dpkg-shlibdeps would ask for the packages of what we bundle, too.)
execute_process(COMMAND getconf GNU_LIBC_VERSION OUTPUT_VARIABLE libc ERROR_QUIET)
string(REGEX MATCH "[0-9.]+" libc "${libc}")
string(REGEX MATCH "^[0-9]+" compiler "${CMAKE_CXX_COMPILER_VERSION}")
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libc6 (>= ${libc}), libgcc-s1, libstdc++6")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS " (>= ${compiler})")
endif()
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libegl1, libgl1-mesa-dri, libglfw3, libgl1")  # pictures, the window
include(CPack)
