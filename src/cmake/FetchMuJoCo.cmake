# mjcf_pdg_fetch_mujoco(RESULT): downloads the pinned MuJoCo wheel with pip, checks its hash, unpacks it, and returns a
# folder that is good as MuJoCo_ROOT. Wheel and unpacked copy stay in MJCF_PDG_CACHE_DIR, so it happens once.
# The wheel's libmujoco does not depend on Python, so any ABI will do: a fixed one lets us pin the hash whatever Python is here.

set(_mujoco_version 4.0.1)
set(_mujoco_sha256_x86_64 efbfb6e8f2bd63c5f19473f8093f01696937ef453d647b3c7a92620f5873b845)
set(_mujoco_sha256_aarch64 a401eaea5295a29d50c6fdfdb8df8d73c525ab2153751f91c36bd6ccdff95822)

include(pip_download)

function(_mjcf_pdg_download_wheel folder sha256)
  mjcf_pdg_pip_download(failed "${folder}" "mujoco-core==${_mujoco_version} --hash=sha256:${sha256}" --only-binary=:all:
    --python-version 3.12 --implementation cp --abi cp312 --platform manylinux_2_28_${CMAKE_SYSTEM_PROCESSOR})
  if(failed)
    message(FATAL_ERROR "MuJoCo 4.0.x was not found. Could not fetch mujoco-core ${_mujoco_version}:\n${failed}\n"
            "If this machine has no network, do one of these on one that has, and copy the result here:\n"
            "  * unpack MuJoCo ${_mujoco_version} (release archive or mujoco-core wheel) and set MuJoCo_ROOT to it\n"
            "  * build once with -DMJCF_PDG_CACHE_DIR=FOLDER, and use the same FOLDER here")
  endif()
endfunction()

function(mjcf_pdg_fetch_mujoco result)
  set(sha256 "${_mujoco_sha256_${CMAKE_SYSTEM_PROCESSOR}}")
  if(NOT CMAKE_SYSTEM_NAME STREQUAL "Linux" OR NOT sha256)
    message(FATAL_ERROR "MuJoCo 4.0.x was not found, and there is no pinned one for ${CMAKE_SYSTEM_NAME} "
            "${CMAKE_SYSTEM_PROCESSOR}: set MuJoCo_ROOT.")
  endif()
  set(cache "${MJCF_PDG_CACHE_DIR}")
  if(NOT cache)
    set(cache "${PROJECT_BINARY_DIR}/_mujoco")
  endif()
  set(folder "${cache}/mujoco-core-${_mujoco_version}-${CMAKE_SYSTEM_PROCESSOR}")
  set(${result} "${folder}/unpacked/mujoco" PARENT_SCOPE)
  file(MAKE_DIRECTORY "${folder}")
  file(LOCK "${folder}/lock" GUARD FUNCTION TIMEOUT 600)  # two builds may share the cache
  if(EXISTS "${folder}/unpacked/mujoco/plugin")  # a copy of before plugins were unpacked is replaced
    return()
  endif()

  file(GLOB wheel "${folder}/*.whl")
  if(NOT wheel)
    _mjcf_pdg_download_wheel("${folder}" ${sha256})
    file(GLOB wheel "${folder}/*.whl")
  endif()
  file(SHA256 "${wheel}" found)  # again, as the wheel may also have been put there by hand
  if(NOT found STREQUAL sha256)
    message(FATAL_ERROR "${wheel} has sha256 ${found}, expected ${sha256}: delete it and configure again.")
  endif()
  # Renamed when complete, so an interrupted configure leaves nothing that looks finished.
  file(REMOVE_RECURSE "${folder}/partial")
  file(ARCHIVE_EXTRACT INPUT "${wheel}" DESTINATION "${folder}/partial"
       PATTERNS "mujoco/include/*" "mujoco/libmujoco*" "mujoco/plugin/*.so" "*.dist-info/*")
  file(REMOVE_RECURSE "${folder}/unpacked")
  file(RENAME "${folder}/partial" "${folder}/unpacked")
endfunction()
