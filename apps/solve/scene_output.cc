#include "apps/solve/scene_output.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "apps/output/asset_files.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

constexpr char kFlag[] = "--out-mjcf";

std::string ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw std::runtime_error(path + ": cannot be read");
  return content;
}

void AddToVfs(const std::string& name, const std::string& content, mjVFS& vfs) {
  const int size = static_cast<int>(content.size());
  if (mj_addBufferVFS(&vfs, name.c_str(), content.data(), size) != 0) {
    throw std::runtime_error(name + ": MuJoCo cannot hold it in memory");
  }
}

// The folder is checked in memory, because its files get their names only when all are whole.
void StageFolder(const std::string& folder, const std::string& file, const RepairedRows& repaired,
                 mjSpec* spec, OutputFiles& outputs) {
  mjVFS vfs;
  mj_defaultVFS(&vfs);
  const std::unique_ptr<mjVFS, void (*)(mjVFS*)> owner(&vfs, mj_deleteVFS);
  const std::vector<AssetCopy> copies = GatherAssets(spec);
  if (!copies.empty()) outputs.AddFolder(kFlag, folder + "/assets");
  for (const AssetCopy& copy : copies) {
    const std::string content = ReadFile(copy.from), target = folder + "/" + copy.to;
    AddToVfs(copy.to, content, vfs);
    std::error_code ec;
    if (fs::equivalent(copy.from, target, ec)) continue;  // it is there already
    outputs.Add(kFlag, target, {});
    outputs.Stage(target, content);
  }
  const std::string text = FormatMjcf(spec), name = fs::path(file).filename().string();
  outputs.Stage(file, text);
  AddToVfs(name, text, vfs);
  CheckMjcf(name, &vfs, repaired);
}

}  // namespace

void SceneOutput::Add(const std::string& path, const std::string& model,
                      const std::vector<std::string>& inputs, OutputFiles& outputs) {
  if (path.empty()) return;
  file_ = path;
  if (path.back() == '/') {
    folder_ = path.substr(0, path.find_last_not_of('/') + 1);
    outputs.AddFolder(kFlag, folder_.empty() ? "/" : folder_);
    file_ = folder_ + "/" + fs::path(model).stem().string() + ".xml";
  }
  outputs.Add(kFlag, file_, inputs);
  outputs.StagedName(file_);  // relative paths in the MJCF need a file, no stream
}

void SceneOutput::Stage(const std::string& model, const RepairedRows& repaired,
                        OutputFiles& outputs) const {
  const SpecPtr spec = ParseSpec(model);
  AddRepairedKeys(repaired, spec.get());
  if (!folder_.empty()) return StageFolder(folder_, file_, repaired, spec.get(), outputs);
  const std::string staged = outputs.StagedName(file_);
  RelocateAssets(spec.get(), fs::path(staged).parent_path().string());
  outputs.Stage(file_, FormatMjcf(spec.get()));
  CheckMjcf(staged, nullptr, repaired);
}

}  // namespace mjcf_pdg::app
