#include "apps/view/window/panels.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace mjcf_pdg::app {
namespace {

ImVec4 Color(const std::array<float, 3>& rgb) { return {rgb[0], rgb[1], rgb[2], 1.0f}; }

// The ghost's blue as text on a dark ground.
const ImVec4 kBlueText = {0.45f, 0.70f, 1.0f, 1.0f};

void Line(const char* name, const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  ImGui::TextUnformatted(name);
  ImGui::SameLine(ImGui::GetWindowWidth() * 0.42f);
  ImGui::TextUnformatted(text);
}

void Heading(const char* name) {
  ImGui::Spacing();
  ImGui::Separator();
  ImGui::TextUnformatted(name);
}

// The answer to `status` in words, in the colour of the ghost.
void DrawStatus(const Result& result) {
  switch (result.status) {
    case Status::kAlreadyFree:
      return ImGui::TextColored(kBlueText, "free as it is");
    case Status::kSolved:
      return ImGui::TextColored(kBlueText, "repaired");
    case Status::kUnsolved:
      ImGui::TextColored(Color(kGuiltyColor), "not free");
      return ImGui::TextWrapped("%s", result.reason.c_str());
  }
}

// How far the lower bound reaches towards √σ.
void DrawBracket(const Result& result) {
  const double upper = std::sqrt(result.sigma), lower = std::sqrt(result.sigma_lower_bound);
  Line("sigma", "%.4g m^2", result.sigma);
  Line("rms moved", "%.4g mm", 1e3 * upper);
  Line("at least", "%.4g mm", 1e3 * lower);
  const double share = upper > 0 ? std::min(1.0, lower / upper) : 1.0;
  char text[40];
  std::snprintf(text, sizeof text, "bracket: %.0f %% proven", 100 * share);
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram, Color(kGhostColor));
  ImGui::ProgressBar(static_cast<float>(share), ImVec2(-1, 0), text);
  ImGui::PopStyleColor();
}

void GroupRow(const char* name, mjtByte* groups) {
  ImGui::TextUnformatted(name);
  for (int g = 0; g < mjNGROUP; ++g) {
    ImGui::SameLine(ImGui::GetWindowWidth() * (0.22f + 0.125f * static_cast<float>(g)));
    bool on = groups[g] != 0;
    const std::string label = std::to_string(g) + "##" + name;
    if (ImGui::Checkbox(label.c_str(), &on)) groups[g] = on;
  }
}

// The flags of a table of MuJoCo's, two in a line, with their keys.
void Flags(const char* const (*table)[3], int count, mjtByte* flags) {
  ImGui::Columns(2, nullptr, false);
  for (int i = 0; i < count; ++i) {
    bool on = flags[i] != 0;
    const std::string key = table[i][2];
    const std::string label =
        std::string(table[i][0]) + (key.empty() ? "" : " [" + key + "]") + "##flag";
    if (ImGui::Checkbox(label.c_str(), &on)) flags[i] = on;
    ImGui::NextColumn();
  }
  ImGui::Columns(1);
}

}  // namespace

void Panels::DrawRepair(Viewer& viewer) {
  const Result* const result = viewer.result();
  if (!result) return;
  DrawStatus(*result);
  DrawBracket(*result);
  Line("deepest overlap", "%.4g mm", 1e3 * std::max(0.0, -result->depth_in));
  const RepairSession& session = viewer.session();
  Line("tick", "%.3g ms", 1e3 * session.MedianSeconds());
  Line("longest of 120", "%.3g ms", 1e3 * session.LongestSeconds());
  Line("queries", "%.0f", result->stats.collision_queries);
  if (ImGui::Button("Copy mjcf-pdg solve ...")) viewer.CopySolveCommand();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s --qpos ...", viewer.solve_command.c_str());
}

void Panels::DrawContacts(Viewer& viewer) {
  const Result* const result = viewer.result();
  const std::size_t count = result ? result->contacts_in.size() : 0;
  Heading(("Overlaps: " + std::to_string(count)).c_str());
  const float line = ImGui::GetTextLineHeightWithSpacing();
  ImGui::BeginChild("contacts", ImVec2(0, line * std::clamp<float>(count, 1, 8)));
  for (std::size_t k = 0; k < count; ++k) {
    const Contact& contact = result->contacts_in[k];
    char depth[40];
    std::snprintf(depth, sizeof depth, "%7.2f mm  ", -1e3 * contact.distance);
    const std::string text = depth + viewer.GeomName(contact.geom[0]) + ", " +
                             viewer.GeomName(contact.geom[1]) + "##" + std::to_string(k);
    if (ImGui::Selectable(text.c_str())) viewer.LookAt(contact.position_W.data());
  }
  ImGui::EndChild();
}

