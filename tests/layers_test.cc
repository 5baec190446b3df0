// The folders of src/ know each other in one direction only: CMakeLists.txt lists them in that
// order, and here every #include is held against it.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace mjcf_pdg {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = MJCF_PDG_SOURCE_DIR;

std::string Contents(const fs::path& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

// What CMakeLists.txt says in set(`name` ...).
std::vector<std::string> CMakeList(const std::string& name) {
  const std::string text = Contents(kRoot / "CMakeLists.txt");
  std::smatch match;
  EXPECT_TRUE(std::regex_search(text, match, std::regex("set\\(" + name + "\\s+([^)]*)\\)")));
  std::istringstream words(match[1]);
  return {std::istream_iterator<std::string>(words), {}};
}

struct SourceFile {
  fs::path path;
  std::string folder;                 // below src/
  std::vector<std::string> includes;  // of quoted headers, without quotes
};

std::vector<SourceFile> Sources() {
  std::vector<SourceFile> sources;
  const std::regex quoted("#include \"([^\"]+)\"");
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "src")) {
    const fs::path extension = entry.path().extension();
    if (extension != ".cc" && extension != ".h") continue;
    SourceFile source{
        entry.path(), entry.path().parent_path().lexically_relative(kRoot / "src"), {}};
    const std::string text = Contents(entry.path());
    for (std::sregex_iterator it(text.begin(), text.end(), quoted), end; it != end; ++it) {
      source.includes.push_back((*it)[1]);
    }
    sources.push_back(std::move(source));
  }
  return sources;
}

// Below public headers, a file may include its own folder and those listed before it.
TEST(LayersTest, NoIncludeGoesUp) {
  const std::vector<std::string> order = CMakeList("library_folders");
  ASSERT_GE(order.size(), 10u);
  int checked = 0;
  for (const SourceFile& source : Sources()) {
    const auto own = std::find(order.begin(), order.end(), source.folder);
    for (const std::string& include : source.includes) {
      if (include.starts_with("mjcf_pdg/")) continue;
      const std::string folder = fs::path(include).parent_path();
      const auto other = std::find(order.begin(), order.end(), folder);
      const bool same = folder == source.folder;
      EXPECT_TRUE(same || (other != order.end() && (own == order.end() || other < own)))
          << source.path << " includes " << include;
      ++checked;
    }
  }
  EXPECT_GE(checked, 200);
}

TEST(LayersTest, EveryFolderBelongsToATarget) {
  std::vector<std::string> listed = CMakeList("library_folders");
  for (const char* list : {"import_folders", "plan_folders"}) {
    for (const std::string& folder : CMakeList(list)) listed.push_back(folder);
  }
  std::set<std::string> found;
  for (const SourceFile& source : Sources()) found.insert(source.folder);
  EXPECT_THAT(listed, testing::UnorderedElementsAreArray(found));
}

// The verifier is independent: of the solver's side it may know nothing but what a name is.
TEST(LayersTest, TheVerifierIncludesNothingOfTheSolver) {
  for (const SourceFile& source : Sources()) {
    if (!source.folder.starts_with("verify")) continue;
    for (const std::string& include : source.includes) {
      const bool may = include.starts_with("mjcf_pdg/") || include.starts_with("verify/") ||
                       include == "base/names.h";
      EXPECT_TRUE(may) << source.path << " includes " << include;
    }
  }
}

// Only the units named for it talk to the libraries that could be exchanged.
TEST(LayersTest, LibrariesAreCalledFromTheirOwnFolders) {
  const std::map<std::string, std::set<std::string>> users = {
      {"#include <fcl/", {"mesh", "collide/exact", "verify", "verify/exact"}},
      {"#include <assimp/", {"import"}},
      {"#include <nlohmann/", {"import"}},
      {"#include <ompl/", {"plan"}},
      {"#include <ruckig/", {"plan"}},
  };
  for (const SourceFile& source : Sources()) {
    const std::string text = Contents(source.path);
    for (const auto& [include, folders] : users) {
      EXPECT_TRUE(text.find(include) == std::string::npos || folders.contains(source.folder))
          << source.path << " has " << include;
    }
  }
}

// Which pairs collide as triangles is read from the tables where collisions are; all others see
// what a pair's kind means for them: PartedByOnePlane and NeedsGap.
TEST(LayersTest, OnlyCollisionKnowsWhichPairsAreTriangles) {
  const std::regex knows("PairKind::kExact|[.>]exact\\b");
  int known = 0;
  for (const SourceFile& source : Sources()) {
    const bool may = source.folder.starts_with("collide") || source.folder == "model" ||
                     source.folder == "verify" || source.path.stem() == "exact_mesh_starts";
    const std::string text = Contents(source.path);
    const bool does = std::regex_search(text, knows);
    EXPECT_TRUE(may || !does) << source.path;
    known += does;
  }
  EXPECT_GE(known, 4);
}

TEST(LayersTest, NoFolderIsAFlatList) {
  std::map<std::string, std::set<std::string>> units;
  for (const SourceFile& source : Sources()) units[source.folder].insert(source.path.stem());
  for (const auto& [folder, names] : units) EXPECT_LE(names.size(), 15u) << folder;
}

}  // namespace
}  // namespace mjcf_pdg
