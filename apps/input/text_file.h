// A file as a whole, for formats that are read so.
#ifndef MJCF_PDG_APPS_INPUT_TEXT_FILE_H_
#define MJCF_PDG_APPS_INPUT_TEXT_FILE_H_

#include <filesystem>
#include <string>

namespace mjcf_pdg::app {

// The bytes of a file. Throws Error, which begins with the path, if there is none, if it is a
// folder, or if it may not be read.
std::string ReadTextFile(const std::filesystem::path& path);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_INPUT_TEXT_FILE_H_
