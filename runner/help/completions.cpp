#include "runner/help/completions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "runner/help/completed_value.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

constexpr const char* kOpening =
    "# What Tab offers for jnd in {0}. Written by: jnd completions {0}\n"
    "# The shipped names are those of that version.\n";

// In single quotes of fish, where a backslash goes before a quote.
std::string fish_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

// "jnd help plan" is about "jnd plan": the word help is passed over, and what follows names the commands.
bool is_passed_over(const CommandPage& page) {
  return page.name == "jnd help";
}

// 'jnd plan'|'jnd run'|...: what a word that was typed may lengthen the command to.
std::vector<std::string> typed_commands(const CommandPage& program) {
  std::vector<std::string> names;
  for (const CommandPage* page : all_pages(program))
    if (page != &program && !is_passed_over(*page)) names.push_back(shell_quoted(page->name));
  return names;
}

std::string option_words(const CommandPage& page) {
  std::string words;
  for (const OptionPage& option : page.options) words += (words.empty() ? "" : " ") + option.name;
  return words;
}

std::string command_words(const CommandPage& page) {
  std::string words;
  for (const CommandPage& command : page.commands) words += (words.empty() ? "" : " ") + own_name(command);
  return words;
}

std::string quoted(const std::vector<std::string>& words, std::string (*quote)(std::string_view)) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + quote(word);
  return text;
}

std::string bash_call(const CompletedValue& value) {
  return fmt::format("_jnd_offer {} {}", shell_quoted(value.files), quoted(value.words, shell_quoted));
}

// A case of the command and the word before: what the option takes.
std::string value_cases(const CommandPage& program, std::string (*call)(const CompletedValue&)) {
  std::string out;
  for (const CommandPage* page : all_pages(program))
    for (const OptionPage& option : page->options)
      if (!option.value.empty())
        out += fmt::format("        {}) {}; return ;;\n", shell_quoted(page->name + " " + option.name),
                           call(completed_value(option)));
  return out;
}

constexpr const char* kBash = R"(_jnd_offer() { # FILES WORDS...
    local word files=$1
    shift
    for word; do
        [[ $word == "$current"* ]] || continue
        # The shell quotes what it takes for names of files.
        [[ -n $files ]] || printf -v word %q "$word"
        COMPREPLY+=("$word")
    done
    [[ -n $files ]] || return
    compopt -o filenames 2>/dev/null
    while IFS= read -r word; do COMPREPLY+=("$word"); done < <(compgen -d -- "$current")
    [[ $files == / ]] && return
    while IFS= read -r word; do
        [[ -d $word ]] || COMPREPLY+=("$word")
    done < <(compgen -f -X "!$files" -- "$current")
}

_jnd() {
    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command=jnd i
    COMPREPLY=()
    # --option=value comes as three words.
    [[ $current == = ]] && current=
    [[ $previous == = ]] && previous=${COMP_WORDS[COMP_CWORD-2]}
    for ((i = 1; i < COMP_CWORD; i++)); do
        case "$command ${COMP_WORDS[i]}" in
)";

constexpr const char* kZshOffer = R"(_jnd_offer() { # FILES WORDS...
    (( $# > 1 )) && compadd -- "${@[2,-1]}"
    case $1 in
        '') ;;
        /) _files -/ ;;
        *) _files -g $1 ;;
    esac
}

_jnd() {
    local current=$words[CURRENT] previous=$words[CURRENT-1] command=jnd word
    for word in $words[2,CURRENT-1]; do
        case "$command $word" in
)";

std::string described(const std::string& name, const std::string& what) {
  std::string escaped;
  for (const char c : name) escaped += c == ':' ? std::string("\\:") : std::string(1, c);
  return shell_quoted(escaped + ":" + what);
}

std::string zsh_options(const CommandPage& page) {
  std::string list;
  for (const OptionPage& option : page.options) list += "\n                " + described(option.name, option.what);
  return list;
}

std::string zsh_commands(const CommandPage& page) {
  std::string list;
  for (const CommandPage& command : page.commands)
    list += "\n                " + described(own_name(command), command.what);
  return list;
}

std::string fish_value(const OptionPage& option) {
  if (option.value.empty()) return "";
  const CompletedValue value = completed_value(option);
  std::string offered = quoted(value.words, fish_quoted);  // fish splits and expands it once more
  if (value.files == "*") return fmt::format(" -r -F{}", offered.empty() ? "" : " -a " + fish_quoted(offered));
  if (value.files == "/") offered += " (__fish_complete_directories)";
  if (value.files.starts_with("*.")) offered += fmt::format(" (__fish_complete_suffix {})", value.files.substr(1));
  return offered.empty() ? " -x" : " -x -a " + fish_quoted(offered);
}

