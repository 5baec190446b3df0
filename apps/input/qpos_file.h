// Files of configurations, one per row: .npy, text (.csv, .txt) with commas or blanks, or our own
// JSON Lines, of which `qpos` is read. Rows are read one at a time: files may be larger than
// memory.
#ifndef MJCF_PDG_APPS_INPUT_QPOS_FILE_H_
#define MJCF_PDG_APPS_INPUT_QPOS_FILE_H_

#include <cstddef>
#include <fstream>
#include <istream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/input/npy.h"

namespace mjcf_pdg::app {

class QposFile {
 public:
  // "-" reads stdin. Throws Error if the file cannot be read, is of no known kind or empty, or if
  // its header says that it does not hold rows of `width` numbers.
  QposFile(const std::string& path, std::size_t width);

  // The next row, `width` numbers, and where it is from, for messages: "poses.csv line 7",
  // "poses.npy row 6". Those of text are finite. False after the last. Throws Error, which begins
  // so, for a bad row, and if there is none at all.
  bool Next(std::vector<double>& row, std::string& origin);

  // How many rows there are: of a .npy as its header says, of a text on disk as many as it has line
  // breaks (comments count), of a stream unknown.
  std::optional<std::size_t> size() const;

 private:
  bool NextLine(std::vector<double>& row, std::string& origin);

  const std::string what_;  // the file, for messages
  const std::size_t width_;
  bool json_ = false;
  std::ifstream file_;
  std::istream* stream_ = nullptr;
  std::optional<NpyReader> npy_;
  std::string line_;
  std::size_t line_number_ = 0, rows_ = 0;
};

// Throws Error, which names the flag, unless `path` is empty, "-", or ends in .npy, .csv, .txt or
// .jsonl.
void CheckQposFileName(const std::string& flag, const std::string& path);
bool IsNpyFile(const std::string& path);
// A row as it is written to `path`: bytes of a .npy, or a line, of .jsonl with the key `qpos`.
std::string FormatQposRow(const std::vector<double>& row, const std::string& path);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_INPUT_QPOS_FILE_H_
