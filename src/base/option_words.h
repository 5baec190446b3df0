// The words among which some options choose. The command line, Python and the suites of `regress`
// each have flags, arguments or members of their own; the words are the same.
#ifndef MJCF_PDG_SRC_BASE_OPTION_WORDS_H_
#define MJCF_PDG_SRC_BASE_OPTION_WORDS_H_

#include <string>
#include <utility>
#include <vector>

#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

template <typename T>
using Choices = std::vector<std::pair<const char*, T>>;

inline const Choices<Metric> kMetrics = {{"sequential", Metric::kSequential},
                                         {"displacement", Metric::kDisplacement}};
inline const Choices<Method> kMethods = {{"auto", Method::kAuto}, {"paper", Method::kPaper}};
inline const Choices<Effort> kEfforts = {
    {"fast", Effort::kFast}, {"default", Effort::kDefault}, {"max", Effort::kMax}};
inline const Choices<EqualityMode> kEqualityModes = {
    {"hold", EqualityMode::kHold}, {"all", EqualityMode::kAll}, {"ignore", EqualityMode::kIgnore}};
// Of SceneOptions::hold_tendon_limits, model_flags and ignore_flexes.
inline const Choices<bool> kTendonLimits = {{"ignore", false}, {"hold", true}};
inline const Choices<bool> kFlags = {{"all", false}, {"model", true}};
inline const Choices<bool> kFlexes = {{"refuse", false}, {"ignore", true}};

// "fast|default|max".
template <typename T>
std::string WordsOf(const Choices<T>& choices) {
  std::string words;
  for (const auto& [word, value] : choices) words += (words.empty() ? "" : "|") + std::string(word);
  return words;
}

// What `text` chooses for the option `name`. Throws Error, which lists the words, if it is none.
template <typename T>
T Chosen(const std::string& name, const std::string& text, const Choices<T>& choices) {
  for (const auto& [word, value] : choices) {
    if (text == word) return value;
  }
  throw Error(name + ": '" + text + "' is none of " + WordsOf(choices));
}

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_OPTION_WORDS_H_
