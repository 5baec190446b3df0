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

// What a model may be reset to whose qpos0 penetrates.
constexpr char kDefaultKey[] = "qpos0_pdg";

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

bool IsUrdf(const std::string& text) {
  static const std::regex tag("<([A-Za-z]+)");
  std::smatch first;
  const std::string code = WithoutComments(text);
  return std::regex_search(code, first, tag) && first[1] == "robot";
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

// What replaces keyframes that are wrong, and the new lines of the model.
struct Mending {
  std::vector<std::pair<KeyTag, std::vector<double>>> keys;
  std::vector<std::string> contact, keyframe;
};

// A keyframe `key` of the scene, or qpos0, made free; empty if it cannot be.
std::vector<double> Repaired(const Scene& scene, Solver& solver, int key) {
  Configuration row;
  row.q = scene.DefaultQpos();
  if (key >= 0) {
    for (RowSource source(scene, {}); source.Next(row) && row.key != key;) continue;
  }
  solver.SetMocap(row.mocap_pos, row.mocap_quat);
  const Result result = solver.Solve(row.q);
  return result.status == Status::kSolved ? result.q : std::vector<double>();
}

void MendKeys(const mjModel& model, const Audit& audit, const std::vector<KeyTag>& tags,
              Mending& mending) {
  const Scene scene = Scene::FromModel(&model);
  Solver solver(scene);
  for (const AuditedKey& key : audit.keys) {
    if (!key.penetrates && !key.leaves_limits) continue;
    const std::vector<double> q = Repaired(scene, solver, key.key);
    if (q.empty()) continue;
    if (key.key >= 0) {
      mending.keys.emplace_back(FindKey(tags, key, static_cast<int>(model.nkey)), q);
    } else if (mj_name2id(&model, mjOBJ_KEY, kDefaultKey) < 0) {
      mending.keyframe.push_back(WithQpos(std::string("<key name=\"") + kDefaultKey + "\"/>", q));
    }
  }
  std::sort(mending.keys.begin(), mending.keys.end(),
            [](const auto& a, const auto& b) { return a.first.begin > b.first.begin; });
}

std::string Section(const std::string& name, const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string text = "  <" + name + ">\n";
  for (const std::string& line : lines) text += "    " + line + "\n";
  return text + "  </" + name + ">\n";
}

// The new lines go to the end of the model, and keyframes are replaced from the last on, so that
// the places of those before stay what they are.
std::string Applied(std::string text, const Mending& mending) {
  const std::string lines =
      Section("contact", mending.contact) + Section("keyframe", mending.keyframe);
  if (!lines.empty()) {
    const std::size_t end = WithoutComments(text).rfind("</mujoco");
    if (end == std::string::npos) throw Error("--fix: the model has no </mujoco>");
    text.insert(end, lines);
  }
  for (const auto& [tag, q] : mending.keys) {
    text.replace(tag.begin, tag.length, WithQpos(text.substr(tag.begin, tag.length), q));
  }
  return text;
}

}  // namespace

std::string ExcludeLine(const std::string& body1, const std::string& body2) {
  return "<exclude body1=\"" + Escaped(body1) + "\" body2=\"" + Escaped(body2) + "\"/>";
}

std::string MendedText(const std::string& model, const Audit& audit, const std::string& target) {
  std::error_code ec;
  const fs::path from = fs::weakly_canonical(fs::absolute(model), ec).parent_path();
  const fs::path to = fs::weakly_canonical(fs::absolute(target), ec).parent_path();
  if (from != to) throw Error("--fix: " + target + ": must be in the folder of " + model);
  std::ifstream file(model, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (fs::path(model).extension() == ".mjb" || text.find('\0') != std::string::npos) {
    throw Error("--fix: " + model + " is no text");
  }
  if (IsUrdf(text)) {
    throw Error("--fix: " + model +
                " is a URDF, which has neither excludes nor keyframes: let solve " +
                "--out-mjcf write it as MJCF");
  }
  Mending mending;
  for (const auto& [body1, body2] : audit.exclude) {
    mending.contact.push_back(ExcludeLine(body1, body2));
  }
  const bool mend_keys = std::any_of(audit.keys.begin(), audit.keys.end(), [](const auto& key) {
    return key.penetrates || key.leaves_limits;
  });
  if (mend_keys) {
    const auto excluding = Excluding(model, audit);
    MendKeys(*excluding, audit, FindKeyTags(WithoutComments(text)), mending);
  }
  return Applied(std::move(text), mending);
}

}  // namespace mjcf_pdg::app
