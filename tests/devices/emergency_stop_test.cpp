// The latch: the first source stays, a person's word outranks the program's, and no source clears the stop of another.
#include "devices/emergency_stop.h"

#include "tests/catch.h"

namespace jnd {
namespace {

TEST_CASE("The first source of a stop is kept until it is cleared") {
  EmergencyStop stop;
  CHECK_FALSE(stop.latched());
  stop.latch(StopSource::key);
  stop.latch(StopSource::button);
  stop.latch(StopSource::signal);
  CHECK(stop.source() == StopSource::key);
  stop.clear();
  CHECK_FALSE(stop.latched());
}

TEST_CASE("A person's stop outranks one that the program takes back by itself") {
  for (const StopSource own : {StopSource::signal, StopSource::program})
    for (const StopSource person : {StopSource::key, StopSource::button}) {
      EmergencyStop stop;
      stop.latch(own);
      stop.latch(person);
      CHECK_FALSE(stop.clear_if(own));
      CHECK(stop.source() == person);
    }
}

TEST_CASE("clear_if clears what it names, and only that") {
  EmergencyStop stop;
  CHECK_FALSE(stop.clear_if(StopSource::signal));
  stop.latch(StopSource::signal);
  CHECK_FALSE(stop.clear_if(StopSource::program));
  CHECK(stop.clear_if(StopSource::signal));
  CHECK_FALSE(stop.latched());
}

}  // namespace
}  // namespace jnd
