#include "apps/solve/trace.h"

#include <mujoco/mujoco.h>

#include <nlohmann/json.hpp>

#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;  // of the trace

Json JointJson(const Scene& scene, int joint) {
  const char* name = mj_id2name(scene.model(), mjOBJ_JOINT, joint);
  return name && *name ? Json(name) : Json(joint);
}

Json RowsJson(const Scene& scene, const std::vector<ObservedRow>& rows) {
  Json list = Json::array();
  for (const ObservedRow& row : rows) {
    Json json;
    if (row.joint >= 0) {
      json["joint"] = JointJson(scene, row.joint);
    } else {
      json["geom1"] = GeomJson(scene, row.geom[0]);
      json["geom2"] = GeomJson(scene, row.geom[1]);
    }
    json["gap"] = row.gap;
    json["multiplier"] = row.multiplier;
    list.push_back(std::move(json));
  }
  return list;
}

Json IterationJson(const Scene& scene, std::size_t index, const KeptIteration& it) {
  return {{"row", index},      {"descent", it.descent}, {"step", it.step},
          {"start", it.start}, {"sigma", it.sigma},     {"violation", it.violation},
          {"free", it.free},   {"qpos", it.q},          {"rows", RowsJson(scene, it.rows)}};
}

// Parses a line of a trace; `read` takes what it needs from it.
template <typename Read>
auto ReadLine(const std::string& line, const char* what, const Read& read) {
  try {
    return read(Json::parse(line));
  } catch (const Json::exception&) {
    throw Error(std::string("not ") + what);
  }
}

std::string Value(const Json& object, const std::string& key) {
  constexpr std::size_t kShown = 60;  // characters of a value
  if (!object.contains(key)) return "nothing";
  std::string text = object[key].dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  return text;
}

// "sigma is 1 in the trace and 2 now", of the first entry that differs; of a list, its element.
std::string FieldDifference(const std::string& key, const Json& traced, const Json& now) {
  const bool lists = traced.contains(key) && now.contains(key) && traced[key].is_array() &&
                     now[key].is_array() && traced[key].size() == now[key].size();
  if (lists) {
    for (std::size_t k = 0; k < now[key].size(); ++k) {
      if (traced[key][k] == now[key][k]) continue;
      return key + "[" + std::to_string(k) + "] is " + traced[key][k].dump() +
             " in the trace and " + now[key][k].dump() + " now";
    }
  }
  return key + " is " + Value(traced, key) + " in the trace and " + Value(now, key) + " now";
}

}  // namespace

std::string TraceHeader(const std::string& model, const std::vector<std::string>& options) {
  return JsonLine({{"trace", kFormat},
                   {"mjcf_pdg", MJCF_PDG_VERSION},
                   {"mujoco", mj_versionString()},
                   {"model", model},
                   {"options", options}});
}

std::string TraceRow(const Scene& scene, std::size_t index, const SolvedRow& solved) {
  Json input = {{"row", index}, {"label", solved.row.label}, {"qpos_in", solved.row.q}};
  if (!solved.row.mocap_pos.empty()) {
    input["mocap_pos"] = solved.row.mocap_pos;
    input["mocap_quat"] = solved.row.mocap_quat;
  }
  std::string lines = JsonLine(input);
  for (const KeptIteration& it : solved.iterations) {
    lines += JsonLine(IterationJson(scene, index, it));
  }
  const Result& result = solved.result;
  lines += JsonLine({{"row", index},
                     {"status", StatusName(result.status)},
                     {"start", result.start},
                     {"sigma", result.sigma},
                     {"sigma_lower_bound", result.sigma_lower_bound},
                     {"collision_queries", result.stats.collision_queries},
                     {"qpos", result.q}});
  return lines;
}

TraceStart ReadTraceHeader(const std::string& line) {
  return ReadLine(line, "a trace of mjcf-pdg solve --trace", [](const Json& json) {
    if (json.at("trace").get<int>() != kFormat) throw Error("a trace of another format");
    return TraceStart{json.at("mjcf_pdg"), json.at("mujoco"), json.at("model"), json.at("options")};
  });
}

TraceInput ReadTraceInput(const std::string& line) {
  return ReadLine(line, "the first line of a row", [](const Json& json) {
    TraceInput input{json.at("row"), {}};
    input.row.label = json.at("label");
    input.row.q = json.at("qpos_in").get<std::vector<double>>();
    if (json.contains("mocap_pos")) {
      input.row.mocap_pos = json.at("mocap_pos").get<std::vector<double>>();
      input.row.mocap_quat = json.at("mocap_quat").get<std::vector<double>>();
    }
    return input;
  });
}

bool EndsTraceRow(const std::string& line) {
  const Json json = Json::parse(line, nullptr, false);
  return json.is_object() && json.contains("status");
}

std::string TraceDifference(const std::string& traced, const std::string& now) {
  const Json before = Json::parse(traced, nullptr, false), after = Json::parse(now);
  if (!before.is_object()) return "the line is no JSON object";
  std::string where;
  for (const char* key : {"row", "descent", "step", "start"}) {
    if (before.contains(key)) {
      where += (where.empty() ? "" : ", ") + std::string(key) + " " + Value(before, key);
    }
  }
  for (const auto& [key, value] : after.items()) {
    if (!before.contains(key) || before[key] != value) {
      return where + ": " + FieldDifference(key, before, after);
    }
  }
  return where + ": the lines are written differently";
}

}  // namespace mjcf_pdg::app
