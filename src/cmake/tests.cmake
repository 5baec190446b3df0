# Tests: every GoogleTest case, each public header alone, and a project that uses the installed package. Benchmarks.

file(GLOB_RECURSE test_sources CONFIGURE_DEPENDS tests/*_test.cc)
if(NOT plan)
  list(FILTER test_sources EXCLUDE REGEX "/(plan/[a-z_]*|cli_plan)_test\\.cc$")
endif()
if(NOT timing)
  list(FILTER test_sources EXCLUDE REGEX "/(timing|cli_trajectory)_test\\.cc$")
endif()
file(GLOB support_sources CONFIGURE_DEPENDS tests/support/*.cc)
set(mesh_sources tests/support/mesh_shapes.cc tests/support/mesh_oracle.cc)
list(TRANSFORM mesh_sources PREPEND "${PROJECT_SOURCE_DIR}/")
list(REMOVE_ITEM support_sources ${mesh_sources})
file(GLOB bench_sources CONFIGURE_DEPENDS bench/*.cc)

# Shapes of meshes and a second opinion on them. CGAL is GPL: it must not get into the library or the program.
find_package(CGAL QUIET)
if(NOT CGAL_FOUND)
  message(FATAL_ERROR "Tests and benchmarks need CGAL 5.4 or newer: install libcgal-dev, "
          "or set MJCF_PDG_BUILD_TESTS=OFF and MJCF_PDG_BUILD_BENCH=OFF")
endif()
add_library(mjcf_pdg_mesh_support STATIC EXCLUDE_FROM_ALL ${mesh_sources})
target_include_directories(mjcf_pdg_mesh_support PUBLIC .)
target_link_libraries(mjcf_pdg_mesh_support PUBLIC mjcf_pdg_internals PRIVATE CGAL::CGAL)
set_target_properties(mjcf_pdg_mesh_support PROPERTIES CXX_EXTENSIONS OFF)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")  # GCC 12 guesses it inside CGAL
  set_source_files_properties(tests/support/mesh_oracle.cc PROPERTIES COMPILE_OPTIONS -Wno-use-after-free)
endif()

# What tests share: the scenes and the slow oracle (tests/support), internal headers.
if(support_sources)
  add_library(mjcf_pdg_test_support STATIC EXCLUDE_FROM_ALL ${support_sources})
  set(scope PUBLIC)
else()
  add_library(mjcf_pdg_test_support INTERFACE)
  set(scope INTERFACE)
endif()
target_link_libraries(mjcf_pdg_test_support ${scope} mjcf_pdg_mesh_support)
target_compile_definitions(mjcf_pdg_test_support ${scope} MJCF_PDG_MODEL_DIR="${PROJECT_SOURCE_DIR}/models"
                           MJCF_PDG_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

# Models too big to keep: made by their generator.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(big_model_dir "${PROJECT_BINARY_DIR}/models/rigid")
add_custom_command(OUTPUT "${big_model_dir}/bunny_dragon.xml"
  COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/models/rigid/make_rigid.py" "${big_model_dir}"
  DEPENDS models/rigid/make_rigid.py models/rigid/shapes.py models/mesh_tools.py models/scene_tools.py
  COMMENT "Making big models")
add_custom_target(mjcf_pdg_big_models DEPENDS "${big_model_dir}/bunny_dragon.xml")
add_dependencies(mjcf_pdg_test_support mjcf_pdg_big_models)
target_compile_definitions(mjcf_pdg_test_support ${scope} MJCF_PDG_BIG_MODEL_DIR="${big_model_dir}")

if(MJCF_PDG_BUILD_TESTS)
  enable_testing()
  find_package(GTest)
  if(NOT GTest_FOUND)
    message(FATAL_ERROR "The tests need GoogleTest: install libgtest-dev and libgmock-dev, "
            "or set MJCF_PDG_BUILD_TESTS=OFF")
  endif()
  include(GoogleTest)
  target_link_libraries(mjcf_pdg_test_support ${scope} GTest::gmock)

  if(test_sources)
    add_executable(mjcf_pdg_tests ${test_sources})
    target_link_libraries(mjcf_pdg_tests PRIVATE mjcf_pdg_view_state mjcf_pdg_fuzz mjcf_pdg_test_support
                          mjcf_pdg_mesh_import assimp::assimp
                          GTest::gtest_main)
    # The tests' own code: a third of the build's time less than with -O3. What they test is compiled as it is shipped.
    target_compile_options(mjcf_pdg_tests PRIVATE $<$<CONFIG:Release>:-O1>)
    if(plan)
      target_link_libraries(mjcf_pdg_tests PRIVATE mjcf_pdg_plan)
    endif()
    if(TARGET mjcf-pdg)
      target_link_libraries(mjcf_pdg_tests PRIVATE ZLIB::ZLIB)  # reports are unpacked again
      add_dependencies(mjcf_pdg_tests mjcf-pdg)
      if(view)
        add_dependencies(mjcf_pdg_tests mjcf_pdg_view)
      endif()
      target_compile_definitions(mjcf_pdg_tests PRIVATE MJCF_PDG_PROGRAM="$<TARGET_FILE:mjcf-pdg>")
      set_source_files_properties(tests/apps/cli_manual_test.cc PROPERTIES
                                  COMPILE_DEFINITIONS "MJCF_PDG_MANUAL_DIR=\"${manual_dir}\"")
      # A plugin of somebody's own, and MuJoCo's.
      add_library(idle_plugin MODULE tests/apps/plugin/idle_plugin.cc)
      target_link_libraries(idle_plugin PRIVATE mujoco::mujoco)
      set_target_properties(idle_plugin PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/test_plugins$<0:>")
      add_dependencies(mjcf_pdg_tests idle_plugin)
      set_source_files_properties(tests/apps/cli_plugins_test.cc PROPERTIES COMPILE_DEFINITIONS
        "MJCF_PDG_TEST_PLUGIN_DIR=\"$<TARGET_FILE_DIR:idle_plugin>\"")
      set_property(SOURCE tests/apps/cli_plugins_test.cc tests/solve/sdf_test.cc APPEND PROPERTY COMPILE_DEFINITIONS
        "MJCF_PDG_MUJOCO_PLUGIN_DIR=\"$<TARGET_FILE_DIR:mujoco::mujoco>/plugin\"")
      if(render)  # What is drawn is read again.
        target_compile_definitions(mjcf_pdg_tests PRIVATE MJCF_PDG_TESTS_HAVE_PNG)
        target_link_libraries(mjcf_pdg_tests PRIVATE PNG::PNG GIF::GIF)
      endif()
    endif()
    # A million poses, each claim of the verifier held against its proof; prints what the solver, MuJoCo and FCL get wrong.
    add_executable(verify_poses EXCLUDE_FROM_ALL tests/verify/verify_poses.cc bench/library/fcl_library.cc)
    target_include_directories(verify_poses PRIVATE bench)
    target_link_libraries(verify_poses PRIVATE mjcf_pdg_test_support GTest::gtest fcl)
    # Random models, configurations and damaged files by the thousand; a few are tests. Reads files as the program does.
    file(GLOB fuzz_sources CONFIGURE_DEPENDS tests/fuzz/*.cc)
    list(FILTER fuzz_sources EXCLUDE REGEX "/(fuzz|[a-z_]*_test)\\.cc$")
    if(NOT plan)
      list(FILTER fuzz_sources EXCLUDE REGEX "/planning_case\\.cc$")
    endif()
    add_library(mjcf_pdg_fuzz STATIC EXCLUDE_FROM_ALL ${fuzz_sources}
                apps/input/mapped_file.cc apps/input/npy.cc apps/input/qpos_file.cc apps/console/text.cc)
    target_link_libraries(mjcf_pdg_fuzz PUBLIC mjcf_pdg_test_support PRIVATE mjcf_pdg_mesh_import nlohmann_json::nlohmann_json)
    if(plan)
      target_link_libraries(mjcf_pdg_fuzz PUBLIC mjcf_pdg_plan)
    endif()
    add_executable(fuzz EXCLUDE_FROM_ALL tests/fuzz/fuzz.cc)
    target_link_libraries(fuzz PRIVATE mjcf_pdg_fuzz GTest::gtest)
    # Tests that take minutes: cmake --build BUILD --target long_tests
    add_custom_target(long_tests
      COMMAND "${CMAKE_COMMAND}" -E env MJCF_PDG_LONG_TESTS=1 $<TARGET_FILE:mjcf_pdg_tests>
      DEPENDS mjcf_pdg_tests USES_TERMINAL)
    # Do the tests see errors? Plants some, one at a time, in a copy of the tree: an hour or two.
    add_custom_target(mutation_test
      COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/tests/mutations/run.py" --build "${PROJECT_BINARY_DIR}"
      USES_TERMINAL VERBATIM)
    # Cases are listed when ctest starts, not at build time: a crash in start-up is a failed test, not a failed build.
    gtest_discover_tests(mjcf_pdg_tests DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60)
  endif()

  if(TARGET mjcf-pdg)
    add_test(NAME docs_show_real_output
             COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/docs/check.py" --program $<TARGET_FILE:mjcf-pdg>)
    find_program(MANDOC mandoc)
    mark_as_advanced(MANDOC)
    if(MANDOC)  # The pages have no date, so that the same sources give the same bytes.
      add_test(NAME manual_pages_are_well_formed
               COMMAND sh -c "! '${MANDOC}' -T lint -W warning *.1 | grep -v 'missing date'"
               WORKING_DIRECTORY "${manual_dir}")
    endif()
  endif()

  if(CMAKE_VERSION VERSION_GREATER_EQUAL 3.24)
    add_test(NAME public_headers_compile_alone
             COMMAND "${CMAKE_COMMAND}" --build "${PROJECT_BINARY_DIR}" --config $<CONFIG>
                     --target all_verify_interface_header_sets)
  endif()

  # Looking for a package that is disabled is an error.
  set(disabled assimp nlohmann_json CLI11 Boost PNG GIF GTest CGAL)
  list(TRANSFORM disabled REPLACE "(.+)" "-DCMAKE_DISABLE_FIND_PACKAGE_\\1=ON")
  add_test(NAME library_alone_needs_no_more_than_it_says
           COMMAND "${CMAKE_COMMAND}" -S "${PROJECT_SOURCE_DIR}" -B "${PROJECT_BINARY_DIR}/library_alone"
                   -G "${CMAKE_GENERATOR}" -D "CMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}"
                   -D "MuJoCo_ROOT=${MuJoCo_ROOT}" -D "mujoco_DIR=${mujoco_DIR}"
                   -D MJCF_PDG_BUILD_APP=OFF -D MJCF_PDG_BUILD_TESTS=OFF -D MJCF_PDG_BUILD_BENCH=OFF ${disabled})

  if(MJCF_PDG_INSTALL)
    set(shared_library "")
    if(library_type STREQUAL "SHARED_LIBRARY")
      set(shared_library "${CMAKE_INSTALL_LIBDIR}/$<TARGET_FILE_NAME:mjcf_pdg>")
    endif()
    add_test(NAME consumer_of_installed_package
             COMMAND "${CMAKE_COMMAND}" -D "build=${PROJECT_BINARY_DIR}" -D "config=$<CONFIG>"
                     -D "generator=${CMAKE_GENERATOR}" -D "compiler=${CMAKE_CXX_COMPILER}"
                     -D "flags=${CMAKE_CXX_FLAGS}" -D "mujoco_dir=${mujoco_DIR}"
                     -D "program=$<TARGET_NAME_IF_EXISTS:mjcf-pdg>" -D "library=${shared_library}" -D "view=${view}"
                     -P "${PROJECT_SOURCE_DIR}/tests/consumer/run.cmake")
  endif()
endif()

# Each bench/*_bench.cc is a program; the other sources of bench/ are shared by them.
set(bench_programs ${bench_sources})
list(FILTER bench_programs INCLUDE REGEX "_bench\\.cc$")
list(REMOVE_ITEM bench_sources ${bench_programs})
if(NOT plan)
  list(FILTER bench_programs EXCLUDE REGEX "/plan_bench\\.cc$")
endif()
if(MJCF_PDG_BUILD_BENCH AND bench_programs)
  find_package(CLI11 2.1 REQUIRED)
  find_package(nlohmann_json 3.9 REQUIRED)
  add_library(mjcf_pdg_bench_support STATIC ${bench_sources})
  target_include_directories(mjcf_pdg_bench_support PUBLIC bench)
  target_link_libraries(mjcf_pdg_bench_support PUBLIC mjcf_pdg_mesh_support CLI11::CLI11 nlohmann_json::nlohmann_json)
  target_compile_definitions(mjcf_pdg_bench_support PUBLIC MJCF_PDG_MODEL_DIR="${PROJECT_SOURCE_DIR}/models")
  foreach(source IN LISTS bench_programs)
    get_filename_component(program "${source}" NAME_WE)
    add_executable(${program} ${source})
    target_link_libraries(${program} PRIVATE mjcf_pdg_bench_support)
    set_target_properties(${program} PROPERTIES CXX_EXTENSIONS OFF
                          RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin$<0:>")
  endforeach()

  if(plan)
    target_sources(plan_bench PRIVATE bench/peers/sampled_plan.cc)
    target_link_libraries(plan_bench PRIVATE mjcf_pdg_plan)
  endif()

  # Libraries beside our own code, in a folder that bench/library/fetch.sh made; those that are not there are left out.
  # By hand: their packages would bring other versions of Boost and assimp into this build.
  set(MJCF_PDG_BENCH_LIBRARIES "" CACHE PATH "Folder of bench/library/fetch.sh, for library_bench")
  set(coal "${MJCF_PDG_BENCH_LIBRARIES}/cmeel.prefix")
  set(daqp "${MJCF_PDG_BENCH_LIBRARIES}/daqp")
  file(GLOB library_sources CONFIGURE_DEPENDS bench/library/*.cc)
  target_sources(library_bench PRIVATE ${library_sources})
  target_link_libraries(library_bench PRIVATE fcl)
  if(EXISTS "${coal}/lib/libcoal.so")
    target_compile_definitions(library_bench PRIVATE MJCF_PDG_HAVE_COAL)
    set_source_files_properties(bench/library/coal_library.cc PROPERTIES COMPILE_OPTIONS "-isystem;${coal}/include")
    target_link_libraries(library_bench PRIVATE "${coal}/lib/libcoal.so")
  endif()
  if(EXISTS "${daqp}/lib/libdaqp.a")
    target_compile_definitions(library_bench PRIVATE MJCF_PDG_HAVE_DAQP)
    target_include_directories(library_bench SYSTEM PRIVATE "${daqp}/include")
    target_link_libraries(library_bench PRIVATE "${daqp}/lib/libdaqp.a")
  endif()
endif()
