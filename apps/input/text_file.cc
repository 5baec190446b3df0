#include "apps/input/text_file.h"

#include <fstream>
#include <iterator>
#include <system_error>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {

std::string ReadTextFile(const std::filesystem::path& path) {
  std::error_code ec;
  const std::filesystem::file_status status = std::filesystem::status(path, ec);
  if (!std::filesystem::status_known(status)) throw Error(path.string() + ": " + ec.message());
  if (!std::filesystem::exists(status)) throw Error(path.string() + ": no such file");
  if (std::filesystem::is_directory(status)) throw Error(path.string() + ": is a folder");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path.string() + ": cannot be opened");
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace mjcf_pdg::app
