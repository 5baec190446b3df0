// A suite: models, configurations and options to be solved again and again, as a small JSON file.
// docs/regress.md describes the format.
#ifndef MJCF_PDG_APPS_REGRESS_SUITE_H_
#define MJCF_PDG_APPS_REGRESS_SUITE_H_

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {

// One entry of `configurations`.
struct SuiteRows {
  enum class Kind { kKeyframes, kQpos0, kFile, kRandom };
  Kind kind = Kind::kKeyframes;
  std::string file;        // kFile: as the suite says it
  std::size_t count = 0;   // kRandom
  std::uint64_t seed = 0;  // kRandom
};

struct SuiteCase {
  std::string model;  // below the suite's folder, as golden results name it
  std::vector<SuiteRows> rows;
  SceneOptions scene;
  Options options;
  nlohmann::ordered_json given = nlohmann::ordered_json::object();  // both, as the suite says them
};

struct Suite {
  std::string path;              // of the file, as given
  std::filesystem::path folder;  // that paths in it are relative to
  std::vector<SuiteCase> cases;
  // What counts as a change: relative, of σ of a row and of the queries of a model.
  double sigma_tolerance = 0.01, queries_tolerance = 0.25;

  std::string golden() const;  // the file of golden results, beside the suite
};

// Throws Error, one line that names the file and what in it, for anything that is no suite.
Suite ReadSuite(const std::string& path);

// The text of a suite whose cases have nothing but a model.
std::string FormatSuite(const Suite& suite);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_REGRESS_SUITE_H_
