# Run by `cmake --install`, for packages and wheels: copies the shared libraries that `program` and `library` need to `library_dir`, and for each the
# licence that its Debian package states to `licence_dir` (both relative to the prefix).

find_program(patchelf patchelf)
if(NOT patchelf)
  message(FATAL_ERROR "Packages need patchelf: apt-get install patchelf")
endif()
file(GET_RUNTIME_DEPENDENCIES
  EXECUTABLES ${program} LIBRARIES ${library}
  RESOLVED_DEPENDENCIES_VAR found
  PRE_EXCLUDE_REGEXES "^lib(c|m|dl|rt|pthread|stdc\\+\\+|gcc_s)\\.so" "^ld-linux" "^libmujoco\\." "^libmjcf_pdg\\.")
foreach(library IN LISTS found)
  # One file, by the name that is asked for: a wheel has no symbolic links.
  get_filename_component(name "${library}" NAME)
  file(REAL_PATH "${library}" file)
  file(INSTALL "${file}" DESTINATION "${CMAKE_INSTALL_PREFIX}/${library_dir}" RENAME "${name}")
  # By its last name: dpkg may know the file below /lib where the linker found it below /usr/lib, or the other way round.
  get_filename_component(file "${file}" NAME)
  execute_process(COMMAND dpkg-query --search "*/${file}" OUTPUT_VARIABLE package RESULT_VARIABLE unknown ERROR_QUIET)
  # It finds the others beside it, when a program runs and when a consumer's linker looks for what it needs.
  execute_process(COMMAND "${patchelf}" --set-rpath "$ORIGIN" "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${library_dir}/${name}"
                  COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE ":.*" "" package "${package}")
  set(licence "/usr/share/doc/${package}/copyright")
  if(NOT unknown EQUAL 0 OR NOT EXISTS "${licence}")
    message(FATAL_ERROR "No licence is known for ${library}, which goes into the package: "
                        "package on a Debian or Ubuntu that has it as a package")
  endif()
  file(INSTALL "${licence}" DESTINATION "${CMAKE_INSTALL_PREFIX}/${licence_dir}" RENAME "${package}.copyright"
       FOLLOW_SYMLINK_CHAIN)
endforeach()
