#include "apps/options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include "apps/console/text.h"
#include "base/option_words.h"

namespace mjcf_pdg::app {
namespace {

std::string Describe(const NumberRange& range) {
  std::string text = (range.above_low ? "more than " : "at least ") + Short(range.low);
  const bool bounded = range.high < std::numeric_limits<double>::max();
  return bounded ? text + " and at most " + Short(range.high) : text;
}

[[noreturn]] void RefuseValue(const NumberFlag& flag, const std::string& text, bool whole) {
  throw Error(std::string(flag.flag) + ": '" + text + "' is not a " + (whole ? "whole " : "") +
              "number that is " + Describe(flag.range));
}

template <typename T>
void ParseInto(const NumberFlag& flag, const std::string& text, T& target) {
  T value{};
  const char* const last = text.data() + text.size();
  const auto [end, ec] = std::from_chars(text.data(), last, value);
  if (ec != std::errc() || end != last) RefuseValue(flag, text, std::is_integral_v<T>);
  const double number = static_cast<double>(value);
  const NumberRange& range = flag.range;
  const bool high_enough = range.above_low ? number > range.low : number >= range.low;
  if (!high_enough || !(number <= range.high)) RefuseValue(flag, text, std::is_integral_v<T>);
  target = value;
}

template <typename T>
CLI::Option* AddParsed(CLI::App& command, const NumberFlag& flag, T& target) {
  auto parse = [flag, &target](const std::string& text) { ParseInto(flag, text, target); };
  CLI::Option* option = command.add_option_function<std::string>(flag.flag, parse, flag.help);
  option->type_name(flag.unit);
  const double shown = static_cast<double>(target);
  if (std::isfinite(shown)) option->default_str(Short(shown));
  return option;
}

template <typename T>
void AddChoice(CLI::App& command, const char* flag, const Choices<T>& choices, const char* help,
               T& target) {
  auto choose = [flag, choices, &target](const std::string& text) {
    target = Chosen(flag, text, choices);
  };
  CLI::Option* option = command.add_option_function<std::string>(flag, choose, help);
  option->type_name(WordsOf(choices));
  for (const auto& [word, value] : choices) {
    if (value == target) option->default_str(word);
  }
}

}  // namespace

CLI::Option* AddNumber(CLI::App& command, const NumberFlag& flag, double& target) {
  return AddParsed(command, flag, target);
}

CLI::Option* AddInteger(CLI::App& command, const NumberFlag& flag, unsigned long long& target) {
  return AddParsed(command, flag, target);
}

CLI::Option* AddPath(CLI::App& command, const std::string& flag, const std::string& help,
                     std::string& target) {
  auto set = [flag, &target](const std::string& path) {
    if (path.empty()) throw Error(flag + ": empty file name");
    target = path;
  };
  return command.add_option_function<std::string>(flag, set, help)->type_name("FILE");
}

void AddAnimation(CLI::App& command, const std::string& help, std::string& target) {
  auto set = [&target](const std::string& path) {
    if (!path.ends_with(".gif")) throw Error("--animation: " + path + ": must end in .gif");
    target = path;
  };
  command.add_option_function<std::string>("--animation", set, help)->type_name("FILE.gif");
}

Scene LoadScene(const SceneArguments& arguments) {
  Scene scene = Scene::FromFile(arguments.model, arguments.options);
  for (const std::string& warning : scene.Warnings()) WriteWarning(warning);
  return scene;
}

void AddModel(CLI::App& command, SceneArguments& arguments) {
  AddPath(command, "MODEL", "MJCF (.xml), URDF or compiled model (.mjb)", arguments.model)
      ->required();
}

void AddModels(CLI::App& command, std::vector<std::string>& models) {
  auto set = [&models](const std::vector<std::string>& paths) {
    for (const std::string& path : paths) {
      if (path.empty()) throw Error("MODEL: empty file name");
    }
    models = paths;
  };
  command
      .add_option_function<std::vector<std::string>>(
          "MODEL", set, "MJCF (.xml), URDF or compiled model (.mjb); one or several")
      ->type_name("FILE")
      ->required();
}

namespace {

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find(separator, begin)) != std::string::npos; begin = end + 1) {
    parts.push_back(text.substr(begin, end - begin));
  }
  parts.push_back(text.substr(begin));
  return parts;
}

