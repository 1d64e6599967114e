#include "runner/help/manual.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "protocols/version.h"
#include "runner/help/help_text.h"

namespace jnd {

namespace {

// Text as roff takes it: minus signs that are to be copied, no quote or full stop that begins a request.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else
      out += c;
  }
  const bool request = out.starts_with(".");
  return request ? "\\&" + out : out;
}

std::string with_dashes(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string entry(const std::string& label, const std::string& text) {
  return fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(label), roff(text));
}

std::string entries(const char* title, const std::vector<OptionPage>& options) {
  if (options.empty()) return "";
  std::string out = fmt::format(".SH {}\n", title);
  for (const OptionPage& option : options)
    out += entry(label_of(option), (option.required && !option.is_argument ? "Required. " : "") + words_of(option));
  return out;
}

std::string commands(const CommandPage& page) {
  std::string out = ".SH COMMANDS\n";
  std::string heading;
  for (const CommandPage& command : page.commands) {
    if (command.heading != heading && command.heading != page.heading)
      out += fmt::format(".SS {}\n", roff(command.heading));
    heading = command.heading;
    out += entry(command.name, command.what);
  }
  return out;
}

std::string examples(const CommandPage& page) {
  if (page.examples.empty()) return "";
  std::string out = ".SH EXAMPLES\n.nf\n";
  for (const std::string& example : page.examples) out += roff(example) + "\n";
  return out + ".fi\n";
}

std::string lines_as_rows(const std::string& text) {
  std::string out = ".nf\n";
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    out += roff(text.substr(begin, end - begin)) + "\n";
    begin = end + 1;
  }
  return out + ".fi\n";
}

std::string notes(const CommandPage& page) {
  return page.notes.empty() ? "" : ".SH NOTES\n" + lines_as_rows(page.notes);
}

}  // namespace

std::string manual_file(const CommandPage& page) {
  return with_dashes(page.name) + ".1";
}

std::string manual_page(const CommandPage& page, const CommandPage& program) {
  std::string title = with_dashes(page.name);
  std::string out;
  std::string capitals = title;
  std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  out += fmt::format(".TH \"{}\" 1 \"\" \"jnd {}\" \"jnd\"\n.ad l\n.nh\n", roff(capitals), kVersion);
  out += fmt::format(".SH NAME\n{} \\- {}\n", roff(title), roff(page.what));
  out += fmt::format(".SH SYNOPSIS\n{}\n", roff(usage_of(page)));
  if (!page.commands.empty()) out += commands(page);
  out += entries("ARGUMENTS", page.arguments) + entries("OPTIONS", page.options) + notes(page) + examples(page);
  out += ".SH EXIT STATUS\n" + lines_as_rows(exit_codes_text());
  out += ".SH ENVIRONMENT\n";
  for (const EnvironmentVariable& one : environment_variables()) out += entry(one.name, one.what);
  const bool is_program = page.name == program.name;
  if (!is_program) out += fmt::format(".SH SEE ALSO\n.BR {} (1)\n", roff(with_dashes(program.name)));
  return out;
}

}  // namespace jnd
