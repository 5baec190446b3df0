// solve --resume: what an interrupted run left in F.part.
#ifndef MJCF_PDG_APPS_SOLVE_RESUME_H_
#define MJCF_PDG_APPS_SOLVE_RESUME_H_

#include <cstddef>
#include <fstream>
#include <optional>
#include <string>

#include "apps/input/configurations.h"
#include "apps/output/report.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// A row that an earlier run wrote: what was asked, and its line of JSON.
struct LeftRow {
  RowName name;
  Configuration row;
  std::string line;
};

// The rows in a JSON Lines file that was left unfinished; none if there is no such file.
class LeftRows {
 public:
  explicit LeftRows(std::string path);

  // Takes rows off `rows` as long as the file has rows of `model` (empty: there is only one), and
  // counts their status in `table`. Returns how many there were. Throws Error if the file has a row
  // of another configuration, or none of ours.
  std::size_t Skip(const std::string& model, RowSource& rows, SolveTable& table);
  // Of the rows that the last call of Skip took, the last one that was not free already, else the
  // last one.
  const std::optional<LeftRow>& telling() const { return telling_; }
  // Bytes of the file up to here: what follows, a row that is not whole, is to be cut off.
  std::size_t bytes() const { return bytes_; }

 private:
  const std::string path_;
  std::ifstream file_;
  std::string line_;  // the next one, without its line break; empty: none
  std::size_t bytes_ = 0, line_number_ = 0;
  std::optional<LeftRow> telling_;

  void ReadLine();
};

// Solves a row again, and throws Error if that gives another line (times aside): the earlier run
// then had other options, another model, or was another version of this program. With a time limit
// nothing is compared, since lines may differ.
void CheckSolvesAlike(const LeftRow& left, const Scene& scene, const Options& options);

// Bytes of what --out-qpos `path` left in its .part: its first `rows` rows of `width` numbers.
// Throws Error if it has fewer.
std::size_t QposBytes(const std::string& path, std::size_t rows, int width);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_SOLVE_RESUME_H_
