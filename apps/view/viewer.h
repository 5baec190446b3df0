// The state of the view and what every event does to it: all of `view` but the window itself, which
// hands in keys and mouse motions, calls NextFrame, and draws `ghost_scene().scene`.
#ifndef MJCF_PDG_APPS_VIEW_VIEWER_H_
#define MJCF_PDG_APPS_VIEW_VIEWER_H_

#include <array>
#include <cstddef>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/console/text.h"
#include "apps/view/drag.h"
#include "apps/view/ghost_scene.h"
#include "apps/view/input.h"
#include "apps/view/repair_session.h"
#include "apps/view/script.h"
#include "apps/view/search_record.h"

namespace mjcf_pdg::app {

// What the viewer asks of the program around it. Where a function throws std::exception, its words
// are shown and nothing else happens.
struct ViewServices {
  // Reads the rows of a file.
  std::function<std::vector<Configuration>(const std::string& path)> load;
  // Saves the result as a keyframe into the scene at `path`: made of the row that the command began
  // as, among the mocap bodies of now. Returns the name of the keyframe.
  std::function<std::string(const std::string& path, const Configuration&, const Result&)> save;
  // Told of every tick.
  std::function<void(const Configuration&, const Result&)> ticked;
};

// What Space, left and right go through.
enum class Timeline {
  kLive,    // time: the ghost follows the command
  kRows,    // the rows of configurations, one a frame
  kSearch,  // the iterations of a solve
};

class Viewer {
 public:
  // Keeps a reference to the scene. `rows`: at least one; the first one is shown.
  Viewer(const Scene& scene, const Options& options, std::vector<Configuration> rows,
         ViewServices services);

  // ---- Input ----
  void Press(const KeyPress& press);
  // Positions and distances are shares of the height of the picture, y up; positions from its lower
  // left corner. `aspect`: its width over its height.
  void PressButton(const Held& held, double x, double y, double aspect, bool doubled);
  void ReleaseButton();
  void MoveMouse(const Held& held, double dx, double dy);
  void Scroll(double clicks);
  void Do(const KeyAction& act);
  void SetJoint(int joint, double value);  // of a hinge or slide
  void ShowRow(std::size_t row);
  void ShowStep(std::size_t step);     // of the search
  void PlayRows();                     // from the one that is shown
  void Open(const std::string& path);  // rows from a file, in place of those there are
  void Save();
  void CopySolveCommand();  // that solves the command of now
  void LookAt(const double point_W[3]);
  void Paste(const std::string& text);  // a configuration from qpos="..." or from numbers

  // ---- Time ----
  // A script, which goes on by one frame with every NextFrame. At its end the view is done. Throws
  // Error for a row that there is not.
  void Run(std::vector<ScriptEvent> script);
  // Plays, repairs, and writes the scene to draw.
  void NextFrame();

  // ---- What is to be seen ----
  struct Panels {
    bool left = true, right = true, help = false;
  };
  // Texts for the world outside, each to be taken once; empty: none.
  std::string TakeClipboard() { return std::exchange(clipboard_, {}); }
  std::string TakeScreenshot() { return std::exchange(screenshot_, {}); }
  bool TakeFullScreen() { return std::exchange(full_screen_, false); }
  bool TakePasteRequest() { return std::exchange(paste_, false); }
  bool done() const { return done_; }

  GhostScene& ghost_scene() { return ghost_; }
  const mjModel& model() const;
  const RepairSession& session() const { return session_; }
  const std::vector<Configuration>& rows() const { return rows_; }
  std::size_t row() const { return row_; }
  Timeline timeline() const { return timeline_; }
  bool running() const { return running_; }
  bool searching() const { return search_.running(); }
  const std::optional<SearchRecord>& record() const { return record_; }
  std::size_t step() const { return step_; }  // of the record
  // What the ghost is: the answer of the session or of the record; null: none yet.
  const Result* result() const;
  const std::vector<double>* ghost_q() const;
  std::string GeomName(int geom) const;
  std::string JointName(int joint) const;
  // The values that the slider of a hinge or slide has: the joint's range, half a turn, or the size
  // of the model.
  std::array<double, 2> SliderRange(int joint) const;
  const std::string& message() const { return message_; }
  void Say(const std::string& message) { message_ = message; }

  Panels panels;
  Shown shown;
  std::string save_path;      // where Save writes
  std::string solve_command;  // the command line that solves with these options, all but --qpos

 private:
  void GoLive();
  void MoveBy(const std::array<double, 3>& translation_W);
  void Step(int by);
  void CycleCamera(int by);
  void Solve();
  void FinishSearch();
  void Play();
  void RunScript();
  std::size_t FindRow(const std::string& label) const;
  void Start(const ScriptEvent& event);
  void Copy(const std::vector<double>& q, bool all_digits);
  // Calls `work`, and says what went wrong in it instead of ending the program.
  template <typename Work>
  void Try(Work work) {
    try {
      work();
    } catch (const std::exception& e) {
      Say(OneLine(e.what()));
    }
  }

  const Scene& scene_;
  ViewServices services_;
  RepairSession session_;
  Search search_;
  GhostScene ghost_;
  std::vector<Configuration> rows_;
  std::size_t row_ = 0;
  Timeline timeline_ = Timeline::kLive;
  bool running_ = true;
  std::optional<SearchRecord> record_;
  std::size_t step_ = 0;
  std::optional<Drag> drag_;
  mjvPerturb grabbed_ = {};  // where the hand was when it grabbed
  std::vector<ScriptEvent> script_;
  std::size_t event_ = 0;  // of the script
  int frame_ = 0;          // within the event
  std::string clipboard_, screenshot_, message_;
  bool full_screen_ = false, paste_ = false, done_ = false;
  bool scripted_ = false, single_tick_ = false;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_VIEW_VIEWER_H_
