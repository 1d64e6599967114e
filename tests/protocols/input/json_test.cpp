// Files, their JSON, numbers and codes as they come in.
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <rapidcheck.h>
#include <sys/stat.h>
#include <unistd.h>

#include "protocols/input/file_trouble.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_document.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/json_syntax.h"
#include "protocols/input/json_text.h"
#include "protocols/input/look_alikes.h"
#include "protocols/input/number_from.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"
#include "protocols/input/utf8.h"
#include "tests/catch.h"
#include "tests/protocols/rigs.h"

using namespace jnd::test;

namespace jnd {
namespace {

// JSON places and the reader's checks.

TEST_CASE("every value and key knows its place") {
  const JsonNode root =
      parse_json("{\n  \"a\": [1, -2.5e3 ,\ttrue],\n  \"ü\" : {\"b c\": null, \"b c\": \"x\\\"y\"}}", "f");
  CHECK(root.path == "$");
  CHECK(root.line == 1);
  CHECK(root.column == 1);
  const JsonNode& list = *root.find("a");
  CHECK(std::pair(list.line, list.column) == std::pair(2, 8));
  REQUIRE(list.items.size() == 3);
  CHECK(list.items[0].integer);
  CHECK(list.items[0].path == "$.a[0]");
  CHECK(list.items[1].number == -2500);
  CHECK(list.items[1].text == "-2.5e3");
  CHECK(list.items[1].integer);  // -2500, as JSON Schema has it
  CHECK(std::pair(list.items[1].line, list.items[1].column) == std::pair(2, 12));
  CHECK(std::pair(list.items[2].line, list.items[2].column) == std::pair(2, 21));
  CHECK(root.key_places[1] == std::pair(3, 3));
  const JsonNode& inner = *root.find("ü");
  CHECK(std::pair(inner.line, inner.column) == std::pair(3, 9));  // characters, not bytes
  REQUIRE(inner.keys.size() == 2);                                // the duplicate is kept
  CHECK(inner.items[0].kind == JsonNode::Kind::null);
  CHECK(inner.items[1].text == "x\"y");
  CHECK(inner.items[1].path == "$[\"ü\"][\"b c\"]");
  CHECK(inner.find("b c") == &inner.items[0]);
  CHECK(root.find("zzz") == nullptr);
}

TEST_CASE("a whole number may be written with a fraction of 0 or an exponent") {
  std::vector<Diagnostic> diagnostics;
  const JsonNode root = parse_json(R"({"a": 16.0, "b": 1e3, "c": 16.5, "d": 1e300})", "f");
  JsonReader reader(root, diagnostics, "f");
  CHECK(reader.integer("a") == 16);
  CHECK(reader.integer("b") == 1000);
  CHECK(diagnostics.empty());
  CHECK(reader.integer("c") == 0);
  CHECK(reader.integer("d") == 0);
  CHECK(diagnostics.size() == 2);
}

TEST_CASE("a number with more behind it is named whole, also where the text ends with it") {
  for (const std::string end : {"", "}", ", \"b\": 1}"}) {
    CAPTURE(end);
    CHECK_THROWS_WITH(parse_json("{\"a\": 00e" + end, "f"),
                      Catch::Contains("f:1:7: \"00e\" is not a number that JSON knows"));
    CHECK_THROWS_WITH(parse_json("{\"a\": 1.e" + end, "f"), Catch::Contains("\"1.e\" is not a number that JSON knows"));
  }
}

TEST_CASE("a text of ours is read to a depth that the stack has room for") {
  const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  CHECK(json_from(nested(kMostJsonDepth)).is_array());
  CHECK(json_from(R"({"[[\"": ")" + nested(500'000) + R"(\\"})").is_object());  // brackets in a string
  CHECK_THROWS_AS(json_from(nested(kMostJsonDepth + 1)), nlohmann::json::parse_error);
  CHECK(json_if_valid(nested(500'000)).is_discarded());
}

TEST_CASE("the commonest slips are named, with what to write") {
  const auto message = [](const std::string& text) -> std::string {
    try {
      parse_json(text, "f");
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  CHECK(message("{\"a\": 900,5, \"b\": 1}") ==
        "f:1:7: 900,5 is written with a comma (numbers have a decimal point: 900.5)");
  CHECK(message("{\"a\": 900, 5}") == "f:1:12: a key in double quotes should stand here (keys stand in double quotes)");
  CHECK(message("{\"a\": 0900, \"b\": 1}") == "f:1:7: 0900 begins with a zero (write 900)");
  CHECK(message("{\"a\": [1, -007.5]}") == "f:1:11: -007.5 begins with a zero (write -7.5)");
  CHECK(message("{\"a\": 00}") == "f:1:7: 00 begins with a zero (write 0)");
  CHECK(message("{“a”: 1}") == "f:1:2: a curly quote stands here (write straight quotes: \")");
  CHECK(message("{\"a\":\u00a01}") == "f:1:6: a no-break space stands here (write an ordinary blank)");
  // The object that is not closed, and not the one around it.
  CHECK(message("{\n  \"a\": {\n    \"b\": 1\n  ,\n  \"c\": [\n    2\n  ]\n}\n") ==
        "f:2:8: the '{' that opens here is not closed, to judge by the indentation (add the missing '}')");
  CHECK(message("{\"a\": {\"b\": 1}") == "f:1:1: the '{' that opens here is never closed (add the missing '}')");
}

TEST_CASE("depth 64 and a mebibyte are read; more is refused") {
  CHECK_NOTHROW(parse_json(std::string(64, '[') + std::string(64, ']'), "f"));
  CHECK_THROWS_AS(parse_json(std::string(65, '[') + std::string(65, ']'), "f"), InputError);
  const std::string large = "\"" + std::string((1U << 20U) - 2, 'x') + "\"";
  CHECK(parse_json(large, "f").text.size() == large.size() - 2);
  CHECK_THROWS_WITH(parse_json(large + " ", "f"), Catch::Contains("at most 1 MiB"));
}

TEST_CASE("any JSON document is read as nlohmann's own parser reads it") {
  // Random texts of JSON characters: most are wrong, and both must agree which.
  REQUIRE(rc::check("agreement", [] {
    static const std::vector<std::string> kPieces = {"{",        "}",  "[",    "]",   ",",    ":",    "\"a\"",
                                                     "\"b\\n\"", "1",  "-0.5", "1e3", "true", "null", " ",
                                                     "\n",       "\"", "01",   "x",   "é",    "\\"};
    std::string text;
    for (const std::size_t piece : *rc::gen::container<std::vector<std::size_t>>(rc::gen::inRange<std::size_t>(0, 20)))
      text += kPieces[piece];
    const bool good = nlohmann::json::accept(text);
    bool read = true;
    try {
      (void)parse_json(text, "f");
    } catch (const InputError& error) {
      read = false;
      RC_ASSERT(error.diagnostics().size() == 1U);
      RC_ASSERT(error.diagnostics()[0].line >= 1);
      RC_ASSERT(error.diagnostics()[0].column >= 1);
      RC_ASSERT(!error.diagnostics()[0].message.empty());
    }
    RC_ASSERT(read == good);
  }));
}

TEST_CASE("a document with any one character lost, doubled or replaced is judged as nlohmann's parser does") {
  const std::string good = R"({"a": [1, -2.5e3, true, null], "b": {"c": "x\"\u00e9"}, "d": 0.5, "e": []})";
  REQUIRE_NOTHROW(parse_json(good, "f"));
  const auto judge = [](const std::string& text) {
    CAPTURE(text);
    bool read = true;
    try {
      (void)parse_json(text, "f");
    } catch (const InputError& error) {
      read = false;
      CHECK(error.diagnostics().at(0).line == 1);
      CHECK(error.diagnostics().at(0).column <= static_cast<int>(text.size()) + 1);
    }
    CHECK(read == nlohmann::json::accept(text));
  };
  for (std::size_t i = 0; i < good.size(); ++i) {
    judge(good.substr(0, i));
    judge(good.substr(0, i) + good.substr(i + 1));
    judge(good.substr(0, i) + good[i] + good.substr(i));
    for (const char other : std::string("\"\\{}[],: 0-.eEtn\t\n"))
      judge(std::string(good).replace(i, 1, 1, other == '\n' ? ' ' : other));
  }
}

TEST_CASE("the reader collects mistakes and goes on") {
  const std::string text =
      R"({"sigma": "3", "count": 2.5, "mode": "slwo", "extra": 1, "low": 5, "low": 6, "list": [1]})";
  const JsonNode root = parse_json(text, "f.json");
  std::vector<Diagnostic> diagnostics;
  JsonReader reader(root, diagnostics, "f.json");
  CHECK(reader.number("sigma", {.min = 0, .unit = "N/m"}) == 0);
  CHECK(reader.integer_or("count", 7) == 7);
  CHECK(reader.one_of_or<int>("mode", {{"slow", 1}, {"fast", 2}}, 2) == 2);
  CHECK(reader.number("low", {.min = 0, .max = 9}) == 5);
  CHECK(reader.number_or("absent", 1.5) == 1.5);
  CHECK_FALSE(reader.optional_text("absent_too"));
  CHECK(reader.array("list", 2, 3) == nullptr);
  CHECK(reader.object("nothing") == nullptr);
  reader.finish();
  std::vector<std::string> messages;
  for (const Diagnostic& diagnostic : diagnostics) messages.push_back(to_text(diagnostic));
  REQUIRE(messages.size() == 7);
  CHECK(messages[0] == "f.json:1:11: $.sigma: must be a number in N/m, not the text \"3\" (write it without quotes)");
  CHECK(messages[1] == "f.json:1:25: $.count: must be a whole number, not 2.5 (write it without a fraction)");
  CHECK(messages[2] ==
        "f.json:1:38: $.mode: \"slwo\" is not known (did you mean \"slow\"? known: \"slow\" or \"fast\")");
  CHECK(messages[3] == "f.json:1:86: $.list: has 1 element (must have 2 to 3)");
  CHECK(messages[4] == "f.json:1:1: $.nothing: \"nothing\" is missing (add an object {...})");
  CHECK(messages[5].find("$.extra: the key \"extra\" is not known (known here: \"sigma\"") != std::string::npos);
  CHECK(messages[6] == "f.json:1:68: $.low: the key \"low\" is given twice (it stands on line 1 already)");
}

TEST_CASE("ranges: ends belong to them, unless `above`") {
  const JsonNode root = parse_json(R"({"a": 0, "b": 1})", "f");
  std::vector<Diagnostic> diagnostics;
  JsonReader reader(root, diagnostics, "f");
  CHECK(reader.number("b", {.min = 0, .max = 1}) == 1);
  CHECK(reader.optional_number("a", {.min = 0, .max = 1}) == 0.0);
  CHECK(diagnostics.empty());
  CHECK_FALSE(reader.optional_number("a", {.min = 0, .max = 1, .above = true, .unit = "m"}));
  REQUIRE(diagnostics.size() == 1);
  CHECK(diagnostics[0].suggestion == "must be above 0 and at most 1 m");
}

TEST_CASE("a number of another unit is recognised") {
  const auto message = [](const std::string& number, const NumberLimits& limits) {
    std::vector<Diagnostic> diagnostics;
    CHECK_FALSE(number_of(parse_json(number, "f"), limits, diagnostics, "f"));
    return diagnostics.front().suggestion;
  };
  CHECK(message("4", {.min = 0.0005, .max = 0.03, .unit = "m"}) == "must be from 0.0005 to 0.03 m; 4 mm are 0.004 m");
  CHECK(message("3000", {.min = 0.5, .max = 60, .unit = "s"}) == "must be from 0.5 to 60 s; 3000 ms are 3 s");
  CHECK(message("75", {.min = 0, .max = 1}) == "must be from 0 to 1; 75 % are 0.75");
  CHECK(message("750", {.min = 0, .max = 1}) == "must be from 0 to 1");
  CHECK(message("-4", {.min = 0, .max = 0.03, .unit = "m"}) == "must be from 0 to 0.03 m");
}

TEST_CASE("nearest words") {
  const std::vector<std::string_view> words = {"explore_s", "gap_s", "keys", "conditions", "condition"};
  CHECK(nearest_word("explor_s", words) == "explore_s");
  CHECK(nearest_word("gap", words) == "gap_s");
  CHECK(nearest_word("kyes", words) == "keys");
  CHECK(nearest_word("Conditions", words) == "conditions");
  CHECK(nearest_word("colour", words).empty());
  CHECK(nearest_word("", words).empty());
}

TEST_CASE("soundness knows what contains what") {
  const std::vector<Diagnostic> diagnostics = {{"f", 1, 1, "$.a.b", "wrong", ""},
                                               {"f", 1, 1, "$.list[1]", "wrong", ""}};
  CHECK_FALSE(is_sound(diagnostics, "$.a.b"));
  CHECK_FALSE(is_sound(diagnostics, "$.a"));
  CHECK_FALSE(is_sound(diagnostics, "$.a.b.c"));
  CHECK(is_sound(diagnostics, "$.a.bb"));
  CHECK(is_sound(diagnostics, "$.ab"));
  CHECK_FALSE(is_sound(diagnostics, "$.list"));
  CHECK(is_sound(diagnostics, "$.list[10]"));
}

TEST_CASE("messages never pass control characters on") {
  CHECK(in_quotes("a\x1b[31m\n") == "\"a\\u001b[31m\\u000a\"");
  CHECK(in_quotes("\xc2\x9b") == "\"\\u009b\"");
  CHECK(in_quotes(std::string(100, 'x')) == "\"" + std::string(60, 'x') + "...\"");
  CHECK(plain(0.005) == "0.005");
  CHECK(plain(900) == "900");
  CHECK(plain(1e300) == "1e+300");
}

TEST_CASE("UTF-8") {
  CHECK(first_invalid_utf8("a\xc3\xbc\xe2\x82\xac\xf0\x9f\x98\x80") == std::string_view::npos);
  CHECK(first_invalid_utf8("ab\x80") == 2);
  CHECK(first_invalid_utf8("\xf5\x80\x80\x80") == 0);
  CHECK(first_invalid_utf8("\xf4\x90\x80\x80") == 0);
  CHECK(count_characters("a\xc3\xbc\xe2\x82\xac") == 3);
}

TEST_CASE("SHA-256 gives the published answers") {
  // FIPS 180-4 examples.
  CHECK(sha256_hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

// Files that a user names: whatever they are, reading them ends, and within bounds.

TEST_CASE("what is no file is refused with what it is, and nobody is waited for") {
  const TemporaryFolder folder;
  const std::filesystem::path pipe = folder.write("beside", "").parent_path() / "pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  CHECK_THROWS_WITH(read_input_file(pipe), Catch::Contains("named pipe") && Catch::Contains("into a file"));
  CHECK_THROWS_WITH(read_input_file("/dev/zero"), Catch::Contains("is a device, not a file"));
  CHECK_THROWS_WITH(read_input_file(pipe.parent_path()), Catch::Contains("is a folder (name a file in it)"));
  CHECK_THROWS_WITH(read_input_file(folder.write("file", "") / "below"), Catch::Contains("cannot be opened"));
}

TEST_CASE("a file may be as long as the limit and no longer") {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("file", std::string(100'000, 'x'));
  CHECK(read_input_file(file).size() == 100'000);
  CHECK(read_input_file(file, 100'000).size() == 100'000);
  CHECK_THROWS_WITH(read_input_file(file, 99'999), Catch::Contains("is larger than 99999 bytes"));
  CHECK_THROWS_WITH(read_input_file(folder.write("large", std::string(kMostInputBytes + 1, 'x'))),
                    Catch::Contains("is larger than 1 MiB"));
}

TEST_CASE("a shell's <(command) is read to its end") {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  REQUIRE(write(ends[1], "abc", 3) == 3);
  close(ends[1]);
  CHECK(read_input_file(fmt::format("/dev/fd/{}", ends[0])) == "abc");
  close(ends[0]);
}

// A text is a number only as a whole.

TEST_CASE("a text is a number as a whole, without blanks, signs of plus or leftovers") {
  CHECK(number_from<double>("-2.5e1") == -25.0);
  CHECK(number_from<int>("-7") == -7);
  CHECK(number_from<std::uint32_t>("4294967295") == 4294967295U);
  CHECK(std::isinf(number_from<double>("inf").value()));
  for (const char* const text : {"", " 1", "1 ", "+1", "1x", "x", "0x1", "1,5"}) {
    CAPTURE(text);
    CHECK_FALSE(number_from<double>(text));
    CHECK_FALSE(number_from<int>(text));
  }
  CHECK_FALSE(number_from<int>("1.5"));
}

TEST_CASE("a number beyond its type's range is none") {
  CHECK_FALSE(number_from<std::uint32_t>("4294967296"));
  CHECK_FALSE(number_from<std::uint32_t>("-1"));
  CHECK_FALSE(number_from<double>("1e999"));
}

// Which codes are taken for one another.

TEST_CASE("codes look alike whatever their capitals, zeros before a number, and way of writing an accent") {
  for (const auto& [one, other] : {std::pair("P1", "P001"),
                                   {"P01", "p1"},
                                   {"01", "1"},
                                   {"A0B00", "a00b0"},
                                   {"Jos\u00e9", "Jose\u0301"},
                                   {"\u00c5SA", "a\u030asa"}})
    CHECK(look_of(one) == look_of(other));
  for (const auto& [one, other] :
       {std::pair("P1", "P10"), {"P100", "P10"}, {"1", "P1"}, {"0", ""}, {"P10", "P1O"}, {"\u00df", "s"}})
    CHECK(look_of(one) != look_of(other));
}

TEST_CASE("codes that look alike are named, those that print alike with their lengths") {
  CHECK(look_alikes({"P1", "P2", "Q1"}).empty());
  CHECK(look_alikes({"P1", "P2", "P02", "p1"}) == R"("P2" and "P02", "P1" and "p1")");
  CHECK(look_alikes({"Jos\u00e9", "Jose\u0301"}) == "\"Jos\u00e9\" and \"Jose\u0301\" (4 and 5 characters)");
}

// The words for files that cannot be read or written tell the causes apart, and name what is in the way.

namespace fs = std::filesystem;
constexpr uid_t kNobody = 65534;

// Permissions do not bind root.
class AsNobody {
 public:
  AsNobody() { change(kNobody); }
  ~AsNobody() { change(0); }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;

 private:
  void change(uid_t user) const {
    if (root_ && ::seteuid(user) != 0) throw std::runtime_error("the user cannot be changed");
  }
  const bool root_ = ::getuid() == 0;
};

int error_of_opening(const fs::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC, 0600);
  if (descriptor < 0) return errno;
  ::close(descriptor);
  return 0;
}

class Folder {
 public:
  fs::path operator/(const char* name) const { return path() / name; }
  fs::path path() const { return kept_.write("file", "x").parent_path(); }

 private:
  test::TemporaryFolder kept_;
};

fs::path file_in(const fs::path& folder, const char* name) {
  std::ofstream(folder / name) << "x";
  return folder / name;
}

std::string said(const fs::path& path, int error, FileUse use = FileUse::write) {
  return file_trouble(path, error, use).text();
}

TEST_CASE("every cause has words of its own, and no other cause is called a full disk") {
  const Folder folder;
  std::set<std::string> all;
  const int causes[] = {EACCES, EROFS, ENOSPC, EDQUOT, EFBIG, ENOENT, ENOTDIR, EISDIR, EIO, ENAMETOOLONG};
  for (const int cause : causes) {
    const FileTrouble trouble = file_trouble(folder / "file", cause, FileUse::write);
    CAPTURE(cause, trouble.why, trouble.what_to_do);
    CHECK_FALSE(trouble.what_to_do.empty());
    CHECK((trouble.why.find("full") != std::string::npos) == (cause == ENOSPC));
    all.insert(trouble.why);
  }
  CHECK(all.size() == std::size(causes));
}

TEST_CASE("without permission the words name the folder that may not be entered or written to, or the file") {
  const Folder folder;
  fs::permissions(folder.path(), fs::perms(0755));
  const fs::path closed = folder / "closed", fixed = folder / "fixed", open = folder / "open";
  for (const fs::path& one : {closed, fixed, open}) fs::create_directory(one);
  const fs::path inside = file_in(closed, "study"), beside = file_in(fixed, "study"), secret = file_in(open, "secret");
  fs::permissions(open, fs::perms(0777));
  fs::permissions(secret, fs::perms(0));
  fs::permissions(fixed, fs::perms(0555));
  fs::permissions(closed, fs::perms(0));
  {
    const AsNobody nobody;
    const int entering = error_of_opening(inside, O_RDONLY);
    REQUIRE(entering == EACCES);
    CHECK(said(inside, entering, FileUse::read).starts_with("no permission to enter the folder " + closed.string()));
    CHECK(said(inside, entering).starts_with("no permission to enter the folder " + closed.string()));
    const int making = error_of_opening(fixed / "new", O_WRONLY | O_CREAT);
    REQUIRE(making == EACCES);
    CHECK(said(fixed / "new", making).starts_with("no permission to write to the folder " + fixed.string()));
    const int reading = error_of_opening(secret, O_RDONLY);
    REQUIRE(reading == EACCES);
    CHECK(said(secret, reading, FileUse::read).starts_with("no permission to read the file " + secret.string()));
    CHECK(said(secret, error_of_opening(secret, O_WRONLY))
              .starts_with("no permission to write to the file " + secret.string()));
    CHECK(write_obstacle(secret) == EACCES);
    CHECK(write_obstacle(beside) == EACCES);
    CHECK(write_obstacle(inside) == EACCES);
  }
  fs::permissions(closed, fs::perms(0700));
  fs::permissions(secret, fs::perms(0600));
  CHECK(write_obstacle(secret) == 0);
}

TEST_CASE("the part of a path that is not there, or is a file, is named") {
  const Folder folder;
  const fs::path file = file_in(folder.path(), "file");
  CHECK(error_of_opening(folder / "no" / "such" / "place", O_RDONLY) == ENOENT);
  CHECK(said(folder / "no" / "such" / "place", ENOENT)
            .starts_with("there is no such folder: " + (folder / "no").string() + ";"));
  CHECK(said(folder / "none", ENOENT, FileUse::read).starts_with("there is no such file"));
  CHECK(error_of_opening(file / "below", O_RDONLY) == ENOTDIR);
  CHECK(said(file / "below" / "it", ENOTDIR).starts_with(file.string() + " is a file, not a folder"));
  CHECK(error_of_opening(folder.path(), O_WRONLY) == EISDIR);
  CHECK(write_obstacle(folder.path()) == EISDIR);
  CHECK(write_obstacle(folder / "none") == ENOENT);
}

}  // namespace
}  // namespace jnd
