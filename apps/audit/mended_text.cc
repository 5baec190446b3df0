#include "apps/audit/mended_text.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <vector>

#include "apps/input/configurations.h"
#include "apps/input/qpos_file.h"
#include "apps/output/repaired_mjcf.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

std::string Escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return out;
}

// The same length, with blanks for comments, so that places in it are places in the text.
std::string WithoutComments(std::string text) {
  for (std::size_t begin = text.find("<!--"); begin != std::string::npos;
       begin = text.find("<!--", begin)) {
    const std::size_t end = std::min(text.find("-->", begin), text.size() - 3) + 3;
    for (; begin < end; ++begin) text[begin] = text[begin] == '\n' ? '\n' : ' ';
  }
  return text;
}

// An opening tag <key ...>, in the text.
struct KeyTag {
  std::size_t begin = 0, length = 0;
  std::string name;  // empty: none
};

std::vector<KeyTag> FindKeyTags(const std::string& code) {
  static const std::regex tag("<key\\s[^>]*>"), name("\\sname\\s*=\\s*[\"']([^\"']*)[\"']");
  std::vector<KeyTag> tags;
  for (std::sregex_iterator it(code.begin(), code.end(), tag), end; it != end; ++it) {
    KeyTag found{static_cast<std::size_t>(it->position()), static_cast<std::size_t>(it->length()),
                 ""};
    const std::string text = it->str();
    std::smatch match;
    if (std::regex_search(text, match, name)) found.name = match[1];
    tags.push_back(found);
  }
  return tags;
}

// Where keyframe `key` stands. With includes, the text has only some of them: those with a name can
// be found.
const KeyTag& FindKey(const std::vector<KeyTag>& tags, const AuditedKey& key, int nkey) {
  if (static_cast<int>(tags.size()) == nkey) return tags[static_cast<std::size_t>(key.key)];
  const auto found = std::find_if(tags.begin(), tags.end(),
                                  [&](const KeyTag& tag) { return tag.name == key.name; });
  if (found == tags.end()) {
    throw Error("--fix: keyframe '" + key.name + "' does not stand in the model's own file");
  }
  return *found;
}

std::string WithQpos(const std::string& tag, const std::vector<double>& q) {
  static const std::regex qpos("(\\sqpos\\s*=\\s*[\"'])([^\"']*)[\"']");
  std::string numbers = FormatQposRow(q, "rows.txt");
  numbers.pop_back();  // its line break
  std::smatch match;
  if (std::regex_search(tag, match, qpos)) {
    return std::string(tag).replace(static_cast<std::size_t>(match.position(2)),
                                    static_cast<std::size_t>(match.length(2)), numbers);
  }
  return "<key qpos=\"" + numbers + "\"" + tag.substr(4);
}

// The model compiled with the <exclude> lines.
std::unique_ptr<mjModel, void (*)(mjModel*)> Excluding(const std::string& model,
                                                       const Audit& audit) {
  const SpecPtr spec = ParseSpec(model);
  for (const auto& [body1, body2] : audit.exclude) {
    mjsExclude* exclude = mjs_addExclude(spec.get());
    mjs_setString(exclude->bodyname1, body1.c_str());
    mjs_setString(exclude->bodyname2, body2.c_str());
  }
  std::unique_ptr<mjModel, void (*)(mjModel*)> compiled(mj_compile(spec.get(), nullptr),
                                                        mj_deleteModel);
  if (!compiled) throw Error(model + ": " + mjs_getError(spec.get()));
  return compiled;
}

// Keyframes that are to be replaced, the last in the text first.
std::string WithRepairedKeys(std::string text, const mjModel& model, const Audit& audit) {
  const Scene scene = Scene::FromModel(&model);
  const std::vector<KeyTag> tags = FindKeyTags(WithoutComments(text));
  std::vector<std::pair<KeyTag, std::vector<double>>> replaced;
  Solver solver(scene);
  for (const AuditedKey& key : audit.keys) {
    if (key.key < 0 || !(key.penetrates || key.leaves_limits)) continue;
    Configuration row;
    for (RowSource source(scene, {}); source.Next(row) && row.key != key.key;) continue;
    solver.SetMocap(row.mocap_pos, row.mocap_quat);
    const Result result = solver.Solve(row.q);
    if (result.status != Status::kSolved) continue;
    replaced.emplace_back(FindKey(tags, key, model.nkey), result.q);
  }
  std::sort(replaced.begin(), replaced.end(),
            [](const auto& a, const auto& b) { return a.first.begin > b.first.begin; });
  for (const auto& [tag, q] : replaced) {
    text.replace(tag.begin, tag.length, WithQpos(text.substr(tag.begin, tag.length), q));
  }
  return text;
}

std::string WithExcludes(std::string text, const Audit& audit) {
  if (audit.exclude.empty()) return text;
  const std::size_t end = WithoutComments(text).rfind("</mujoco");
  if (end == std::string::npos) throw Error("--fix: the model has no </mujoco>");
  std::string lines = "  <contact>\n";
  for (const auto& [body1, body2] : audit.exclude) {
    lines += "    " + ExcludeLine(body1, body2) + "\n";
  }
  return text.insert(end, lines + "  </contact>\n");
}

}  // namespace

std::string ExcludeLine(const std::string& body1, const std::string& body2) {
  return "<exclude body1=\"" + Escaped(body1) + "\" body2=\"" + Escaped(body2) + "\"/>";
}

std::string MendedText(const std::string& model, const Scene& scene, const Audit& audit,
                       const std::string& target) {
  std::error_code ec;
  const fs::path from = fs::weakly_canonical(fs::absolute(model), ec).parent_path();
  const fs::path to = fs::weakly_canonical(fs::absolute(target), ec).parent_path();
  if (from != to) throw Error("--fix: " + target + ": must be in the folder of " + model);
  std::ifstream file(model, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (fs::path(model).extension() == ".mjb" || text.find('\0') != std::string::npos) {
    throw Error("--fix: " + model + " is no text");
  }
  if (scene.model()->nkey > 0) {
    const auto excluding = Excluding(model, audit);
    text = WithRepairedKeys(std::move(text), *excluding, audit);
  }
  return WithExcludes(std::move(text), audit);
}

}  // namespace mjcf_pdg::app
