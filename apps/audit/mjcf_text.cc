#include "apps/audit/mjcf_text.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "apps/input/text_file.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBlanks = " \t\r\n";

bool IsBlank(char c) { return kBlanks.find(c) != std::string_view::npos; }

// Behind the '>' that closes the tag which begins at `begin`; one in quotes closes nothing.
std::size_t EndOfTag(const std::string& text, std::size_t begin) {
  char quote = '\0';
  for (std::size_t i = begin; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != '\0') {
      if (c == quote) quote = '\0';
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return i + 1;
    }
  }
  return text.size();
}

// Between the tags of the root element.
TextSpan ChildrenOfRoot(const std::string& text) {
  const std::string code = WithoutComments(text);
  std::size_t root = code.find('<');
  while (root < code.size() && code.find_first_of("?!", root) == root + 1) {
    root = code.find('<', EndOfTag(code, root));
  }
  if (root == std::string::npos) return {};
  const std::size_t begin = EndOfTag(code, root), end = code.rfind("</");
  if (code[begin - 2] == '/' || end == std::string::npos || end < begin) return {};
  return {begin, end - begin};
}

class Includes {
 public:
  Includes(std::string name, fs::path folder) : name_(std::move(name)), top_(std::move(folder)) {}

  // `folder` is that of the file which the text is from.
  std::string Expand(std::string text, const fs::path& folder, int depth) const {
    std::vector<TextSpan> tags = FindTags(text, "include");
    std::reverse(tags.begin(), tags.end());  // places before a change stay what they are
    for (const TextSpan& tag : tags) {
      const std::string written = tag.Of(text);
      const std::optional<TextSpan> file = FindAttribute(written, "file");
      if (!file || depth == kDeepest) continue;
      const fs::path path = Find(file->Of(written), folder);
      const std::string included = ReadTextFile(path);
      const std::string children =
          Expand(ChildrenOfRoot(included).Of(included), path.parent_path(), depth + 1);
      if (FindTags(children, name_).empty()) continue;
      text.replace(tag.begin, End(text, tag) - tag.begin, children);
    }
    return text;
  }

 private:
  static constexpr int kDeepest = 100;  // includes in each other, as MuJoCo would refuse them

  // MuJoCo looks beside the model first, then beside the file that includes.
  fs::path Find(const std::string& file, const fs::path& folder) const {
    std::error_code ec;
    return fs::exists(top_ / file, ec) ? top_ / file : folder / file;
  }

  // <include ...></include> is one element.
  static std::size_t End(const std::string& text, const TextSpan& tag) {
    constexpr std::string_view kClosing = "</include";
    if (text[tag.end() - 2] == '/') return tag.end();
    const std::size_t closing = text.find_first_not_of(kBlanks, tag.end());
    if (closing == std::string::npos || text.compare(closing, kClosing.size(), kClosing) != 0) {
      return tag.end();
    }
    return EndOfTag(text, closing);
  }

  const std::string name_;
  const fs::path top_;
};

}  // namespace

std::string WithoutComments(std::string text) {
  for (std::size_t begin = text.find("<!--"); begin != std::string::npos;
       begin = text.find("<!--", begin)) {
    const std::size_t end = std::min(text.find("-->", begin), text.size() - 3) + 3;
    for (; begin < end; ++begin) text[begin] = text[begin] == '\n' ? '\n' : ' ';
  }
  return text;
}

std::vector<TextSpan> FindTags(const std::string& text, const std::string& name) {
  const std::string code = WithoutComments(text), opening = "<" + name;
  std::vector<TextSpan> tags;
  for (std::size_t begin = code.find(opening); begin != std::string::npos;
       begin = code.find(opening, begin + 1)) {
    const std::size_t next = begin + opening.size();
    const bool whole_name =
        next < code.size() && (IsBlank(code[next]) || code[next] == '/' || code[next] == '>');
    if (whole_name) tags.push_back({begin, EndOfTag(code, begin) - begin});
  }
  return tags;
}

std::optional<TextSpan> FindAttribute(const std::string& tag, const std::string& name) {
  std::size_t i = tag.find_first_of(kBlanks);
  while ((i = tag.find_first_not_of(kBlanks, i)) < tag.size()) {
    const std::size_t quote = tag.find_first_of("\"'", i);
    if (quote == std::string::npos) break;
    const std::size_t close = tag.find(tag[quote], quote + 1);
    if (close == std::string::npos) break;
    const std::size_t name_end = std::min(tag.find_first_of(" \t\r\n=", i), quote);
    if (tag.compare(i, name_end - i, name) == 0) return TextSpan{quote + 1, close - quote - 1};
    i = close + 1;
  }
  return std::nullopt;
}

std::string Escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return out;
}

std::string WithIncludesOf(std::string text, const std::string& name, const fs::path& folder) {
  return Includes(name, folder).Expand(std::move(text), folder, 0);
}

}  // namespace mjcf_pdg::app