void Panels::DrawSearch(Viewer& viewer) {
  Heading("Search");
  if (viewer.searching()) {
    ImGui::TextUnformatted("solving ...");
  } else if (ImGui::Button("Solve [Enter]")) {
    viewer.Do({Action::kSolve});
  }
  const std::optional<SearchRecord>& record = viewer.record();
  if (!record) return;
  int step = static_cast<int>(viewer.step());
  const int last = static_cast<int>(record->steps.size()) - 1;
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderInt("##step", &step, 0, last, "iteration %d")) {
    viewer.ShowStep(static_cast<std::size_t>(step));
  }
  const SearchStep& at = record->steps[viewer.step()];
  ImGui::Text("%s, descent %d, step %d: %s", at.start.c_str(), at.descent, at.step,
              at.free ? "free" : "not free");
  Line("rms moved", "%.4g mm", 1e3 * std::sqrt(at.sigma));
  Line("overlaps", "%.4g mm", 1e3 * at.violation);
  std::vector<float> rms;
  for (const SearchStep& one : record->steps) {
    rms.push_back(static_cast<float>(1e3 * std::sqrt(one.sigma)));
  }
  ImGui::PlotLines("##rms", rms.data(), static_cast<int>(rms.size()), 0, "rms moved [mm]", 0.0f,
                   *std::max_element(rms.begin(), rms.end()),
                   ImVec2(ImGui::GetContentRegionAvail().x, 60));
}

void Panels::DrawRows(Viewer& viewer) {
  Heading("Configurations");
  const std::size_t count = viewer.rows().size();
  const float line = ImGui::GetTextLineHeightWithSpacing();
  ImGui::BeginChild("rows", ImVec2(0, line * std::clamp<float>(count, 1, 6)));
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(count));
  while (clipper.Step()) {
    for (int k = clipper.DisplayStart; k < clipper.DisplayEnd; ++k) {
      const std::size_t row = static_cast<std::size_t>(k);
      const std::string label = viewer.rows()[row].label + "##" + std::to_string(k);
      if (ImGui::Selectable(label.c_str(), row == viewer.row())) viewer.ShowRow(row);
    }
  }
  ImGui::EndChild();
  if (ImGui::Button("Play rows")) viewer.PlayRows();
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.78f);
  ImGui::InputTextWithHint("##open", ".npy, .csv, .txt or .jsonl", &open_path_);
  ImGui::SameLine();
  if (ImGui::Button("Open") && !open_path_.empty()) viewer.Open(open_path_);
}

void Panels::DrawSave(Viewer& viewer) {
  Heading("Save the repaired keyframe");
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.65f);
  ImGui::InputText("##save", &viewer.save_path);
  ImGui::SameLine();
  if (ImGui::Button("Save [Ctrl+S]")) viewer.Save();
  if (ImGui::Button("Copy qpos")) viewer.Do({Action::kCopyQpos, 1});
  ImGui::SameLine();
  if (ImGui::Button("Copy repaired qpos")) viewer.Do({Action::kCopyRepaired, 1});
}

void Panels::DrawLook(Viewer& viewer) {
  Shown& shown = viewer.shown;
  ImGui::Checkbox("command", &shown.command);
  ImGui::SameLine();
  ImGui::Checkbox("ghost", &shown.ghost);
  ImGui::SameLine();
  ImGui::Checkbox("own colours", &shown.own_colors);
  GhostScene& scene = viewer.ghost_scene();
  if (ImGui::CollapsingHeader("Groups")) {
    GroupRow("Geom", scene.option.geomgroup);
    GroupRow("Site", scene.option.sitegroup);
    GroupRow("Joint", scene.option.jointgroup);
  }
  if (ImGui::CollapsingHeader("Show")) Flags(mjVISSTRING, mjNVISFLAG, scene.option.flags);
  if (ImGui::CollapsingHeader("Render")) Flags(mjRNDSTRING, mjNRNDFLAG, scene.scene.flags);
}

