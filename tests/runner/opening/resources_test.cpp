// Which file a name means: a shipped one by its name, the user's own by a path.
#include "protocols/input/resources.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "protocols/rigs/rig_description.h"
#include "runner/opening/readiness_items.h"
#include "runner/opening/rig_limits.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

namespace fs = std::filesystem;

// The working folder for as long as it lives, with files of the given names in it.
class WorkingFolder {
 public:
  WorkingFolder() : before_(fs::current_path()) {
    std::string name = (fs::temp_directory_path() / "jnd-names-XXXXXX").string();
    path_ = mkdtemp(name.data());
    fs::current_path(path_);
  }
  ~WorkingFolder() {
    fs::current_path(before_);
    fs::remove_all(path_);
  }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;
  static void put(const char* name, const std::string& text) { std::ofstream(name) << text; }

 private:
  fs::path before_, path_;
};

std::string shipped_rrs3() {
  std::ifstream file(JND_SOURCE_DIR "/devices/specs/rrs3.json");
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string refusal(Resource resource, const std::string& name) {
  try {
    find_resource(resource, name);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a file in the working folder never takes the place of a shipped one") {
  const WorkingFolder folder;
  WorkingFolder::put("rrs3", "{}");
  WorkingFolder::put("rrs3.json", "{}");
  WorkingFolder::put("mine", "{}");
  for (const Resource resource : {Resource::protocol, Resource::profile, Resource::device_spec, Resource::object})
    for (const std::string& name : shipped_names(resource)) {
      WorkingFolder::put(name.c_str(), "{}");
      CHECK(find_resource(resource, name).is_absolute());
    }
  CHECK(find_resource(Resource::device_spec, "rrs3.json") == "rrs3.json");
  CHECK(find_resource(Resource::device_spec, "./rrs3") == "./rrs3");
  CHECK_THAT(refusal(Resource::device_spec, "mine"),
             Catch::Contains("no device called 'mine' is shipped") && Catch::Contains("write ./mine"));
  CHECK_THAT(refusal(Resource::protocol, "tutorial.json"),
             Catch::Contains("there is no protocol file 'tutorial.json'") && Catch::Contains("tutorial"));
}

TEST_CASE("a description that is not the shipped one to the byte is called so, wherever it lies") {
  const WorkingFolder folder;
  WorkingFolder::put("same.json", shipped_rrs3());
  const RigSpec same = load_rig_spec("same.json");
  CHECK(is_shipped(same));
  CHECK(check_description(same).verdict == Verdict::ok);
  CHECK(check_description(same).found == "rrs3 at most 4.7 N, 2000 N/m");
  CHECK(is_shipped(load_rig_spec(JND_SOURCE_DIR "/devices/specs/rrs3+mckibben.json")));

  std::string weaker = shipped_rrs3();
  weaker.replace(weaker.find("4.7"), 3, "3.0");
  WorkingFolder::put("other.json", weaker);
  const Check other = check_description(load_rig_spec("other.json"));
  CHECK(other.verdict == Verdict::warn);
  CHECK(other.found == "rrs3 at most 3 N, 2000 N/m; not the shipped rrs3");
  CHECK_FALSE(other.what_to_do.empty());
  weaker.replace(weaker.find("\"name\": \"rrs3\""), 14, "\"name\": \"mine\"");
  WorkingFolder::put("mine.json", weaker);
  CHECK(not_shipped_text(load_rig_spec("mine.json")) == "not a shipped device");
}
