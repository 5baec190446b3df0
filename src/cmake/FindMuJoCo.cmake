# Finds MuJoCo 4.0.x and defines the imported target mujoco::mujoco.
#
# Where it looks, first hit wins:
#   1. a target mujoco::mujoco that the enclosing project already made
#   2. MuJoCo_ROOT (CMake or environment variable). What the user names is used or refused, never passed over.
#   3. a CMake package called mujoco (a MuJoCo built and installed from source)
#   4. the packages of the python3 on the PATH (`pip install mujoco` or `mujoco-core`)
# Other versions are skipped in 3 and 4: a Python with MuJoCo 3 must not stop the build.
#
# Sets MuJoCo_FOUND, MuJoCo_VERSION, and for 2 and 4 also MuJoCo_INCLUDE_DIR and MuJoCo_LIBRARY.
# Nothing is cached, so a changed MuJoCo_ROOT takes effect at the next configure.

include(FindPackageHandleStandardArgs)

# Accepts `dir` if it holds headers and library of one and the same MuJoCo 4.0.x, laid out as in the Python wheel
# (DIR/libmujoco.so.4.0.1) or as in the official release (DIR/lib/libmujoco.so.4.0.1).
function(_mujoco_probe dir)
  set(header "${dir}/include/mujoco/mujoco.h")
  if(MuJoCo_LIBRARY OR NOT EXISTS "${header}")
    return()
  endif()
  file(STRINGS "${header}" number REGEX "^#define mjVERSION_HEADER +[0-9]+" LIMIT_COUNT 1)
  string(REGEX REPLACE "[^0-9]" "" number "0${number}")
  math(EXPR major "${number} / 1000000")  # 4000001 is 4.0.1; the 3.x headers count differently and give 0
  math(EXPR minor "${number} / 1000 % 1000")
  math(EXPR patch "${number} % 1000")
  set(version "${major}.${minor}.${patch}")
  file(GLOB library "${dir}/libmujoco.so.${version}" "${dir}/lib*/libmujoco.so.${version}"
       "${dir}/lib/*/libmujoco.so.${version}")
  if(version MATCHES "^4\\.0\\." AND library)
    list(GET library 0 library)
    set(MuJoCo_VERSION "${version}" PARENT_SCOPE)
    set(MuJoCo_INCLUDE_DIR "${dir}/include" PARENT_SCOPE)
    set(MuJoCo_LIBRARY "${library}" PARENT_SCOPE)
  elseif(NOT MuJoCo_FIND_QUIETLY)
    message(STATUS "MuJoCo in ${dir} is not a 4.0.x with its library: not used")
  endif()
endfunction()

function(_mujoco_python_folders result)
  find_program(MuJoCo_PYTHON python3 DOC "Python whose packages are searched for MuJoCo")
  mark_as_advanced(MuJoCo_PYTHON)
  set(folders "")
  if(MuJoCo_PYTHON)
    # No import: MuJoCo's own __init__ loads libraries. path[0] is the current folder, not a place for packages.
    execute_process(
      COMMAND "${MuJoCo_PYTHON}" -c "import sys; print(';'.join(p + '/mujoco' for p in sys.path[1:] if p))"
      OUTPUT_VARIABLE folders OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  endif()
  set(${result} "${folders}" PARENT_SCOPE)
endfunction()

set(_mujoco_root "${MuJoCo_ROOT}")
if(NOT _mujoco_root)
  set(_mujoco_root "$ENV{MuJoCo_ROOT}")
endif()

if(NOT TARGET mujoco::mujoco)  # a second call keeps what the first one found
  set(MuJoCo_LIBRARY "")
  if(_mujoco_root)
    get_filename_component(_mujoco_root "${_mujoco_root}" ABSOLUTE BASE_DIR "${CMAKE_BINARY_DIR}")
    _mujoco_probe("${_mujoco_root}")
  else()
    find_package(mujoco 4.0...<4.1 CONFIG QUIET)
    if(NOT TARGET mujoco::mujoco)
      _mujoco_python_folders(_mujoco_folders)
      foreach(_mujoco_folder IN LISTS _mujoco_folders)
        _mujoco_probe("${_mujoco_folder}")
      endforeach()
    endif()
  endif()
endif()

if(TARGET mujoco::mujoco)
  set(MuJoCo_FOUND TRUE)
  if(NOT MuJoCo_VERSION)
    set(MuJoCo_VERSION "${mujoco_VERSION}")
  endif()
else()
  if(_mujoco_root)
    set(_mujoco_hint "MuJoCo_ROOT is ${_mujoco_root}, which holds no MuJoCo 4.0.x (neither wheel nor release layout).")
  else()
    set(_mujoco_hint "Set MuJoCo_ROOT to an unpacked MuJoCo 4.0.x, or `pip install mujoco-core==4.0.1`.")
  endif()
  find_package_handle_standard_args(MuJoCo REQUIRED_VARS MuJoCo_LIBRARY MuJoCo_INCLUDE_DIR
                                    VERSION_VAR MuJoCo_VERSION REASON_FAILURE_MESSAGE "${_mujoco_hint}")
  if(MuJoCo_FOUND)
    add_library(mujoco::mujoco SHARED IMPORTED)
    set_target_properties(mujoco::mujoco PROPERTIES
      IMPORTED_LOCATION "${MuJoCo_LIBRARY}"
      IMPORTED_SONAME "libmujoco.so.${MuJoCo_VERSION}"
      INTERFACE_INCLUDE_DIRECTORIES "${MuJoCo_INCLUDE_DIR}")
  endif()
endif()
