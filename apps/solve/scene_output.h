// Where `solve --out-mjcf` writes the repaired scene: to a file, which refers to its assets where
// they are, or to a folder, which gets copies of them and can be moved.
#ifndef MJCF_PDG_APPS_SOLVE_SCENE_OUTPUT_H_
#define MJCF_PDG_APPS_SOLVE_SCENE_OUTPUT_H_

#include <string>
#include <vector>

#include "apps/output/output_files.h"
#include "apps/output/repaired_mjcf.h"

namespace mjcf_pdg::app {

class SceneOutput {
 public:
  // Adds FILE.xml, or for DIR/ the scene DIR/NAME.xml, named as `model`, to `outputs`. An empty
  // `path` asks for nothing. Throws Error if that cannot be written, is a stream or one of
  // `inputs`.
  void Add(const std::string& path, const std::string& model,
           const std::vector<std::string>& inputs, OutputFiles& outputs);
  bool wanted() const { return !file_.empty(); }

  // Stages the scene of `model` with its new keyframes and, for a folder, copies of its assets.
  // Throws std::runtime_error unless what will be written loads and has the keyframes.
  void Stage(const std::string& model, const RepairedRows& repaired, OutputFiles& outputs) const;

 private:
  std::string file_;    // of the scene
  std::string folder_;  // that gets the assets, too; empty: none
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_SOLVE_SCENE_OUTPUT_H_