// A list BODY,... appended to `target`; the flag may be repeated.
void AddBodies(CLI::App& command, const std::string& flag, const std::string& help,
               std::vector<std::string>& target) {
  auto split = [flag, &target](const std::vector<std::string>& lists) {
    for (const std::string& list : lists) {
      for (const std::string& name : Split(list, ',')) {
        if (name.empty()) throw Error(flag + ": empty body name in '" + list + "'");
        target.push_back(name);
      }
    }
  };
  command.add_option_function<std::vector<std::string>>(flag, split, help)
      ->type_name("BODY,...")
      ->allow_extra_args(false);
}

NamePair ParseNamePair(const std::string& flag, const std::string& text) {
  const std::vector<std::string> names = Split(text, ',');
  if (names.size() != 2 || names[0].empty() || names[1].empty()) {
    throw Error(flag + ": '" + text + "' is not two names of geoms or bodies, A,B");
  }
  return {names[0], names[1]};
}

}  // namespace

void AddMovable(CLI::App& command, SceneArguments& arguments) {
  AddBodies(command, "--movable",
            "these bodies' own joints and subtrees may move, all else is frozen (default: all)",
            arguments.options.movable);
  AddBodies(command, "--fixed", "these bodies' own joints stay, whatever --movable says",
            arguments.options.fixed);
}

void AddPairs(CLI::App& command, SceneArguments& arguments) {
  auto exclude = [&arguments](const std::vector<std::string>& pairs) {
    for (const std::string& text : pairs) {
      arguments.options.exclude.push_back(ParseNamePair("--exclude", text));
    }
  };
  command
      .add_option_function<std::vector<std::string>>(
          "--exclude", exclude, "overlaps of these two geoms or bodies do not count; repeatable")
      ->type_name("A,B")
      ->allow_extra_args(false);
  auto allow = [&arguments](const std::vector<std::string>& pairs) {
    for (const std::string& text : pairs) {
      const std::size_t equals = text.rfind('=');
      if (equals == std::string::npos) throw Error("--allow: '" + text + "' is not A,B=DEPTH");
      const std::vector<double> depth =
          ParseNumbers(std::string_view(text).substr(equals + 1), "--allow");
      if (depth.size() != 1) throw Error("--allow: '" + text + "' is not A,B=DEPTH");
      arguments.options.allow.push_back(
          {ParseNamePair("--allow", text.substr(0, equals)), depth[0]});
    }
  };
  command
      .add_option_function<std::vector<std::string>>(
          "--allow", allow, "these two geoms or bodies may overlap so deep [m]; repeatable")
      ->type_name("A,B=DEPTH")
      ->allow_extra_args(false);
  command.add_flag("--ignore-permanent", arguments.options.ignore_permanent,
                   "set aside pairs that overlap wherever the joints go");
}

// A flag with a number, or the word "model".
void AddNumberOrModel(CLI::App& command, const NumberFlag& flag, double& number, bool& model) {
  auto parse = [flag, &number, &model](const std::string& text) {
    model = text == "model";
    if (!model) ParseInto(flag, text, number);
  };
  command.add_option_function<std::string>(flag.flag, parse, flag.help)
      ->type_name(flag.unit)
      ->default_str("0");
}

void AddRoot(CLI::App& command, SceneArguments& arguments) {
  auto set = [&arguments](const std::string& name) {
    if (name.empty()) throw Error("--root: empty body name");
    arguments.options.root = name;
  };
  command
      .add_option_function<std::string>("--root", set,
                                        "root link of the norm (default: each tree's top body)")
      ->type_name("BODY");
}

void AddExactMesh(CLI::App& command, SceneArguments& arguments) {
  command.add_flag("--exact-mesh", arguments.options.exact_mesh,
                   "meshes collide as their triangles: those the model marks, or all");
}

void AddModelRules(CLI::App& command, SceneArguments& arguments) {
  AddChoice(command, "--equality", kEqualityModes,
            "active equality constraints: hold all but those to mocap bodies, all, "
            "or none",
            arguments.options.equality);
  AddChoice(command, "--tendon-limits", kTendonLimits,
            "length limits of tendons are no part of what is free, or held",
            arguments.options.hold_tendon_limits);
  AddChoice(command, "--flags", kFlags,
            "contacts and limits that the model disables by <flag> count all the same, or "
            "as the model says",
            arguments.options.model_flags);
  AddChoice(command, "--flex", kFlexes, "a model with flexes is refused, or solved without them",
            arguments.options.ignore_flexes);
}

