# Install rules: library, headers, program, CMake package. The installed folder can be moved.

include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/mjcf_pdg")

if(CMAKE_VERSION VERSION_GREATER_EQUAL 3.24)
  install(TARGETS mjcf_pdg EXPORT mjcf_pdgTargets FILE_SET HEADERS)
else()
  install(TARGETS mjcf_pdg EXPORT mjcf_pdgTargets)
  install(DIRECTORY include/mjcf_pdg TYPE INCLUDE FILES_MATCHING PATTERN "*.h")
endif()
if(TARGET mjcf-pdg)
  install(TARGETS mjcf-pdg)
endif()

# A MuJoCo out of a wheel or an archive goes along, with its headers and licence: its folder (a virtual environment, our
# build folder) may not outlive the installation. One with its own CMake package is installed already; we link to it.
set(MJCF_PDG_INSTALLS_MUJOCO OFF)
if(MuJoCo_LIBRARY)
  set(MJCF_PDG_INSTALLS_MUJOCO ON)
  install(IMPORTED_RUNTIME_ARTIFACTS mujoco::mujoco)
  install(DIRECTORY "${MuJoCo_INCLUDE_DIR}/mujoco" TYPE INCLUDE)
  file(GLOB licences "${MuJoCo_INCLUDE_DIR}/../LICENSE*" "${MuJoCo_INCLUDE_DIR}/../THIRD_PARTY_NOTICES*"
       "${MuJoCo_INCLUDE_DIR}/../../mujoco_core-${MuJoCo_VERSION}.dist-info/licenses/*")
  install(FILES ${licences} DESTINATION "${CMAKE_INSTALL_DOCDIR}/mujoco")
elseif(TARGET mjcf-pdg)
  set_property(TARGET mjcf-pdg PROPERTY INSTALL_RPATH_USE_LINK_PATH ON)
endif()

get_target_property(type mjcf_pdg TYPE)
set(MJCF_PDG_IS_STATIC OFF)
if(type STREQUAL "STATIC_LIBRARY")
  set(MJCF_PDG_IS_STATIC ON)
endif()
configure_package_config_file(src/cmake/mjcf_pdgConfig.cmake.in "${PROJECT_BINARY_DIR}/mjcf_pdgConfig.cmake"
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/mjcf_pdgConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/mjcf_pdgConfig.cmake" "${PROJECT_BINARY_DIR}/mjcf_pdgConfigVersion.cmake"
              src/cmake/FindMuJoCo.cmake
        DESTINATION "${package_dir}")
install(EXPORT mjcf_pdgTargets NAMESPACE mjcf_pdg:: DESTINATION "${package_dir}")
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