std::string fish_condition(const CommandPage& page) {
  return fmt::format("complete -c jnd -n \"__fish_jnd_at '{}'\"", page.name);
}

std::string fish_arguments(const CommandPage& page) {
  const CompletedValue value = completed_arguments(page);
  std::string out;
  if (!value.words.empty())
    out += fmt::format("{} -a {}\n", fish_condition(page), fish_quoted(quoted(value.words, fish_quoted)));
  if (value.files == "*") out += fish_condition(page) + " -F\n";
  if (value.files == "/") out += fish_condition(page) + " -a '(__fish_complete_directories)'\n";
  if (value.files.starts_with("*."))
    out += fmt::format("{} -a '(__fish_complete_suffix {})'\n", fish_condition(page), value.files.substr(1));
  return out;
}

}  // namespace

std::string bash_completions(const CommandPage& program) {
  std::string out = fmt::format(kOpening, "bash") + kBash;
  out += fmt::format("            {}) command=\"$command ${{COMP_WORDS[i]}}\" ;;\n        esac\n    done\n",
                     fmt::join(typed_commands(program), "|"));
  out += "    case \"$command $previous\" in\n" + value_cases(program, bash_call) + "    esac\n";
  out += "    case \"$command\" in\n";
  for (const CommandPage* page : all_pages(program)) {
    if (is_passed_over(*page)) continue;
    const std::string rest = page->commands.empty() ? bash_call(completed_arguments(*page))
                                                    : fmt::format("_jnd_offer '' {}", command_words(*page));
    out += fmt::format("        {})\n            if [[ $current == -* ]]; then _jnd_offer '' {}; else {}; fi ;;\n",
                       shell_quoted(page->name), option_words(*page), rest);
  }
  return out + "    esac\n}\n\ncomplete -F _jnd jnd\n";
}

std::string zsh_completions(const CommandPage& program) {
  std::string out = "#compdef jnd\n" + fmt::format(kOpening, "zsh") + kZshOffer;
  out += fmt::format("            {}) command=\"$command $word\" ;;\n        esac\n    done\n",
                     fmt::join(typed_commands(program), "|"));
  out += "    case \"$command $previous\" in\n" + value_cases(program, bash_call) + "    esac\n";
  out += "    local -a offered\n    case \"$command\" in\n";
  for (const CommandPage* page : all_pages(program)) {
    if (is_passed_over(*page)) continue;
    out += fmt::format(
        "        {})\n            if [[ $current == -* ]]; then\n                offered=({})\n"
        "                _describe option offered\n            else\n",
        shell_quoted(page->name), zsh_options(*page));
    if (page->commands.empty())
      out += fmt::format("                {}\n", bash_call(completed_arguments(*page)));
    else
      out +=
          fmt::format("                offered=({})\n                _describe command offered\n", zsh_commands(*page));
    out += "            fi ;;\n";
  }
  // Loaded by the completion system the file is the function's body, and is called; sourced it only defines it.
  return out + "    esac\n}\n\nif [[ $funcstack[1] == _jnd ]]; then _jnd \"$@\"; else compdef _jnd jnd; fi\n";
}

std::string fish_completions(const CommandPage& program) {
  std::string out = fmt::format(kOpening, "fish");
  out += fmt::format(
      "function __fish_jnd_at\n    set -l command jnd\n    for word in (commandline -opc)[2..-1]\n"
      "        if contains -- \"$command $word\" {}\n            set command \"$command $word\"\n        end\n"
      "    end\n    test \"$command\" = \"$argv[1]\"\nend\n\ncomplete -c jnd -f\n",
      fmt::join(typed_commands(program), " "));
  for (const CommandPage* page : all_pages(program)) {
    if (is_passed_over(*page)) continue;
    for (const CommandPage& command : page->commands)
      out += fmt::format("{} -a {} -d {}\n", fish_condition(*page), own_name(command), fish_quoted(command.what));
    for (const OptionPage& option : page->options)
      out += fmt::format("{} -l {} -d {}{}\n", fish_condition(*page), option.name.substr(2), fish_quoted(option.what),
                         fish_value(option));
    if (page->commands.empty()) out += fish_arguments(*page);
  }
  return out;
}

}  // namespace jnd
