#include "apps/plan/trajectory.h"

#include <cmath>
#include <sstream>
#include <string_view>

#include "apps/console/text.h"
#include "apps/input/npy.h"
#include "apps/input/qpos_file.h"
#include "apps/options.h"
#include "apps/output/report.h"
#include "base/names.h"
#include "model/scene_tables.h"

namespace mjcf_pdg::app {
namespace {

bool IsJsonLines(const std::string& path) { return path.ends_with(".jsonl"); }

// V, or SLIDE/TURN.
JointRate ReadRate(const std::string& flag, const std::string& text) {
  const auto read = [&](std::string_view number) {
    const std::vector<double> values = ParseNumbers(number, flag);
    if (values.size() != 1 || values[0] <= 0.0) {
      throw Error(flag + ": '" + text + "' is not a positive number, or two with a / between");
    }
    return values[0];
  };
  const std::string_view all = text;
  const std::size_t slash = all.find('/');
  const double first = read(all.substr(0, slash));
  return {first, slash == std::string_view::npos ? first : read(all.substr(slash + 1))};
}

int JointOf(const mjModel& m, const std::string& flag, const std::string& name) {
  const int joint = mj_name2id(&m, mjOBJ_JOINT, name.c_str());
  if (joint >= 0) return joint;
  std::string names;
  for (int j = 0; j < m.njnt; ++j) {
    names += (j > 0 ? ", " : "") + NameOrId(m, mjOBJ_JOINT, j);
  }
  throw Error(flag + ": no joint '" + name + "' (joints: " + names + ")");
}

// Joints that are named have the rate that is given for them, all others the one without a name.
std::vector<JointRate> ReadRates(const mjModel& m, const std::string& flag,
                                 const std::string& text) {
  std::vector<JointRate> rates(static_cast<std::size_t>(m.njnt));
  std::vector<std::pair<int, JointRate>> named;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t equals = part.rfind('=');
    if (equals == std::string::npos) {
      rates.assign(rates.size(), ReadRate(flag, part));
    } else {
      const int joint = JointOf(m, flag, part.substr(0, equals));
      named.emplace_back(joint, ReadRate(flag, part.substr(equals + 1)));
    }
  }
  for (const auto& [joint, rate] : named) rates[static_cast<std::size_t>(joint)] = rate;
  return rates;
}

void CheckEverySpeed(const SceneTables& tables, const std::vector<JointRate>& speeds) {
  for (const JointEntry& joint : tables.joints) {
    if (std::isfinite(speeds[static_cast<std::size_t>(joint.id)].slide)) continue;
    throw Error("--speeds: no speed for joint " +
                QuotedNameOrId(*tables.model, mjOBJ_JOINT, joint.id) +
                "; a number without a name is for all that are not named");
  }
}

}  // namespace

void AddTrajectory(CLI::App& command, TrajectoryArguments& arguments) {
  const auto add = [&command](const std::string& flag, const std::string& help,
                              std::string& target) {
    const auto set = [flag, &target](const std::string& text) {
      if (text.empty()) throw Error(flag + ": is empty");
      target = text;
    };
    command.add_option_function<std::string>(flag, set, help)->type_name("[JOINT=]V[/R],...");
  };
  add("--speeds",
      "largest speeds of joints: the path gets times; V m/s of what slides, R (else V) rad/s of "
      "what turns; without JOINT= for all that are not named",
      arguments.speeds);
  add("--accelerations", "the same of accelerations; without it, speeds jump at corners",
      arguments.accelerations);
  AddNumber(command,
            {"--time-step",
             "S",
             "between rows of the trajectory; default: the model's time step",
             {.above_low = true, .high = 1e3}},
            arguments.step);
  AddPath(command, "--out-trajectory",
          "write time, qpos and qvel along the path, a time step a row: .npy, .csv, .txt, .jsonl",
          arguments.file);
}

void AddTrajectoryFile(const TrajectoryArguments& arguments, const std::vector<std::string>& inputs,
                       OutputFiles& outputs) {
  CheckQposFileName("--out-trajectory", arguments.file);
  outputs.Add("--out-trajectory", arguments.file, inputs);
}

std::optional<TimingLimits> ReadTimingLimits(const Scene& scene,
                                             const TrajectoryArguments& arguments) {
  const mjModel& m = *scene.model();
  if (arguments.speeds.empty()) {
    for (const auto& [flag, given] :
         {std::pair{"--accelerations", !arguments.accelerations.empty()},
          {"--time-step", std::isfinite(arguments.step)},
          {"--out-trajectory", !arguments.file.empty()}}) {
      if (given) throw Error(std::string(flag) + " needs --speeds");
    }
    return std::nullopt;
  }
  TimingLimits limits;
  limits.speed = ReadRates(m, "--speeds", arguments.speeds);
  limits.acceleration = ReadRates(m, "--accelerations", arguments.accelerations);
  limits.step = std::isfinite(arguments.step) ? arguments.step : m.opt.timestep;
  CheckEverySpeed(scene.tables(), limits.speed);
  return limits;
}

std::string TrajectoryContent(const TimedPath& timed, const std::string& path) {
  std::string content;
  for (const TimedPath::Sample& sample : timed.samples) {
    if (IsJsonLines(path)) {
      content += JsonLine({{"time", sample.time}, {"qpos", sample.q}, {"qvel", sample.v}});
      continue;
    }
    std::vector<double> row = {sample.time};
    row.insert(row.end(), sample.q.begin(), sample.q.end());
    row.insert(row.end(), sample.v.begin(), sample.v.end());
    if (content.empty() && IsNpyFile(path)) content = NpyHeader(timed.samples.size(), row.size());
    content += FormatQposRow(row, path);
  }
  return content;
}

}  // namespace mjcf_pdg::app
