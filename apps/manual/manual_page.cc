#include "apps/manual/manual_page.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <vector>

namespace mjcf_pdg::app {
namespace {

// `text` as man(7) prints it: a backslash, a hyphen that stays one, no request at the head of a
// line.
std::string Roff(const std::string& text) {
  std::string roff;
  for (const char c : text) {
    const bool heads_line = roff.empty() || roff.back() == '\n';
    if (heads_line && (c == '.' || c == '\'')) roff += "\\&";
    if (c == '\\') {
      roff += "\\e";
    } else if (c == '-') {
      roff += "\\-";
    } else {
      roff += c;
    }
  }
  return roff;
}

std::string Bold(const std::string& text) { return "\\fB" + Roff(text) + "\\fR"; }
std::string Italic(const std::string& text) { return "\\fI" + Roff(text) + "\\fR"; }

std::string Sentence(std::string text) {
  if (!text.empty() && text.back() != '.' && text.back() != '?') text += '.';
  return text;
}

// "--key, --qpos and --qpos-file", in an order that does not depend on where the options lie in
// memory.
std::string Names(const std::set<CLI::Option*>& options) {
  std::set<std::string> names;
  for (const CLI::Option* option : options) names.insert(option->get_name());
  std::string text;
  std::size_t left = names.size();
  for (const std::string& name : names) {
    --left;
    text += name + (left > 1 ? ", " : left == 1 ? " and " : "");
  }
  return text;
}

// What the option is called, and its argument.
std::string Head(const CLI::Option& option) {
  std::string head;
  for (const std::string& name : option.get_snames()) head += Bold("-" + name) + ", ";
  for (const std::string& name : option.get_lnames()) head += Bold("--" + name) + ", ";
  if (option.nonpositional()) {
    head.resize(head.size() - 2);
  } else {
    head = Bold(option.get_name(true));
  }
  if (option.get_expected_min() > 0) head += " " + Italic(option.get_type_name());
  return head;
}

std::string Entry(const CLI::Option& option) {
  std::string words = Sentence(option.get_description());
  if (option.get_required()) words += " Required.";
  if (!option.get_default_str().empty()) words += " Default: " + option.get_default_str() + ".";
  if (!option.get_needs().empty()) words += " Needs " + Names(option.get_needs()) + ".";
  if (!option.get_excludes().empty()) {
    words += " Not together with " + Names(option.get_excludes()) + ".";
  }
  return ".TP\n" + Head(option) + "\n" + Roff(words) + "\n";
}

std::string Entries(const CLI::App& command, bool positional) {
  std::string text;
  for (const CLI::Option* option : command.get_options()) {
    if (option->nonpositional() != positional) text += Entry(*option);
  }
  return text;
}

std::string Synopsis(const Program& program, const CLI::App& command) {
  const bool verb = &command != program.app.get();
  std::string text = Bold(program.app->get_name());
  if (!verb) return text + " " + Italic("COMMAND") + " [" + Italic("OPTIONS") + "] ...";
  text += " " + Bold(command.get_name()) + " [" + Italic("OPTIONS") + "]";
  for (const CLI::Option* option : command.get_options()) {
    if (option->nonpositional()) continue;
    const bool several = option->get_items_expected_max() > 1;
    const std::string name = Italic(option->get_name(true)) + (several ? " ..." : "");
    text += option->get_required() ? " " + name : " [" + name + "]";
  }
  return text;
}

std::string Commands(const Program& program) {
  std::string text;
  for (const Verb& verb : program.verbs) {
    text += ".TP\n" + Bold(verb.command->get_name()) + "\n" +
            Roff(Sentence(verb.command->get_description())) + "\n";
  }
  return text;
}

std::string SeeAlso(const Program& program, const CLI::App& command) {
  std::vector<const CLI::App*> others = {program.app.get()};
  for (const Verb& verb : program.verbs) others.push_back(verb.command);
  others.erase(std::find(others.begin(), others.end(), &command));
  std::string text;
  for (const CLI::App* other : others) {
    text += ".BR " + Roff(ManualName(program, *other)) +
            (other == others.back() ? " (1)\n" : " (1),\n");
  }
  return text;
}

}  // namespace

std::string ManualName(const Program& program, const CLI::App& command) {
  const std::string name = program.app->get_name();
  return &command == program.app.get() ? name : name + "-" + command.get_name();
}

std::string ManualPage(const Program& program, const CLI::App& command) {
  const std::string name = ManualName(program, command);
  std::string title = name;
  for (char& c : title) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string summary = command.get_description();
  if (!summary.empty() && summary.back() == '.') summary.pop_back();
  std::string page = ".TH " + Roff(title) + " 1 \"\" \"mjcf\\-pdg " MJCF_PDG_VERSION "\"\n";
  page += ".SH NAME\n" + Roff(name) + " \\- " + Roff(summary) + "\n";
  page += ".SH SYNOPSIS\n" + Synopsis(program, command) + "\n";
  const bool verb = &command != program.app.get();
  if (!verb) page += ".SH COMMANDS\n" + Commands(program);
  page += ".SH OPTIONS\n" + Entries(command, true) + Entries(command, false);
  page += ".SH EXIT STATUS\n" + Roff(program.app->get_footer()) + "\n";
  return page + ".SH SEE ALSO\n" + SeeAlso(program, command);
}

}  // namespace mjcf_pdg::app
