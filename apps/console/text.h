// Small text helpers: one-line messages, number parsing, aligned tables, checked stdout.
#ifndef MJCF_PDG_APPS_CONSOLE_TEXT_H_
#define MJCF_PDG_APPS_CONSOLE_TEXT_H_

#include <string>
#include <string_view>
#include <vector>

namespace mjcf_pdg::app {

// The text in one line: line breaks and other control characters become blanks.
std::string OneLine(std::string_view text);

// The number with four significant digits, for tables; JSON and files have all digits.
std::string Short(double value);

// The numbers of one line, separated by blanks or single commas. Throws Error, which begins with
// `what`, for anything that is not a finite number.
std::vector<double> ParseNumbers(std::string_view line, const std::string& what);

// A table of text with a heading. Columns are padded to equal width; columns of numbers are aligned
// to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> heading);
  void AddRow(std::vector<std::string> cells);  // as many cells as the heading has
  std::string ToString() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

// Writes and flushes. Throws std::runtime_error if stdout does not take all (a closed pipe, a full
// disk).
void WriteStdout(const std::string& text);

// Writes one line "mjcf-pdg: warning: ..." to stderr.
void WriteWarning(const std::string& text);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_CONSOLE_TEXT_H_
