#include "options.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "arrays.h"
#include "base/option_words.h"

namespace mjcf_pdg::python {
namespace {

constexpr double kReportedDistances = 1.0;  // as on the command line [m]

[[noreturn]] void RefuseType(const std::string& name, const char* wanted, nb::handle value) {
  const std::string words = name + " must be " + wanted + ", not " + nb::repr(value).c_str();
  throw nb::type_error(words.c_str());
}

void Read(const std::string& name, nb::handle value, bool& target) {
  if (!PyBool_Check(value.ptr())) RefuseType(name, "True or False", value);
  target = value.ptr() == Py_True;
}

void Read(const std::string& name, nb::handle value, double& target) {
  target = PyFloat_AsDouble(value.ptr());
  if (!PyErr_Occurred()) return;
  PyErr_Clear();
  RefuseType(name, "a number", value);
}

void Read(const std::string& name, nb::handle value, std::uint64_t& target) {
  const nb::object whole = nb::steal(PyNumber_Index(value.ptr()));
  if (whole.is_valid()) {
    target = PyLong_AsUnsignedLongLong(whole.ptr());
    if (!PyErr_Occurred()) return;
    PyErr_Clear();
    throw Error(name + ": " + nb::repr(value).c_str() + " is not within 0 and 2^64 - 1");
  }
  PyErr_Clear();
  RefuseType(name, "a whole number", value);
}

std::string ReadText(const std::string& name, nb::handle value, const char* wanted) {
  if (!PyUnicode_Check(value.ptr())) RefuseType(name, wanted, value);
  return nb::cast<std::string>(value);
}

void Read(const std::string& name, nb::handle value, std::string& target) {
  target = ReadText(name, value, "a text");
  if (target.empty()) throw Error(name + ": empty body name");
}

// Names in a sequence, or in a text with commas as on the command line.
void Read(const std::string& name, nb::handle value, std::vector<std::string>& target) {
  constexpr const char* kWanted = "a text or a sequence of texts";
  target.clear();
  nb::object names = nb::borrow(value);
  if (PyUnicode_Check(value.ptr())) names = value.attr("split")(",");
  if (!PySequence_Check(names.ptr())) RefuseType(name, kWanted, value);
  for (const nb::handle one : names) {
    target.push_back(ReadText(name, one, kWanted));
    if (target.back().empty()) throw Error(name + ": empty name");
  }
}

NamePair ReadPair(const std::string& name, nb::handle value) {
  std::vector<std::string> names;
  Read(name, value, names);
  if (names.size() != 2) throw Error(name + ": " + nb::repr(value).c_str() + " is not two names");
  return {names[0], names[1]};
}

// Pairs in a sequence: "A,B" or ("A", "B").
void Read(const std::string& name, nb::handle value, std::vector<NamePair>& target) {
  constexpr const char* kWanted = "a sequence of pairs of names";
  if (PyUnicode_Check(value.ptr()) || !PySequence_Check(value.ptr())) {
    RefuseType(name, kWanted, value);
  }
  target.clear();
  for (const nb::handle one : nb::borrow(value)) target.push_back(ReadPair(name, one));
}

// Depths [m] by pairs: {("A", "B"): 0.002}.
void Read(const std::string& name, nb::handle value, std::vector<AllowedOverlap>& target) {
  if (!PyDict_Check(value.ptr())) RefuseType(name, "a dictionary of depths by pairs", value);
  target.clear();
  for (const auto& [pair, depth] : nb::borrow<nb::dict>(value)) {
    AllowedOverlap overlap{ReadPair(name, pair), 0.0};
    Read(name, depth, overlap.depth);
    target.push_back(overlap);
  }
}

// Poses of the mocap bodies: (nmocap, 3 or 4), or all values in a row.
void Read(const std::string& name, nb::handle value, std::vector<double>& target) {
  ReadArray(value, name.c_str(), target);
}

template <typename T>
void Choose(const std::string& name, nb::handle value, const Choices<T>& choices, T& target) {
  target = Chosen(name, ReadText(name, value, "a text"), choices);
}

void Read(const std::string& name, nb::handle value, Metric& target) {
  Choose(name, value, kMetrics, target);
}

void Read(const std::string& name, nb::handle value, Method& target) {
  Choose(name, value, kMethods, target);
}

void Read(const std::string& name, nb::handle value, Effort& target) {
  Choose(name, value, kEfforts, target);
}

void Read(const std::string& name, nb::handle value, EqualityMode& target) {
  Choose(name, value, kEqualityModes, target);
}

// A number, or the text "model": what the model says.
void ReadNumberOrModel(const std::string& name, nb::handle value, double& number, bool& model) {
  model = nb::isinstance<nb::str>(value);
  if (model) {
    Choose<bool>(name, value, {{"model", true}}, model);
  } else {
    Read(name, value, number);
  }
}

void ReadMilliseconds(const std::string& name, nb::handle value, double& seconds) {
  Read(name, value, seconds);
  seconds /= 1e3;
}

struct Row {
  const char* name;
  unsigned users;
  void (*read)(const std::string& name, nb::handle value, Asked& asked);
};

#define MJCF_PDG_ROW(name, users, member) \
  {#name, users, [](const std::string& n, nb::handle v, Asked& a) { Read(n, v, a.member); }}

const Row kTable[] = {
    MJCF_PDG_ROW(movable, kNorm | kVerify | kSolve, scene.movable),
    MJCF_PDG_ROW(fixed, kNorm | kVerify | kSolve, scene.fixed),
    MJCF_PDG_ROW(exclude, kVerify | kSolve, scene.exclude),
    MJCF_PDG_ROW(allow, kVerify | kSolve, scene.allow),
    MJCF_PDG_ROW(ignore_permanent, kVerify | kSolve, scene.ignore_permanent),
    MJCF_PDG_ROW(equality, kVerify | kSolve, scene.equality),
    {"tendon_limits", kVerify | kSolve,
     [](const std::string& n, nb::handle v, Asked& a) {
       Choose(n, v, kTendonLimits, a.scene.hold_tendon_limits);
     }},
    {"flags", kVerify | kSolve,
     [](const std::string& n, nb::handle v, Asked& a) {
       Choose(n, v, kFlags, a.scene.model_flags);
     }},
    {"flex", kNorm | kVerify | kSolve,
     [](const std::string& n, nb::handle v, Asked& a) {
       Choose(n, v, kFlexes, a.scene.ignore_flexes);
     }},
    MJCF_PDG_ROW(root, kNorm | kSolve, scene.root),
    {"armature", kNorm | kSolve,
     [](const std::string& n, nb::handle v, Asked& a) {
       ReadNumberOrModel(n, v, a.scene.armature, a.scene.model_armature);
     }},
    MJCF_PDG_ROW(metric, kNorm | kSolve, options.metric),
    MJCF_PDG_ROW(exact_mesh, kVerify | kSolve, scene.exact_mesh),
    MJCF_PDG_ROW(tolerance, kVerify | kSolve, options.tolerance),
    {"clearance", kVerify | kSolve,
     [](const std::string& n, nb::handle v, Asked& a) {
       ReadNumberOrModel(n, v, a.options.clearance, a.scene.keep_margins);
     }},
    MJCF_PDG_ROW(rest, kVerify | kSolve, options.rest),
    MJCF_PDG_ROW(mocap_pos, kVerify | kSolve, options.mocap_pos),
    MJCF_PDG_ROW(mocap_quat, kVerify | kSolve, options.mocap_quat),
    MJCF_PDG_ROW(method, kSolve, options.method),
    MJCF_PDG_ROW(effort, kSolve, options.effort),
    MJCF_PDG_ROW(seed, kSolve, options.seed),
    MJCF_PDG_ROW(trajectory, kSolve, options.trajectory),
    MJCF_PDG_ROW(without, kSolve, options.without),
    {"time_limit", kSolve,
     [](const std::string& n, nb::handle v, Asked& a) {
       ReadMilliseconds(n, v, a.options.time_limit);
     }},
    MJCF_PDG_ROW(report_contacts, kSolve, options.report_contacts),
    MJCF_PDG_ROW(report_lower_bound, kSolve, options.report_lower_bound),
    MJCF_PDG_ROW(report_distances_to, kSolve, options.report_distances_to),
    {"queries", kTrack,
     [](const std::string& n, nb::handle v, Asked& a) {
       std::uint64_t queries = 0;
       Read(n, v, queries);
       a.track.queries = static_cast<int>(std::min<std::uint64_t>(queries, 1 << 30));
     }},
    MJCF_PDG_ROW(switch_gain, kTrack, track.switch_gain),
    MJCF_PDG_ROW(max_step, kTrack, track.max_step),
    MJCF_PDG_ROW(certify_motion, kTrack, track.certify_motion),
    MJCF_PDG_ROW(lower_bound, kTrack, track.lower_bound),
    MJCF_PDG_ROW(smooth, kRows, smooth),
};

#undef MJCF_PDG_ROW

const Row& Find(const std::string& name, unsigned users) {
  std::string names;
  for (const Row& row : kTable) {
    if (!(row.users & users)) continue;
    if (name == row.name) return row;
    names += (names.empty() ? "" : ", ") + std::string(row.name);
  }
  throw Error("no option '" + name + "' (options: " + names + ")");
}

}  // namespace

Asked CommandLineDefaults() {
  Asked asked;
  asked.options.report_contacts = true;
  asked.options.report_distances_to = kReportedDistances;
  return asked;
}

void ReadOptions(const nb::kwargs& given, unsigned users, Asked& asked) {
  for (const auto& [key, value] : given) {
    const std::string name = nb::cast<std::string>(key);
    const Row& row = Find(name, users);
    if (!value.is_none()) row.read(name, value, asked);  // None: as if it were not there
  }
}

}  // namespace mjcf_pdg::python
