// MJCF as text: where tags stand in it, so that some can be replaced and all else stays as it was
// written, comments and blanks included.
#ifndef MJCF_PDG_APPS_AUDIT_MJCF_TEXT_H_
#define MJCF_PDG_APPS_AUDIT_MJCF_TEXT_H_

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mjcf_pdg::app {

// A piece of a text.
struct TextSpan {
  std::size_t begin = 0, length = 0;

  std::size_t end() const { return begin + length; }
  std::string Of(const std::string& text) const { return text.substr(begin, length); }
};

// The same length, with blanks for comments, so that places in it are places in the text.
std::string WithoutComments(std::string text);

// The opening tags <name ...> and <name .../> outside comments.
std::vector<TextSpan> FindTags(const std::string& text, const std::string& name);

// The value of a tag's attribute, in the tag; as it is written, with its entities.
std::optional<TextSpan> FindAttribute(const std::string& tag, const std::string& name);

// The characters that attributes cannot have, as entities.
std::string Escaped(const std::string& text);

// The text with those of its <include>s, and of theirs, in which a tag `name` stands replaced by
// what MuJoCo reads in their place: the children of the included file's root. `folder` is that of
// the model, which the names of included files are relative to. Throws
// Error if one cannot be read.
std::string WithIncludesOf(std::string text, const std::string& name,
                           const std::filesystem::path& folder);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_AUDIT_MJCF_TEXT_H_
