#include "apps/html/page.h"

#include <cmath>
#include <utility>

#include "apps/html/packed.h"
#include "apps/html/scene_block.h"
#include "apps/html/web_files.h"
#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

// JSON inside a <script>, which "</script" and "<!--" would end.
std::string ScriptJson(const Json& json) {
  std::string text;
  for (const char c : JsonLine(json)) text += c == '<' ? "\\u003c" : std::string(1, c);
  return text;
}

std::string Replaced(std::string text, const std::string& mark, const std::string& by) {
  return text.replace(text.find(mark), mark.size(), by);
}

std::string Block(const std::string& id, const std::string& packed) {
  return "<script type=\"text/plain\" id=\"" + id + "\">" + packed + "</script>\n";
}

}  // namespace

Page::Page(PageHead head)
    : head_({{"again", std::move(head.again)},
             {"note", std::move(head.note)},
             {"columns", std::move(head.columns)},
             {"options", std::move(head.options)},
             {"versions",
              "mjcf-pdg " MJCF_PDG_VERSION ", MuJoCo " + std::string(mj_versionString())}}) {}

void Page::BeginModel(const std::string& name, const Scene& scene) {
  BeginModel(name);
  scene_ = scene;
  data_.reset(mj_makeData(scene.model()), mj_deleteData);
  blocks_ += Block("scene" + std::to_string(models_.size() - 1), SceneBlock(*scene.model()));
}

void Page::BeginModel(const std::string& name) {
  models_.push_back(name);
  scene_.reset();
}

void Page::AddTable(PageTable table) {
  table.command = head_["again"];
  tables_.push_back(TableJson(table));
}

void Page::GoBack(const Place& place) {
  rows_.erase(rows_.begin() + static_cast<std::ptrdiff_t>(place.rows), rows_.end());
  models_.erase(models_.begin() + static_cast<std::ptrdiff_t>(place.models), models_.end());
  blocks_.resize(place.bytes);
}

Json Page::TableJson(const PageTable& table) {
  Json json = {{"title", table.title}, {"columns", table.columns}, {"rows", table.rows}};
  if (!table.frames.empty()) json["frames"] = table.frames;
  if (!table.command.empty()) json["command"] = table.command;
  return json;
}

void Page::Add(const PageRow& row) {
  Json content = row.content;
  content["frames"] = Json::array();
  std::vector<double> q;
  std::vector<float> poses;
  for (const PageFrame& frame : row.frames) {
    q.insert(q.end(), frame.q.begin(), frame.q.end());
    AppendPoses(*scene_->model(), data_.get(), row.of, frame.q, poses);
    content["frames"].push_back({{"label", frame.label}, {"iteration", frame.iteration}});
  }
  content["tables"] = Json::array();
  for (const PageTable& table : row.tables) content["tables"].push_back(TableJson(table));
  content["nq"] = row.frames.empty() ? 0 : row.frames.front().q.size();
  std::string bytes(BytesOf(q));
  bytes += BytesOf(poses);
  blocks_ += Block("row" + std::to_string(rows_.size()), Pack(content, bytes));
  rows_.push_back({{"model", models_.size() - 1},
                   {"label", row.of.label},
                   {"status", row.status},
                   {"wrong", row.wrong},
                   {"values", row.values}});
}

std::string Page::ToString() const {
  Json page = head_;
  page["models"] = models_;
  page["rows"] = rows_;
  page["tables"] = tables_;
  std::string html = Replaced(kPageHtml, "@PAGE@", ScriptJson(page));
  html = Replaced(std::move(html), "@SCRIPT@", kBundleJs);
  return Replaced(std::move(html), "@BLOCKS@", blocks_);
}

std::string PageGeomName(const Scene& scene, int geom) {
  const Json name = GeomJson(scene, geom);
  return scene.GeomName(geom) + (name.is_number() ? " (" + name.dump() + ")" : "");
}

Json PageContacts(const Scene& scene, const std::vector<Contact>& contacts) {
  Json list = Json::array();
  for (const Contact& c : contacts) {
    list.push_back({{"geoms", c.geom},
                    {"geom1", PageGeomName(scene, c.geom[0])},
                    {"geom2", PageGeomName(scene, c.geom[1])},
                    {"normal", c.normal_W},
                    {"position", c.position_W},
                    {"distance", c.distance}});
  }
  return list;
}

}  // namespace mjcf_pdg::app
