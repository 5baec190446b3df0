#include "apps/solve/resume.h"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <vector>

#include "apps/input/npy.h"
#include "apps/input/qpos_file.h"
#include "apps/output/output_files.h"

namespace mjcf_pdg::app {
namespace {

Status StatusOf(const nlohmann::json& line, const std::string& origin) {
  const nlohmann::json name = line.is_object() ? line.value("status", nlohmann::json()) : line;
  for (const Status status : {Status::kAlreadyFree, Status::kSolved, Status::kUnsolved}) {
    if (name == StatusName(status)) return status;
  }
  throw Error(origin + ": is not a line that solve wrote");
}

}  // namespace

LeftRows::LeftRows(std::string path) : path_(std::move(path)), file_(path_, std::ios::binary) {
  ReadLine();
}

// A last line without its line break is not whole: getline then meets the end of the file.
void LeftRows::ReadLine() {
  ++line_number_;
  if (!file_ || !std::getline(file_, line_) || file_.eof()) line_.clear();
}

std::size_t LeftRows::Skip(const std::string& model, RowSource& rows, SolveTable& table) {
  std::size_t skipped = 0;
  telling_.reset();
  Configuration row;
  for (; !line_.empty(); ReadLine()) {
    const std::string origin = path_ + " line " + std::to_string(line_number_);
    const nlohmann::json line = nlohmann::json::parse(line_, nullptr, false);
    const Status status = StatusOf(line, origin);
    if (line.value("model", nlohmann::json("")) != model) break;
    if (!rows.Next(row)) throw Error(origin + ": there are fewer configurations than rows");
    if (line.value("qpos_in", nlohmann::json()) != nlohmann::json(row.q)) {
      throw Error(origin + ": is of another configuration than " + row.label);
    }
    table.Count(status);
    if (!telling_ || status != Status::kAlreadyFree) telling_ = {{model, skipped}, row, line_};
    bytes_ += line_.size() + 1;
    ++skipped;
  }
  return skipped;
}

void CheckSolvesAlike(const LeftRow& left, const Scene& scene, const Options& options) {
  if (std::isfinite(options.time_limit)) return;
  Solver solver(scene, options);
  solver.SetMocap(left.row.mocap_pos, left.row.mocap_quat);
  const Result result = solver.Solve(left.row.q);
  const auto comparable = [](const std::string& line) {
    nlohmann::json fields = nlohmann::json::parse(line);
    fields.erase("time_us");
    return fields;
  };
  if (comparable(SolveJson(scene, left.name, left.row, result)) != comparable(left.line)) {
    throw Error("--resume: " + left.row.label +
                " is solved otherwise than the earlier run did: the options, the model or the "
                "version of this program are not the same");
  }
}

std::size_t QposBytes(const std::string& path, std::size_t rows, int width) {
  if (path.empty()) return 0;
  const std::string part = OutputFiles::PartName(path);
  std::ifstream file(part, std::ios::binary);
  std::size_t bytes = 0;
  bool whole = true;
  if (IsNpyFile(path)) {
    bytes = kNpyHeaderBytes + rows * sizeof(double) * static_cast<std::size_t>(width);
    std::error_code ec;
    whole = std::filesystem::file_size(part, ec) >= bytes && !ec;
  } else {
    std::string line;
    for (std::size_t k = 0; k < rows && whole; ++k) {
      whole = static_cast<bool>(std::getline(file, line)) && !file.eof();
      bytes += line.size() + 1;
    }
  }
  if (!whole) throw Error(part + ": has fewer rows than the .part of --json");
  return bytes;
}

}  // namespace mjcf_pdg::app
