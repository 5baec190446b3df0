# Installs the build, moves the installed folder, then builds and runs the consumer against it (and the program in it).
# The same by pkg-config, where that is installed. Of a shared library, looks at what it exports.
set(work "${build}/consumer")
file(REMOVE_RECURSE "${work}")
file(MAKE_DIRECTORY "${work}")

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run("${CMAKE_COMMAND}" --install "${build}" --config "${config}" --prefix "${work}/installed")
file(RENAME "${work}/installed" "${work}/moved")
run("${CMAKE_COMMAND}" -S "${CMAKE_CURRENT_LIST_DIR}" -B "${work}/build" -G "${generator}"
    "-DCMAKE_PREFIX_PATH=${work}/moved" "-Dmujoco_DIR=${mujoco_dir}"
    "-DCMAKE_CXX_COMPILER=${compiler}" "-DCMAKE_CXX_FLAGS=${flags}"
    "-DCMAKE_BUILD_TYPE=${config}" "-DCMAKE_RUNTIME_OUTPUT_DIRECTORY=${work}/bin$<0:>")
run("${CMAKE_COMMAND}" --build "${work}/build" --config "${config}")
run("${work}/bin/consumer")
execute_process(COMMAND "${work}/bin/readme" WORKING_DIRECTORY "${CMAKE_CURRENT_LIST_DIR}/../.." COMMAND_ERROR_IS_FATAL ANY)
set(models "${CMAKE_CURRENT_LIST_DIR}/../../models")
run("${work}/bin/allocations" 40 "${models}/puma/puma_car.xml" "${models}/hand/hand_bottle.xml"
    "${models}/figure/figure_bench.xml")
find_program(pkg_config pkg-config)
if(pkg_config)
  file(GLOB_RECURSE found "${work}/moved/*/mjcf_pdg.pc")
  get_filename_component(folder "${found}" DIRECTORY)
  set(ENV{PKG_CONFIG_PATH} "${folder}:$ENV{PKG_CONFIG_PATH}")
  execute_process(COMMAND "${pkg_config}" --cflags --libs mjcf_pdg OUTPUT_VARIABLE arguments COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(arguments UNIX_COMMAND "${arguments} ${flags}")
  run("${compiler}" -std=c++20 "-I${work}/build" "${CMAKE_CURRENT_LIST_DIR}/main.cc" "${CMAKE_CURRENT_LIST_DIR}/follow.cc"
      ${arguments} -o "${work}/by_pkg_config")
  run("${work}/by_pkg_config")
endif()
if(library)
  run("${CMAKE_COMMAND}" -D "library=${work}/moved/${library}" -D "headers=${work}/moved/include/mjcf_pdg"
      -P "${CMAKE_CURRENT_LIST_DIR}/exports.cmake")
endif()
if(program)
  run("${work}/moved/bin/${program}" --version)
  run("${work}/moved/bin/${program}" check "${CMAKE_CURRENT_LIST_DIR}/ring.xml")  # an SDF geom, by MuJoCo's own plugin
endif()
if(view)  # the window's library is found where it was moved, although there is no display for it
  execute_process(COMMAND "${CMAKE_COMMAND}" -E env DISPLAY=:98765 --unset=WAYLAND_DISPLAY
                          "${work}/moved/bin/${program}" view "${CMAKE_CURRENT_LIST_DIR}/ring.xml"
                  ERROR_VARIABLE words RESULT_VARIABLE code)
  if(NOT code EQUAL 2 OR NOT words MATCHES "no window: there is no display")
    message(FATAL_ERROR "view: ${code} ${words}")
  endif()
endif()
