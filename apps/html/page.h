// The report of `--html`, whatever command writes it: one file that opens in any browser and loads
// nothing. A command says what its rows are (solved_row, checked_row, ...); here they are packed.
#ifndef MJCF_PDG_APPS_HTML_PAGE_H_
#define MJCF_PDG_APPS_HTML_PAGE_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/input/configurations.h"
#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::app {

struct PageHead {
  std::string again;                 // the command line that makes all of it again
  std::vector<std::string> columns;  // of the list of rows, behind number, name and status
  nlohmann::ordered_json options;    // OptionsInForce
  std::string note = {};             // what is to be known of `again`, in words
};

// One place of the slider.
struct PageFrame {
  std::vector<double> q;  // nq
  std::string label;
  int iteration = -1;  // which of the row's iterations; -1: none
};

// A table of a row or of the whole page.
struct PageTable {
  std::string title;
  std::vector<std::string> columns;
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();  // lists of cells
  std::vector<std::size_t> frames;  // of a row's table: where a line of it leads; empty: nowhere
  std::string command;              // of a row's table: makes it again, where the row's does not
};

struct PageRow {
  Configuration of;  // its label, and the mocap poses of all frames
  std::string status;
  bool wrong = false;             // the status is bad news
  std::vector<double> values;     // one for each column; NaN: none
  std::vector<PageFrame> frames;  // the first is as given; none: there is nothing to draw
  std::vector<PageTable> tables;
  // More that web/report.js shows, each of it may be missing: facts (names and values), reason,
  // command, note (what is to be known of it), norm (a command without its ends, which gives joints
  // again), trace (a command that gives the iterations again), contacts_in, contacts,
  // contacts_goal, contacts_stop (PageContacts), stop (a command that gives contacts_stop again),
  // joints (PageJoints), iterations, before (what the first frame is called), opens (the frame that
  // is shown at first, and that contacts_stop is of; without it the last).
  nlohmann::ordered_json content = nlohmann::ordered_json::object();
};

// Each row is packed by itself as it comes, and unpacked when it is looked at. Meshes are kept once
// for each model.
class Page {
 public:
  explicit Page(PageHead head);

  // The rows that follow are of this model; without a scene they have no frames.
  void BeginModel(const std::string& name, const Scene& scene);
  void BeginModel(const std::string& name);
  void Add(const PageRow& row);
  void AddTable(PageTable table);
  // How far the page has come; GoBack removes the models and rows that were added since.
  struct Place {
    std::size_t rows, models, bytes;
  };
  Place Here() const { return {rows_.size(), models_.size(), blocks_.size()}; }
  void GoBack(const Place& place);
  std::string ToString() const;

 private:
  static nlohmann::ordered_json TableJson(const PageTable& table);

  nlohmann::ordered_json head_;
  nlohmann::ordered_json models_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json rows_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json tables_ = nlohmann::ordered_json::array();
  std::optional<Scene> scene_;  // of the present model
  std::shared_ptr<mjData> data_;
  std::string blocks_;
};

// A line of `facts`.
inline nlohmann::ordered_json PageFact(const std::string& name, nlohmann::ordered_json value) {
  return nlohmann::ordered_json::array({name, std::move(value)});
}

// The geom's place and, where it has no name, the id that JSON has: "torso/geom1 (8)".
std::string PageGeomName(const Scene& scene, int geom);
nlohmann::ordered_json PageContacts(const Scene& scene, const std::vector<Contact>& contacts);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_PAGE_H_
