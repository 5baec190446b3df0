// Files of configurations, one per row: .npy, or text (.csv, .txt) with numbers separated by commas
// or blanks.
#ifndef MJCF_PDG_APPS_QPOS_FILE_H_
#define MJCF_PDG_APPS_QPOS_FILE_H_

#include <string>

#include "apps/npy.h"

namespace mjcf_pdg::app {

struct QposFile {
  Rows rows;
  // Where row i comes from, for messages: "poses.csv line 7", "poses.npy row 6".
  std::vector<std::string> origin;
};

// Reads a file; "-" is stdin. Throws Error unless there is at least one row and each has `width`
// numbers; text must be finite numbers, .npy values are not checked.
QposFile ReadQposFile(const std::string& path, std::size_t width);

// Throws Error, which names the flag, unless `path` is empty, "-", or ends in .npy, .csv or .txt.
void CheckQposFileName(const std::string& flag, const std::string& path);

// The content of a file with these rows in the format that the ending of `path` says; without an
// ending, text with blanks. Numbers keep all digits.
std::string FormatQposFile(const Rows& rows, std::size_t width, const std::string& path);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_QPOS_FILE_H_
