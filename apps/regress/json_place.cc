#include "apps/regress/json_place.h"

#include <set>
#include <utility>

#include "apps/input/text_file.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

// The library's words without its own numbers: "[json.exception.parse_error.101] parse error at".
std::string Words(const nlohmann::json::exception& e) {
  const std::string words = e.what();
  const std::size_t end = words.find("] ");
  return end == std::string::npos ? words : words.substr(end + 2);
}

// Called by the parser for everything it meets; throws Error for a member that an object has
// already.
class TwiceWatch {
 public:
  explicit TwiceWatch(std::string path) : path_(std::move(path)) {}

  bool operator()(int, Json::parse_event_t event, const Json& value) {
    if (event == Json::parse_event_t::object_start) objects_.emplace_back();
    if (event == Json::parse_event_t::object_end) objects_.pop_back();
    if (event == Json::parse_event_t::key && !objects_.back().insert(value).second) {
      throw Error(path_ + ": has '" + value.get<std::string>() + "' twice in one object");
    }
    return true;
  }

 private:
  const std::string path_;
  std::vector<std::set<std::string>> objects_;  // the keys of those that are open
};

}  // namespace

Json ReadJsonFile(const std::string& path) {
  const std::string text = ReadTextFile(path);
  TwiceWatch watch(path);
  try {
    return Json::parse(text, std::ref(watch));
  } catch (const nlohmann::json::exception& e) {
    throw Error(path + ": " + Words(e));
  }
}

std::string JsonPlace::Text() const {
  if (!value.is_string() || value.get_ref<const std::string&>().empty()) Refuse("is no text");
  return value.get<std::string>();
}

double JsonPlace::Number(double low, double high) const {
  const bool in_range =
      value.is_number() && value.get<double>() >= low && value.get<double>() <= high;
  if (!in_range) Refuse("is no number in its range");
  return value.get<double>();
}

std::uint64_t JsonPlace::Whole(std::uint64_t low, std::uint64_t high) const {
  if (!value.is_number_unsigned()) Refuse("is no whole number");
  const auto number = value.get<std::uint64_t>();
  if (number < low || number > high) Refuse("is no whole number in its range");
  return number;
}

bool JsonPlace::Flag() const {
  if (!value.is_boolean()) Refuse("is neither true nor false");
  return value.get<bool>();
}

std::vector<JsonPlace> JsonPlace::List() const {
  if (!value.is_array() || value.empty()) Refuse("is no list, or an empty one");
  std::vector<JsonPlace> places;
  for (std::size_t k = 0; k < value.size(); ++k) {
    places.push_back({value[k], name + "[" + std::to_string(k) + "]"});
  }
  return places;
}

void JsonPlace::Members(const Readers& readers) const {
  if (!value.is_object()) Refuse("is no object {...}");
  for (const auto& [key, member] : value.items()) {
    const auto reader = readers.find(key);
    if (reader == readers.end()) {
      std::string known;
      for (const auto& [other, unused] : readers) known += (known.empty() ? "" : ", ") + other;
      Refuse("has no '" + key + "' (there are: " + known + ")");
    }
    reader->second({member, name + "." + key});
  }
}

}  // namespace mjcf_pdg::app
