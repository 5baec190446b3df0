#include "apps/console/text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

// Columns that the text takes on a terminal; UTF-8 continuation bytes take none.
std::size_t Width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

bool LooksNumeric(const std::string& cell) {
  return !cell.empty() && (cell == "-" || std::isdigit(static_cast<unsigned char>(cell.back()))) &&
         cell.find_first_not_of("+-.0123456789einf") == std::string::npos;
}

double ParseNumber(std::string_view token, const std::string& what) {
  std::string_view digits = token;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, ec] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const std::string quoted = "'" + OneLine(token.substr(0, 40)) + "'";
  if (ec == std::errc::invalid_argument || end != digits.data() + digits.size()) {
    throw Error(what + ": " + quoted + " is not a number");
  }
  if (ec == std::errc::result_out_of_range) {
    throw Error(what + ": " + quoted + " is out of range");
  }
  if (!std::isfinite(value)) throw Error(what + ": " + quoted + " is not finite");
  return value;
}

}  // namespace

std::string OneLine(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const bool control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    if (control && (line.empty() || line.back() == ' ')) continue;
    line += control ? ' ' : c;
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

std::string Short(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

std::vector<double> ParseNumbers(std::string_view line, const std::string& what) {
  std::vector<double> values;
  std::size_t i = 0;
  bool after_comma = false;
  while (true) {
    while (i < line.size() && IsBlank(line[i])) ++i;
    if (i == line.size()) break;
    if (line[i] == ',') {
      if (values.empty() || after_comma) throw Error(what + ": empty field before a comma");
      after_comma = true;
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < line.size() && !IsBlank(line[end]) && line[end] != ',') ++end;
    values.push_back(ParseNumber(line.substr(i, end - i), what));
    after_comma = false;
    i = end;
  }
  if (after_comma) throw Error(what + ": empty field after the last comma");
  return values;
}

Table::Table(std::vector<std::string> heading) { AddRow(std::move(heading)); }

void Table::AddRow(std::vector<std::string> cells) {
  for (std::string& cell : cells) cell = OneLine(cell);
  rows_.push_back(std::move(cells));
}

std::string Table::ToString() const {
  const std::size_t columns = rows_.front().size();
  std::vector<std::size_t> width(columns, 0);
  std::vector<char> right(columns, rows_.size() > 1);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      width[c] = std::max(width[c], Width(rows_[r][c]));
      if (r > 0 && !LooksNumeric(rows_[r][c])) right[c] = 0;
    }
  }
  std::string text;
  for (const std::vector<std::string>& row : rows_) {
    std::string line;
    for (std::size_t c = 0; c < columns; ++c) {
      const std::string padding(width[c] - Width(row[c]), ' ');
      line += (c > 0 ? "  " : "") + (right[c] ? padding + row[c] : row[c] + padding);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

void WriteWarning(const std::string& text) {
  std::fprintf(stderr, "mjcf-pdg: warning: %s\n", OneLine(text).c_str());
}

void WriteStdout(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!written || std::fflush(stdout) != 0) {
    throw std::runtime_error("cannot write to stdout");
  }
}

}  // namespace mjcf_pdg::app
