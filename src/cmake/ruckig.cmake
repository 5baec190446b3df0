# Ruckig (MIT), which gives times to paths: sets `timing` and makes the target ruckig::ruckig if the machine has it as a CMake
# package, or from the sources in its Python package, which stay in MJCF_PDG_CACHE_DIR, as MuJoCo's wheel does.

include(pip_download)

set(_ruckig_version 0.19.4)
set(_ruckig_sha256 71d003bf0ff9aa0031d4520b0290a5ffa6458149f5afce8be3ed6d6fba49ea64)

# The folder with include/ and src/, or nothing, with a message that says why.
function(_mjcf_pdg_fetch_ruckig result)
  set(cache "${MJCF_PDG_CACHE_DIR}")
  if(NOT cache)
    set(cache "${PROJECT_BINARY_DIR}/_ruckig")
  endif()
  set(folder "${cache}/ruckig-${_ruckig_version}")
  set(unpacked "${folder}/unpacked/ruckig-${_ruckig_version}")
  set(archive "${folder}/ruckig-${_ruckig_version}.tar.gz")
  file(MAKE_DIRECTORY "${folder}")
  file(LOCK "${folder}/lock" GUARD FUNCTION TIMEOUT 600)  # two builds may share the cache
  if(NOT EXISTS "${archive}")
    # pip asks the package for its name, with the tools that it is built with, which are pinned as well: the first variable is
    # what pip before 25.3 reads, the second what later ones do.
    file(WRITE "${folder}/tools.txt" "scikit-build-core==1.1.2\nnanobind==3.1.0\n")
    set(ENV{PIP_CONSTRAINT} "${folder}/tools.txt")
    set(ENV{PIP_BUILD_CONSTRAINT} "${folder}/tools.txt")
    mjcf_pdg_pip_download(failed "${folder}" "ruckig==${_ruckig_version} --hash=sha256:${_ruckig_sha256}" --no-binary=ruckig)
    unset(ENV{PIP_CONSTRAINT})
    unset(ENV{PIP_BUILD_CONSTRAINT})
    if(failed)
      message(STATUS "Could not fetch ruckig ${_ruckig_version}, which --speeds of `plan` needs:\n${failed}")
      set(${result} "" PARENT_SCOPE)
      return()
    endif()
  endif()
  file(SHA256 "${archive}" found)  # again, as the archive may also have been put there by hand
  if(NOT found STREQUAL _ruckig_sha256)
    message(FATAL_ERROR "${archive} has sha256 ${found}, expected ${_ruckig_sha256}: delete it and configure again.")
  endif()
  if(NOT EXISTS "${unpacked}")  # renamed when complete
    file(REMOVE_RECURSE "${folder}/partial")
    file(ARCHIVE_EXTRACT INPUT "${archive}" DESTINATION "${folder}/partial" PATTERNS "*/include/*" "*/src/ruckig/*" "*/LICENSE")
    file(REMOVE_RECURSE "${folder}/unpacked")
    file(RENAME "${folder}/partial" "${folder}/unpacked")
  endif()
  set(${result} "${unpacked}" PARENT_SCOPE)
endfunction()

if(MJCF_PDG_RUCKIG)
  find_package(ruckig 0.14 CONFIG QUIET)
  if(NOT TARGET ruckig::ruckig)
    _mjcf_pdg_fetch_ruckig(ruckig_dir)
  endif()
  if(ruckig_dir)
    file(GLOB ruckig_sources "${ruckig_dir}/src/ruckig/*.cpp")
    list(FILTER ruckig_sources EXCLUDE REGEX "/cloud_client\\.cpp$")  # of the service that its makers sell
    add_library(mjcf_pdg_ruckig STATIC EXCLUDE_FROM_ALL ${ruckig_sources})
    target_compile_features(mjcf_pdg_ruckig PUBLIC cxx_std_20)
    target_include_directories(mjcf_pdg_ruckig SYSTEM PUBLIC "${ruckig_dir}/include")
    target_compile_options(mjcf_pdg_ruckig PRIVATE -ffp-contract=off)  # as ours: the same digits everywhere
    add_library(ruckig::ruckig ALIAS mjcf_pdg_ruckig)
  endif()
  if(TARGET ruckig::ruckig)
    set(timing ON)
  elseif(NOT MJCF_PDG_RUCKIG STREQUAL "AUTO")
    message(FATAL_ERROR "MJCF_PDG_RUCKIG needs Ruckig 0.14 or newer, or a python3 with pip that can fetch it")
  endif()
endif()
