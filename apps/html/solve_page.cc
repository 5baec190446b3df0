#include "apps/html/solve_page.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "apps/console/text.h"
#include "apps/html/packed.h"
#include "apps/html/scene_block.h"
#include "apps/html/web_files.h"
#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kFrames = 40;  // of one descent on the slider; more are thinned out
constexpr std::size_t kJoints = 12;  // listed

std::string Escaped(const std::string& text) {
  std::string html;
  for (const char c : Utf8(text)) {
    html += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  }
  return html;
}

// JSON inside a <script>, which "</script" and "<!--" would end.
std::string ScriptJson(const Json& json) {
  std::string text;
  for (const char c : JsonLine(json)) text += c == '<' ? "\\u003c" : std::string(1, c);
  return text;
}

std::string Replaced(std::string text, const std::string& mark, const std::string& by) {
  return text.replace(text.find(mark), mark.size(), by);
}

// As a POSIX shell reads it as one word.
std::string Quoted(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_./,=:+-") == std::string::npos;
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

Json ContactsOf(const Scene& scene, const std::vector<Contact>& contacts) {
  Json list = Json::array();
  for (const Contact& c : contacts) {
    list.push_back({{"geom1", GeomJson(scene, c.geom[0])},
                    {"geom2", GeomJson(scene, c.geom[1])},
                    {"normal", c.normal_W},
                    {"position", c.position_W},
                    {"distance", c.distance}});
  }
  return list;
}

// Name and value of each.
Json Facts(const Result& result) {
  const std::vector<std::pair<std::string, Json>> facts = {
      {"√σ, how far (rms), mm", 1e3 * std::sqrt(result.sigma)},
      {"no free configuration is nearer than, mm", 1e3 * std::sqrt(result.sigma_lower_bound)},
      {"σ, m²", result.sigma},
      {"depth as given, mm", std::max(0.0, -1e3 * result.depth_in)},
      {"smallest distance now, mm", 1e3 * result.min_distance},
      {"start that won", result.start},
      {"iterations", result.stats.iterations},
      {"collision queries", result.stats.collision_queries},
      {"certified (no SDF)", result.certified ? "yes" : "no"}};
  Json list = Json::array();
  for (const auto& [name, value] : facts) list.push_back(Json::array({name, value}));
  return list;
}

// The descent that found the nearest free configuration, but for the last one, which polishes; -1:
// none.
int BestDescent(const std::vector<KeptIteration>& iterations) {
  const KeptIteration* best = nullptr;
  for (const KeptIteration& it : iterations) {
    if (it.free && it.start != "polish" && (!best || it.sigma < best->sigma)) best = &it;
  }
  return best ? best->descent : iterations.empty() ? -1 : iterations.front().descent;
}

// How far joint j is from its place in q_in [rad or m].
double Moved(const mjModel& m, int j, const std::vector<double>& q_in,
             const std::vector<double>& q) {
  const int at = m.jnt_qposadr[j];
  const int type = m.jnt_type[j];
  if (type == mjJNT_HINGE || type == mjJNT_SLIDE) return q[at] - q_in[at];
  if (type == mjJNT_FREE)
    return std::hypot(q[at] - q_in[at], q[at + 1] - q_in[at + 1], q[at + 2] - q_in[at + 2]);
  double dot = 0.0;
  for (int k = 0; k < 4; ++k) dot += q[at + k] * q_in[at + k];
  return 2.0 * std::acos(std::min(1.0, std::abs(dot)));
}

}  // namespace

SolvePage::SolvePage(const Scene& scene, Metric metric, std::string model,
                     std::vector<std::string> options)
    : scene_(scene),
      metric_(metric),
      model_(std::move(model)),
      options_(std::move(options)),
      data_(mj_makeData(scene.model()), mj_deleteData) {}

// Only a keyframe brings poses of mocap bodies.
std::string SolvePage::Command(const Configuration& row) const {
  std::string command = "mjcf-pdg solve " + Quoted(model_);
  for (const std::string& option : options_) command += " " + Quoted(option);
  if (!row.mocap_pos.empty()) return command + " --key " + std::to_string(row.key);
  std::string numbers;
  for (const double value : row.q) numbers += (numbers.empty() ? "" : " ") + Json(value).dump();
  return command + " --qpos '" + numbers + "'";
}

