#include "runner/help/version_text.h"

#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <SQLiteCpp/SQLiteCpp.h>
#include <boost/version.hpp>
#include <fmt/format.h>
#include <hidapi.h>
#include <nlohmann/json.hpp>
#include <sodium.h>
#include <sqlite3.h>
#include <zstd.h>

#include "protocols/version.h"

namespace jnd {

namespace {

std::string compiler() {
#if defined(__clang__)
  return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

// 10.2.1 from its parts in one number: major * 10000 + minor * 100 + patch, for example.
std::string dotted(long number, long major, long minor) {
  return fmt::format("{}.{}.{}", number / major, number / minor % (major / minor), number % minor);
}

std::string built_with() {
  const std::string type = JND_BUILD_TYPE, sanitizers = JND_SANITIZERS;
  return fmt::format("built with {}, {}{}", compiler(), type.empty() ? "no build type" : type,
                     sanitizers.empty() ? "" : ", sanitizers " + sanitizers);
}

// Libraries that the loader brings: what runs now may be newer than what was there when this was compiled.
std::string linked_libraries() {
  return fmt::format("linked: SQLite {}, hidapi {}, zstd {}, libsodium {}", sqlite3_libversion(), hid_version_str(),
                     ZSTD_versionString(), sodium_version_string());
}

std::string compiled_libraries() {
  return fmt::format(
      "compiled: Boost {}, nlohmann_json {}.{}.{}, Eigen {}.{}.{}, fmt {}, CLI11 {}, SQLiteCpp {}, "
      "simdjson {}, md4c {}, ncurses {}",
      dotted(BOOST_VERSION, 100'000, 100), NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
      NLOHMANN_JSON_VERSION_PATCH, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION,
      dotted(FMT_VERSION, 10'000, 100), CLI11_VERSION, dotted(SQLITECPP_VERSION_NUMBER, 1'000'000, 1'000),
      JND_SIMDJSON_VERSION, JND_MD4C_VERSION, JND_NCURSES_VERSION);
}

}  // namespace

std::string version_text() {
  return fmt::format("jnd {}\n  {}\n  {}\n  {}\n", kVersion, built_with(), linked_libraries(), compiled_libraries());
}

}  // namespace jnd