// As in simulate: hinges and slides of the groups that are shown. Below each slider a blue line
// says where the repair has the joint.
void Panels::DrawJoints(Viewer& viewer) {
  const mjModel& m = viewer.model();
  const std::vector<double>* const repaired = viewer.ghost_q();
  for (int joint = 0; joint < m.njnt; ++joint) {
    const int type = m.jnt_type[joint];
    const int group = std::clamp(m.jnt_group[joint], 0, mjNGROUP - 1);
    if (type != mjJNT_HINGE && type != mjJNT_SLIDE) continue;
    if (!viewer.ghost_scene().option.jointgroup[group]) continue;
    const std::size_t at = static_cast<std::size_t>(m.jnt_qposadr[joint]);
    const std::array<double, 2> range = viewer.SliderRange(joint);
    double value = viewer.session().command()[at];
    ImGui::TextUnformatted(viewer.JointName(joint).c_str());
    ImGui::SetNextItemWidth(-1);
    const std::string label = "##joint" + std::to_string(joint);
    if (ImGui::SliderScalar(label.c_str(), ImGuiDataType_Double, &value, &range[0], &range[1],
                            "%.3f")) {
      viewer.SetJoint(joint, value);
    }
    if (!repaired) continue;
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    const double share = std::clamp(((*repaired)[at] - range[0]) / (range[1] - range[0]), 0.0, 1.0);
    const float x = low.x + static_cast<float>(share) * (high.x - low.x);
    ImGui::GetWindowDrawList()->AddLine(ImVec2(x, low.y), ImVec2(x, high.y),
                                        ImGui::GetColorU32(kBlueText), 3.0f);
  }
}

void Panels::DrawHelp() {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(size.x / 2, size.y / 2), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
  ImGui::Begin("Help [F1]", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::TextUnformatted(
      "left drag               orbit          Space        play, pause\n"
      "[Shift] right drag      pan            Left, Right  step\n"
      "scroll, middle drag     zoom           Up, Down     other row\n"
      "double-click            select         Backspace    reset to the row\n"
      "right double-click      look at        Enter        solve, iteration by iteration\n"
      "Ctrl right double-click track          Esc  [  ]    free camera, fixed ones\n"
      "Ctrl right drag         move selected  Tab          panels (Shift: right)\n"
      "Ctrl left drag          turn selected  Page Up      select the parent\n"
      "0 - 5, Shift 0 - 5      geom and site groups\n"
      "C F H T J ...           contacts, forces, hulls, transparent, joints: see Show\n"
      "Ctrl+C, Ctrl+R          copy qpos, repaired qpos (Shift: all digits)\n"
      "Ctrl+V                  paste a qpos or <key qpos=\"...\"/>\n"
      "Ctrl+S                  save the repaired keyframe\n"
      "Ctrl+A  Ctrl+P  Ctrl+Q  align, screenshot, quit\n"
      "F5  F6  F7              full screen, frames, labels");
  ImGui::End();
}

void Panels::Draw(Viewer& viewer, float scale) {
  constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                      ImGuiWindowFlags_NoCollapse |
                                      ImGuiWindowFlags_NoBringToFrontOnFocus;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float width = kPanelWidth * scale;
  if (viewer.panels.left) {
    ImGui::SetNextWindowPos(ImVec2(0, 0));
    ImGui::SetNextWindowSize(ImVec2(width, size.y));
    ImGui::Begin("Repair", nullptr, kFixed);
    DrawRepair(viewer);
    DrawContacts(viewer);
    DrawSearch(viewer);
    DrawRows(viewer);
    DrawSave(viewer);
    Heading("View");
    DrawLook(viewer);
    ImGui::End();
  }
  if (viewer.panels.right) {
    ImGui::SetNextWindowPos(ImVec2(size.x - width, 0));
    ImGui::SetNextWindowSize(ImVec2(width, size.y));
    ImGui::Begin("Joints", nullptr, kFixed);
    DrawJoints(viewer);
    ImGui::End();
  }
  if (viewer.panels.help) DrawHelp();
  if (viewer.message().empty()) return;
  const float left = viewer.panels.left ? width : 0;
  ImGui::SetNextWindowPos(ImVec2(left + 8, size.y - 8), 0, ImVec2(0, 1));
  ImGui::Begin("message", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                   ImGuiWindowFlags_NoInputs);
  ImGui::TextUnformatted(viewer.message().c_str());
  ImGui::End();
}

}  // namespace mjcf_pdg::app
