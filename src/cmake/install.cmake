# Install rules: library, headers, program with its manual pages, CMake package, pkg-config file. The installed folder can be
# moved.

include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/mjcf_pdg")
set(private_dir "${CMAKE_INSTALL_LIBDIR}/mjcf_pdg")  # libraries of others that come with us

if(CMAKE_VERSION VERSION_GREATER_EQUAL 3.24)
  install(TARGETS mjcf_pdg EXPORT mjcf_pdgTargets FILE_SET HEADERS)
else()
  install(TARGETS mjcf_pdg EXPORT mjcf_pdgTargets)
  install(DIRECTORY include/mjcf_pdg TYPE INCLUDE FILES_MATCHING PATTERN "*.h")
endif()
set_target_properties(mjcf_pdg PROPERTIES INSTALL_RPATH "$ORIGIN/mjcf_pdg/mujoco;$ORIGIN/mjcf_pdg/bundled")
if(TARGET mjcf-pdg)
  install(TARGETS mjcf-pdg)
  set_target_properties(mjcf-pdg PROPERTIES INSTALL_RPATH
    "$ORIGIN/../${CMAKE_INSTALL_LIBDIR};$ORIGIN/../${private_dir};$ORIGIN/../${private_dir}/mujoco;$ORIGIN/../${private_dir}/bundled")
  if(TARGET mjcf_pdg_view)  # found by the program's run path
    install(TARGETS mjcf_pdg_view LIBRARY DESTINATION "${private_dir}")
    set_target_properties(mjcf_pdg_view PROPERTIES INSTALL_RPATH "$ORIGIN/mujoco;$ORIGIN/bundled")
  endif()
  install(DIRECTORY "${manual_dir}/" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" FILES_MATCHING PATTERN "*.1")
endif()

# A MuJoCo out of a wheel or an archive goes along, with its headers and licence: its folder (a virtual environment, our
# build folder) may not outlive the installation. It goes into a folder of our own, laid out as in the wheel, so that it is not
# taken for the machine's MuJoCo. One with its own CMake package is installed already; we link to it.
set(MJCF_PDG_INSTALLS_MUJOCO OFF)
if(MuJoCo_LIBRARY)
  set(MJCF_PDG_INSTALLS_MUJOCO ON)
  install(FILES "${MuJoCo_LIBRARY}" DESTINATION "${private_dir}/mujoco" PERMISSIONS
          OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  # Its plugins (SDF geoms, some sensors and actuators), from where the wheel or the release has them.
  get_filename_component(mujoco_library_dir "${MuJoCo_LIBRARY}" DIRECTORY)
  file(GLOB plugins "${mujoco_library_dir}/plugin/*.so" "${mujoco_library_dir}/../bin/mujoco_plugin/*.so")
  install(PROGRAMS ${plugins} DESTINATION "${private_dir}/mujoco/plugin")
  install(DIRECTORY "${MuJoCo_INCLUDE_DIR}/mujoco" DESTINATION "${private_dir}/mujoco/include")
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

# pkg-config. A static library needs what it was made of at the consumer's link. (Not `Requires: fcl`: fcl.pc says -std=c++11.)
set(pkgconfig_dir "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
file(RELATIVE_PATH pkgconfig_to_prefix "/${pkgconfig_dir}" "/")
string(REGEX REPLACE "/$" "" pkgconfig_to_prefix "${pkgconfig_to_prefix}")
set(pkgconfig_cflags "")
set(pkgconfig_libs "")
if(MJCF_PDG_IS_STATIC)
  set(pkgconfig_cflags " -DMJCF_PDG_STATIC")
  set(pkgconfig_libs " -lfcl")
endif()
if(MJCF_PDG_INSTALLS_MUJOCO)
  set(pkgconfig_mujoco "\${libdir}/mjcf_pdg/mujoco")
  set(pkgconfig_mujoco_include "\${mujoco}/include")
else()
  set(pkgconfig_mujoco "$<TARGET_FILE_DIR:mujoco::mujoco>")
  set(pkgconfig_mujoco_include "$<JOIN:$<TARGET_PROPERTY:mujoco::mujoco,INTERFACE_INCLUDE_DIRECTORIES>, -I>")
endif()
configure_file(src/cmake/mjcf_pdg.pc.in "${PROJECT_BINARY_DIR}/mjcf_pdg.pc.in" @ONLY)
file(GENERATE OUTPUT "${PROJECT_BINARY_DIR}/$<CONFIG>/mjcf_pdg.pc" INPUT "${PROJECT_BINARY_DIR}/mjcf_pdg.pc.in")
install(FILES "${PROJECT_BINARY_DIR}/$<CONFIG>/mjcf_pdg.pc" DESTINATION "${pkgconfig_dir}")

install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
if(TARGET mjcf_pdg_ruckig AND TARGET mjcf-pdg)  # it is in the program
  install(FILES "${ruckig_dir}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}/ruckig")
endif()
