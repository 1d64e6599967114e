// The screen's own words in other languages: tables that cannot go wrong, and where they are found.
#include "runner/words/words.h"

#include <filesystem>
#include <fstream>

#include "protocols/input/input_error.h"
#include "protocols/input/resources.h"
#include "runner/words/word_table.h"
#include "tests/catch.h"
#include "tests/temporary_folder.h"

namespace jnd {
namespace {

// English again, whatever the test.
struct InEnglish {
  ~InEnglish() { use_language("en"); }
};

TEST_CASE("a translation has the places of the English words, in their order or numbered") {
  CHECK(misfit_of("goes on", "weiter").empty());
  CHECK(misfit_of("{} of {}", "{} von {}").empty());
  CHECK(misfit_of("{} of {}", "{1} hat {0}").empty());
  CHECK(misfit_of("{:.0f} % in {}", "{1}: {0:.0f} %").empty());
  CHECK_FALSE(misfit_of("{} of {}", "{}").empty());
  CHECK_FALSE(misfit_of("goes on", "weiter {}").empty());
  CHECK_FALSE(misfit_of("{:.0f} % in {}", "{} {:.0f} %").empty());
  CHECK_FALSE(misfit_of("{:.0f} %", "{:d} %").empty());
  CHECK_FALSE(misfit_of("{} of {}", "{0} {0}").empty());
  CHECK_FALSE(misfit_of("{} of {}", "{0} {2}").empty());
  CHECK_FALSE(misfit_of("{} of {}", "{} {1}").empty());
  CHECK_FALSE(misfit_of("{} of {}", "{-1} {0}").empty());
  for (const char* broken : {"{", "}", "{}{", "{{}}", "}{"}) CHECK_FALSE(misfit_of("{}", broken).empty());
}

TEST_CASE("every shipped table can be read, and its language is its name") {
  const std::vector<std::string> names = shipped_names(Resource::language);
  CHECK_FALSE(names.empty());
  for (const std::string& name : names) {
    INFO(name);
    CHECK(read_word_table(find_resource(Resource::language, name)).language == name);
  }
}

TEST_CASE("words are those of the language, of the one that it is a kind of, or English") {
  const InEnglish afterwards;
  for (const char* language : {"de", "DE", "de-AT", "de-Latn-CH"}) {
    INFO(language);
    CHECK(use_language(language));
    CHECK(tr("goes on") == "weiter");
    CHECK(tr("Trial {} of {}", 3, 16) == "Durchgang 3 von 16");
    CHECK(translated("words that no table has") == "words that no table has");
  }
  for (const char* language : {"en", "", "d", "deu", "xx-DE", "-"}) {
    INFO(language);
    CHECK_FALSE(use_language(language));
    CHECK(tr("goes on") == "goes on");
    CHECK(tr("Trial {} of {}", 3, 16) == "Trial 3 of 16");
  }
}

TEST_CASE("a table with mistakes is refused, and every mistake is named with its place") {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "xx.json";
  std::ofstream(file) << R"({"format": 1, "language": "xx", "name": "Made up",
    "words": {"goes on": "xx", "{} of {}": "{}", "back": 3}})";
  try {
    read_word_table(file);
    FAIL("it was read");
  } catch (const InputError& error) {
    const std::string said = error.what();
    CHECK(said.find("1 places for values, where the English words have 2") != std::string::npos);
    CHECK(error.diagnostics().size() == 2);
  }
}

}  // namespace
}  // namespace jnd
