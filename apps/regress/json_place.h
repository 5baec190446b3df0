// JSON files of ours that people edit, read member by member: what is wrong is told with its place.
#ifndef MJCF_PDG_APPS_REGRESS_JSON_PLACE_H_
#define MJCF_PDG_APPS_REGRESS_JSON_PLACE_H_

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/option_words.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {

// The value of a file. Throws Error, one line that begins with the path, if it cannot be read, is
// no JSON, or says a member of an object twice (of which JSON libraries keep one in silence).
nlohmann::ordered_json ReadJsonFile(const std::string& path);

// A value, and where it stands for messages: "suite.json.cases[2].model". All throw Error.
struct JsonPlace {
  const nlohmann::ordered_json& value;
  std::string name;

  [[noreturn]] void Refuse(const std::string& why) const { throw Error(name + ": " + why); }

  std::string Text() const;  // not empty
  double Number(double low, double high) const;
  std::uint64_t Whole(std::uint64_t low, std::uint64_t high) const;
  bool Flag() const;
  std::vector<JsonPlace> List() const;  // not empty

  // Hands each member to its reader; refuses those that have none.
  using Readers = std::map<std::string, std::function<void(const JsonPlace&)>>;
  void Members(const Readers& readers) const;

  template <typename T>
  T Choice(const Choices<T>& choices) const {
    return Chosen(name, Text(), choices);
  }
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_REGRESS_JSON_PLACE_H_
