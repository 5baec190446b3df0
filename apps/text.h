// Small text helpers: one-line messages, number parsing, aligned tables, checked stdout.
#ifndef MJCF_PDG_APPS_TEXT_H_
#define MJCF_PDG_APPS_TEXT_H_

#include <string>
#include <string_view>
#include <vector>

namespace mjcf_pdg::app {

// Line breaks and other control characters become blanks.
std::string OneLine(std::string_view text);

// Four significant digits for tables; JSON and files carry all of them.
std::string Short(double value);

// The numbers of one line, separated by blanks or single commas. Throws Error, which begins with
// `what`, for anything that is not a finite number.
std::vector<double> ParseNumbers(std::string_view line, const std::string& what);

// Rows of cells, the first row the heading; columns padded to equal width, numbers to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> heading);
  void AddRow(std::vector<std::string> cells);
  std::string ToString() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

// Throws std::runtime_error when stdout does not take it all (a closed pipe, a full disk).
void WriteStdout(const std::string& text);

// One line on stderr.
void WriteWarning(const std::string& text);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_TEXT_H_
