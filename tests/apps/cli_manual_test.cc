// The manual pages that the build writes.
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "tests/support/cli_test.h"

namespace mjcf_pdg::test {
namespace {

// The text of a page, with the hyphens and backslashes that man(7) escapes.
std::string ReadPage(const std::string& name) {
  std::ifstream file(std::string(MJCF_PDG_MANUAL_DIR) + "/" + name + ".1");
  std::stringstream text;
  text << file.rdbuf();
  std::string page = std::regex_replace(text.str(), std::regex(R"(\\-)"), "-");
  return std::regex_replace(page, std::regex(R"(\\e)"), "\\");
}

// The flags that begin a line of a --help, without those that it mentions.
std::set<std::string> Flags(const std::string& help) {
  std::set<std::string> flags;
  const std::regex flag(R"(\n  (?:-\w,)?(--?[a-z][a-z-]*))");
  for (std::sregex_iterator match(help.begin(), help.end(), flag), end; match != end; ++match) {
    flags.insert((*match)[1]);
  }
  return flags;
}

TEST_F(CliTest, EveryFlagOfHelpIsInTheManual) {
  const std::string verbs = Run({"--help"}).out;
  const std::regex verb(R"(\n  ([a-z]+)  )");
  std::size_t pages = 0, flags = 0;
  for (std::sregex_iterator match(verbs.begin(), verbs.end(), verb), end; match != end; ++match) {
    const std::string name = (*match)[1];
    const std::string page = ReadPage("mjcf-pdg-" + name);
    ++pages;
    for (const std::string& flag : Flags(Run({name, "--help"}).out)) {
      EXPECT_NE(page.find("\\fB" + flag + "\\fR"), std::string::npos) << name << " " << flag;
      ++flags;
    }
    EXPECT_NE(ReadPage("mjcf-pdg").find("\\fB" + name + "\\fR\n"), std::string::npos) << name;
  }
  EXPECT_GE(pages, 6u);
  EXPECT_GE(flags, 60u);
}

TEST_F(CliTest, AManualPageSaysUnitDefaultAndWhatDoesNotGoTogether) {
  const std::string page = ReadPage("mjcf-pdg-solve");
  for (const char* words :
       {".TH MJCF-PDG-SOLVE 1 ",
        "\\fBmjcf-pdg\\fR \\fBsolve\\fR [\\fIOPTIONS\\fR] \\fIMODEL\\fR ...\n",
        ".TP\n\\fB-h\\fR, \\fB--help\\fR\n", "\\fB--tolerance\\fR \\fIM\\fR\noverlap",
        "Default: 1e-06.", "Not together with --key and --qpos.", "\n\\&.npy",
        ".SH EXIT STATUS\nExit codes: 0 "}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