void AddClearance(CLI::App& command, SceneArguments& arguments, Options& options) {
  AddNumberOrModel(command,
                   {"--clearance",
                    "M|model",
                    "distance to keep between all pairs [m]; model: each pair's margin, within "
                    "which MuJoCo pushes",
                    {}},
                   options.clearance, arguments.options.keep_margins);
}

void AddArmature(CLI::App& command, SceneArguments& arguments) {
  AddNumberOrModel(command,
                   {"--armature",
                    "KGM2|model",
                    "inertia added to every hinge and ball (and mass to every slide) in the norm, "
                    "so that light links cost something; model: each joint's own",
                    {.high = 1e3}},
                   arguments.options.armature, arguments.options.model_armature);
}

void AddMetric(CLI::App& command, Metric& metric) {
  AddChoice(command, "--metric", kMetrics,
            "the paper's norm, or the true mean squared displacement", metric);
}

void AddMethod(CLI::App& command, Method& method) {
  AddChoice(command, "--method", kMethods,
            "a search over many starts, or the paper's sequence of steps", method);
}

void AddEffort(CLI::App& command, Effort& effort) {
  AddChoice(command, "--effort", kEfforts, "how many starts are tried", effort);
}

void AddTolerance(CLI::App& command, Options& options) {
  AddNumber(command, {"--tolerance", "M", "overlap that still counts as free", {.above_low = true}},
            options.tolerance);
}

void AddRest(CLI::App& command, Options& options) {
  AddNumber(command,
            {"--rest", "DEPTH", "contacts no deeper than this may keep their depth [m]", {}},
            options.rest);
}

void AddJson(CLI::App& command, std::string& path) {
  AddPath(command, "--json", "write JSON Lines here; - is stdout, which then carries it alone",
          path)
      ->type_name("FILE|-");
}

void AddHtml(CLI::App& command, std::string& path) {
  AddPath(command, "--html",
          "write a report that opens in any browser: the scene in 3-D and what was found", path);
}

namespace {

// Options that do not decide what comes out.
constexpr std::array kElsewhere = {
    "MODEL",    "SUITE",      "--key",           "--qpos",  "--qpos-file", "--motion",
    "--from",   "--to",       "--start",         "--goal",  "--threads",   "--json",
    "--resume", "--out-qpos", "--out-mjcf",      "--png",   "--animation", "--script",
    "--html",   "--trace",    "--fix",           "--junit", "--update",    "--discover",
    "--help",   "--version",  "--out-trajectory"};

bool Elsewhere(const CLI::Option& option) {
  return std::any_of(kElsewhere.begin(), kElsewhere.end(), [&](const std::string& name) {
    return option.get_name() == name || option.check_lname(name.substr(2));
  });
}

bool IsOneOf(const std::string& name, const std::vector<std::string>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// `wanted` says of which names.
std::vector<std::string> GivenIf(const CLI::App& command,
                                 const std::function<bool(const std::string&)>& wanted) {
  std::vector<std::string> given;
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || Elsewhere(*option) || !wanted(name)) continue;
    const bool flag = option->get_items_expected_max() == 0;
    for (const std::string& value : option->results()) {
      given.push_back(name);
      if (!flag) given.push_back(value);
    }
  }
  return given;
}

}  // namespace

std::vector<std::string> GivenOptions(const CLI::App& command,
                                      const std::vector<std::string>& without) {
  return GivenIf(command, [&](const std::string& name) { return !IsOneOf(name, without); });
}

bool IsNormOption(const std::string& name) {
  return IsOneOf(name,
                 {"--plugin-dir", "--root", "--armature", "--metric", "--movable", "--fixed"});
}

std::vector<std::string> GivenNormOptions(const CLI::App& command) {
  return GivenIf(command, IsNormOption);
}

std::vector<std::pair<std::string, std::string>> OptionsInForce(const CLI::App& command) {
  std::vector<std::pair<std::string, std::string>> options;
  for (const CLI::Option* option : command.get_options()) {
    if (Elsewhere(*option)) continue;
    std::string value = option->count() == 0 ? option->get_default_str() : "";
    for (const std::string& given : option->results()) value += (value.empty() ? "" : ", ") + given;
    if (!value.empty()) options.emplace_back(option->get_name(), value);
  }
  return options;
}

}  // namespace mjcf_pdg::app
