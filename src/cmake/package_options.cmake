# Read by CPack once for each kind of package. dpkg-shlibdeps must look for what we bundle in the package itself.
if(CPACK_GENERATOR STREQUAL "DEB")
  set(root "${CPACK_TEMPORARY_DIRECTORY}${CPACK_PACKAGING_INSTALL_PREFIX}/lib")
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${root}" "${root}/mjcf_pdg/mujoco" "${root}/mjcf_pdg/bundled")
endif()
