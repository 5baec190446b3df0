#include "apps/output/asset_files.h"

#include <algorithm>
#include <filesystem>
#include <functional>

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

// The file that MuJoCo finds under the name `file`; empty if that is no plain file. An attached
// model has folders of its own, so a single meshdir would not do.
fs::path FindAsset(mjSpec* spec, mjsElement* element, const fs::path& file, bool texture) {
  const mjsCompiler* compiler = mjs_getCompiler(element);
  const fs::path assets = mjs_getString(texture ? compiler->texturedir : compiler->meshdir);
  const mjSpec* origin = mjs_getOriginSpec(element);
  const fs::path name = spec->strippath ? file.filename() : file;
  for (const mjSpec* owner : {origin ? origin : spec, static_cast<const mjSpec*>(spec)}) {
    const fs::path found = fs::path(mjs_getString(owner->modelfiledir)) / assets / name;
    std::error_code ec;
    if (fs::exists(found, ec)) return found;
  }
  return {};
}

template <typename Visit>
void ForEachElement(mjSpec* spec, mjtObj type, Visit visit) {
  for (mjsElement* e = mjs_firstElement(spec, type); e; e = mjs_nextElement(spec, e)) visit(e);
}

// Gives each asset file the name that `name_of` has for where it is. One that is not found keeps
// its own; loading the written scene tells whether that does.
void RenameAssets(mjSpec* spec, const std::function<std::string(const fs::path&)>& name_of) {
  auto renamed = [&](mjsElement* element, const fs::path& file, bool texture) {
    const fs::path found = FindAsset(spec, element, file, texture);
    if (!found.empty()) return name_of(found);
    return (spec->strippath ? file.filename() : file).string();
  };
  auto rename = [&](mjsElement* element, mjString* file, bool texture) {
    const std::string old = mjs_getString(file);
    if (!old.empty()) mjs_setString(file, renamed(element, old, texture).c_str());
  };
  ForEachElement(spec, mjOBJ_MESH, [&](mjsElement* e) { rename(e, mjs_asMesh(e)->file, false); });
  ForEachElement(spec, mjOBJ_HFIELD,
                 [&](mjsElement* e) { rename(e, mjs_asHField(e)->file, false); });
  ForEachElement(spec, mjOBJ_SKIN, [&](mjsElement* e) { rename(e, mjs_asSkin(e)->file, false); });
  ForEachElement(spec, mjOBJ_TEXTURE, [&](mjsElement* e) {
    mjsTexture* texture = mjs_asTexture(e);
    rename(e, texture->file, true);
    constexpr int kCubeSides = 6;
    for (int side = 0; side < kCubeSides; ++side) {
      const char* file = mjs_getInStringVec(texture->cubefiles, side);
      if (!file || !*file) continue;
      mjs_setInStringVec(texture->cubefiles, side, renamed(e, file, true).c_str());
    }
  });
  mjs_setString(spec->compiler.meshdir, "");
  mjs_setString(spec->compiler.texturedir, "");
  spec->strippath = 0;
}

}  // namespace

void RelocateAssets(mjSpec* spec, const std::string& folder) {
  RenameAssets(spec, [&folder](const fs::path& found) {
    std::error_code ec;
    // fs::relative makes both paths canonical, since a ".." after a symbolic link leads elsewhere.
    const fs::path relative = fs::relative(found, folder, ec);
    return ec || relative.empty() ? fs::canonical(found).string() : relative.string();
  });
}

std::vector<AssetCopy> GatherAssets(mjSpec* spec) {
  std::vector<AssetCopy> copies;
  const auto taken = [&copies](const std::string& name) {
    return std::any_of(copies.begin(), copies.end(),
                       [&name](const AssetCopy& copy) { return copy.to == name; });
  };
  RenameAssets(spec, [&](const fs::path& found) {
    const std::string from = fs::canonical(found).string();
    const auto known = std::find_if(copies.begin(), copies.end(),
                                    [&from](const AssetCopy& copy) { return copy.from == from; });
    if (known != copies.end()) return known->to;
    const std::string stem = "assets/" + found.stem().string(), end = found.extension().string();
    std::string name = stem + end;
    for (int n = 2; taken(name); ++n) name = stem + "_" + std::to_string(n) + end;
    copies.push_back({from, name});
    return name;
  });
  return copies;
}

}  // namespace mjcf_pdg::app
