// Files of configurations, one per row: .npy, or text (.csv, .txt) with commas or blanks.
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

// "-" reads stdin. Throws Error unless every row has `width` finite numbers and there is one.
QposFile ReadQposFile(const std::string& path, std::size_t width);

// Throws Error if the ending of `path` is none that can be written ("-" is text).
void CheckQposFileName(const std::string& flag, const std::string& path);
std::string FormatQposFile(const Rows& rows, std::size_t width, const std::string& path);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_QPOS_FILE_H_
