# Writes FOLDER/page.html and FOLDER/bundle.js into OUTPUT as C++ arrays: a raw string would end at the first
# delimiter, and CMake lists split at semicolons; bytes do neither.
set(text "#include \"apps/html/web_files.h\"\n\nnamespace mjcf_pdg::app {\n")
foreach(file IN ITEMS page.html:kPageHtml bundle.js:kBundleJs)
  string(REPLACE ":" ";" parts "${file}")
  list(GET parts 0 name)
  list(GET parts 1 symbol)
  file(READ "${FOLDER}/${name}" bytes HEX)
  string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${bytes}")
  string(APPEND text "const char ${symbol}[] = \"${bytes}\";\n")
endforeach()
string(APPEND text "}  // namespace mjcf_pdg::app\n")
file(WRITE "${OUTPUT}" "${text}")
