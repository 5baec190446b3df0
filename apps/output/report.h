// The output of `solve` and `check`: JSON Lines for programs, tables for people.
#ifndef MJCF_PDG_APPS_OUTPUT_REPORT_H_
#define MJCF_PDG_APPS_OUTPUT_REPORT_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/console/text.h"
#include "apps/input/configurations.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// Returns one line with its line break, numbers at full precision. Bytes that are not UTF-8 are
// replaced.
std::string JsonLine(const nlohmann::ordered_json& value);
std::string Utf8(const std::string& text);  // the same of a text

// The geom's name as a string, or, if it has none, its id as a number, because a geom may be called
// "3".
nlohmann::ordered_json GeomJson(const Scene& scene, int geom);
nlohmann::ordered_json ContactsJson(const Scene& scene, const std::vector<Contact>& contacts);

// Which row a report is about.
struct RowName {
  std::string model;  // empty where there is one model only
  std::size_t index;  // of the row, among those of its model
};

// A line for one row.
std::string SolveJson(const Scene& scene, const RowName& name, const Configuration& row,
                      const Result& result);
std::string CheckJson(const Scene& scene, const RowName& name, const Configuration& row,
                      const Verdict& verdict);

const char* StatusName(Status status);

// Tables are made for people: beyond this many rows only those that are not free are listed, and
// beyond this many of them the rest is only counted.
inline constexpr std::size_t kRowsShown = 1000;

class SolveTable {
 public:
  explicit SolveTable(bool several_models);

  void Add(const Scene& scene, const RowName& name, const Configuration& row, const Result& result);
  // Counts a row that an earlier run has solved.
  void Count(Status status) { ++count_[static_cast<int>(status)]; }

  std::size_t rows() const { return count_[0] + count_[1] + count_[2]; }
  std::size_t unsolved() const { return count_[static_cast<int>(Status::kUnsolved)]; }
  std::string ToString() const;

 private:
  Table table_;
  std::size_t count_[3] = {}, left_out_ = 0, shown_unsolved_ = 0;
  std::string reasons_, geometry_;
};

class CheckTable {
 public:
  // Lists pairs that overlap by more than `tolerance` [m].
  CheckTable(bool several_models, double tolerance);

  void Add(const Scene& scene, const RowName& name, const Configuration& row,
           const Verdict& verdict);

  std::size_t rows() const { return rows_; }
  bool all_free() const { return free_ == rows_; }
  std::string ToString() const;

 private:
  const double tolerance_;
  Table summary_, pairs_;
  std::size_t rows_ = 0, free_ = 0, overlaps_ = 0, left_out_ = 0, shown_not_free_ = 0;
  std::string reasons_, geometry_;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_REPORT_H_
