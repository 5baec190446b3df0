# What no distribution has as a package, from the user's index of Python packages, by pip. Not file(DOWNLOAD), because pip knows
# the user's index, proxy and certificates. What comes is pinned by its hash.

set(MJCF_PDG_CACHE_DIR "$ENV{MJCF_PDG_CACHE_DIR}" CACHE PATH
    "Where fetched packages are kept (empty: the build folder)")

# A python3 that has pip; empty: none. The first on the PATH may be a virtual environment without it.
function(_mjcf_pdg_find_pip result)
  set(${result} "" PARENT_SCOPE)
  foreach(python IN ITEMS "${MuJoCo_PYTHON}" python3 /usr/bin/python3)
    if(python)
      execute_process(COMMAND "${python}" -m pip --version RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
      if(failed EQUAL 0)
        set(${result} "${python}" PARENT_SCOPE)
        return()
      endif()
    endif()
  endforeach()
endfunction()

# mjcf_pdg_pip_download(FAILED FOLDER REQUIREMENT OPTION...): downloads what the one line REQUIREMENT, with its hash, names into
# FOLDER. FAILED is set to what went wrong, and to nothing if all went well.
function(mjcf_pdg_pip_download result folder requirement)
  _mjcf_pdg_find_pip(python)
  if(NOT python)
    set(${result} "there is no python3 with pip: run apps/install_deps.sh" PARENT_SCOPE)
    return()
  endif()
  string(REGEX REPLACE " .*" "" name "${requirement}")
  message(STATUS "Fetching ${name} with ${python} -m pip")
  file(WRITE "${folder}/requirements.txt" "${requirement}\n")
  execute_process(
    COMMAND "${python}" -m pip download --quiet --disable-pip-version-check --retries 2 --no-deps --require-hashes
            --requirement "${folder}/requirements.txt" --dest "${folder}" ${ARGN}
    RESULT_VARIABLE failed OUTPUT_VARIABLE log ERROR_VARIABLE log)
  if(failed EQUAL 0)
    set(log "")
  endif()
  set(${result} "${log}" PARENT_SCOPE)
endfunction()