// The terms of σ, the largest first; of joints, how far they moved.
Json SolvePage::Joints(const std::vector<double>& q_in, const std::vector<double>& q) const {
  const mjModel& m = *scene_.model();
  std::map<std::string, int> ids;
  for (int j = 0; j < m.njnt; ++j) ids[scene_.JointName(j)] = j;
  ObjectNorm norm(scene_, metric_, q_in);
  std::vector<NormPart> parts = norm.Parts(q);
  std::stable_sort(parts.begin(), parts.end(),
                   [](const NormPart& a, const NormPart& b) { return a.sigma > b.sigma; });
  double sigma = 0.0;
  for (const NormPart& part : parts) sigma += part.sigma;
  Json list = Json::array();
  for (const NormPart& part : parts) {
    if (list.size() == kJoints || !(part.sigma > 0.0)) break;
    Json joint = {
        {"name", part.name}, {"share", 100.0 * part.sigma / sigma}, {"moved", ""}, {"unit", ""}};
    const auto found = ids.find(part.name);
    if (metric_ == Metric::kSequential && found != ids.end()) {
      const int type = m.jnt_type[found->second];
      const bool turns = type == mjJNT_HINGE || type == mjJNT_BALL;
      joint["moved"] = Moved(m, found->second, q_in, q) * (turns ? 180.0 / M_PI : 1e3);
      joint["unit"] = turns ? "°" : "mm";
    }
    list.push_back(std::move(joint));
  }
  return list;
}

// What the slider goes through: q_in, the descent that led to the answer, the answer.
Json SolvePage::Frames(const SolvedRow& solved, std::vector<float>& poses) const {
  const mjModel& m = *scene_.model();
  Json labels = Json::array();
  const auto add = [&](const std::vector<double>& q, const std::string& label) {
    AppendPoses(m, data_.get(), solved.row, q, poses);
    labels.push_back(label);
  };
  add(solved.row.q, "as given");
  std::vector<const KeptIteration*> steps;
  const int descent = BestDescent(solved.iterations);
  for (const KeptIteration& it : solved.iterations) {
    if (it.descent == descent) steps.push_back(&it);
  }
  const std::size_t stride = steps.size() / kFrames + 1;
  for (std::size_t k = 0; k < steps.size(); k += stride) {
    const KeptIteration& it = *steps[k];
    add(it.q, it.start + ", step " + std::to_string(it.step) + ": √σ " +
                  Short(1e3 * std::sqrt(it.sigma)) + " mm, " +
                  (it.free ? "free" : "overlaps " + Short(1e3 * it.violation) + " mm in sum"));
  }
  add(solved.result.q, solved.result.status == Status::kUnsolved
                           ? "the least overlap that was found"
                           : "the answer, verified");
  return labels;
}

void SolvePage::Add(const SolvedRow& solved) {
  const Result& result = solved.result;
  std::vector<float> poses;
  Json row = {{"frames", Frames(solved, poses)},
              {"facts", Facts(result)},
              {"reason", result.reason},
              {"command", Command(solved.row)},
              {"contacts_in", ContactsOf(scene_, result.contacts_in)},
              {"joints", Joints(solved.row.q, result.q)},
              {"iterations", Json::array()}};
  for (const KeptIteration& it : solved.iterations) {
    row["iterations"].push_back({{"start", it.start},
                                 {"descent", it.descent},
                                 {"step", it.step},
                                 {"sigma", it.sigma},
                                 {"free", it.free}});
  }
  blocks_ += "<script type=\"text/plain\" id=\"row" + std::to_string(rows_.size()) + "\">" +
             Pack(row, BytesOf(poses)) + "</script>\n";
  rows_.push_back({{"label", solved.row.label},
                   {"status", StatusName(result.status)},
                   {"depth", std::max(0.0, -1e3 * result.depth_in)},
                   {"rms", 1e3 * std::sqrt(result.sigma)}});
}

std::string SolvePage::ToString() const {
  std::string page = Replaced(kPageHtml, "@MODEL@", Escaped(model_));
  page = Replaced(std::move(page), "@VERSIONS@",
                  "mjcf-pdg " MJCF_PDG_VERSION ", MuJoCo " + std::string(mj_versionString()));
  page = Replaced(std::move(page), "@PAGE@", ScriptJson({{"rows", rows_}}));
  page = Replaced(std::move(page), "@SCRIPT@", kBundleJs);
  return Replaced(std::move(page), "@BLOCKS@",
                  "<script type=\"text/plain\" id=\"scene\">" + SceneBlock(*scene_.model()) +
                      "</script>\n" + blocks_);
}

}  // namespace mjcf_pdg::app
