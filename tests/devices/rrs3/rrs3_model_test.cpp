// The whole answer of the 3RRS model against an independent numpy model, and geometries from JSON.
#include "devices/rrs3/rrs3_model.h"

#include <fstream>

#include <nlohmann/json.hpp>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;
using nlohmann::json;

namespace {

void check_near(const Eigen::MatrixXd& ours, const json& theirs) {
  Eigen::MatrixXd m(ours.rows(), ours.cols());
  REQUIRE(theirs.size() == static_cast<std::size_t>(ours.rows()));
  for (Eigen::Index r = 0; r < ours.rows(); ++r)
    for (Eigen::Index c = 0; c < ours.cols(); ++c) {
      const json& row = theirs[static_cast<std::size_t>(r)];
      m(r, c) = row.is_array() ? row[static_cast<std::size_t>(c)].get<double>() : row.get<double>();
    }
  CHECK((ours - m).cwiseAbs().maxCoeff() <= 1e-9 * m.cwiseAbs().maxCoeff() + 1e-15);
}

Rrs3Geometry geometry_from(const std::string& text) {
  return rrs3_geometry_from_json(parse_json(text, "g.json"), "g.json");
}

std::string complaint(const std::string& text) {
  try {
    (void)geometry_from(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("every field of the model's answer agrees with the independent model to 1e-9") {
  std::ifstream file(source_path("tests/devices/rrs3_reference.json"));
  const json vectors = json::parse(file).at("vectors");
  REQUIRE(vectors.size() == 8);
  for (const json& entry : vectors) {
    INFO("vector " << entry.at("id"));
    const json& xi = entry.at("xi");
    const json& out = entry.at("out");
    Rrs3ModelQuery query{.geometry = geometry_from(entry.at("geometry").dump()),
                         .coordinates = {.pz_m = xi.at("pz"), .roll_rad = xi.at("roll"), .pitch_rad = xi.at("pitch")},
                         .translational_n_per_m = entry.at("kS"),
                         .rotational_n_m_per_rad = entry.at("Kphi")};
    for (int i = 0; i < 6; ++i) query.wrench[i] = entry.at("w")[static_cast<std::size_t>(i)];
    const auto answer = ask_rrs3_model(query);
    REQUIRE(answer);
    CHECK(answer->yaw == Approx(out.at("yaw").get<double>()).epsilon(1e-9).margin(1e-15));
    check_near(answer->p, out.at("p"));
    check_near(answer->b, out.at("B"));
    check_near(answer->d, out.at("D"));
    check_near(answer->q, out.at("q"));
    check_near(answer->j_chi, out.at("J_chi"));
    check_near(answer->j_xi, out.at("J_xi"));
    check_near(answer->h, out.at("H"));
    check_near(answer->tau, out.at("tau"));
    check_near(answer->kq, out.at("Kq"));
    CHECK(answer->cond == Approx(out.at("cond_scaled_b").get<double>()).epsilon(1e-9));
    CHECK(answer->det_ux == Approx(out.at("detUx").get<double>()).epsilon(1e-9));
    CHECK(answer->singularities.serial > 0);
    CHECK(answer->singularities.pz.serial.up > 0);
  }
}

TEST_CASE("the model has no answer out of reach") {
  const Rrs3Geometry geometry = geometry_of(rrs3_spec());
  CHECK_FALSE(ask_rrs3_model({.geometry = geometry, .coordinates = {.pz_m = -0.034}}));
  CHECK_FALSE(ask_rrs3_model({.geometry = geometry, .coordinates = {.pz_m = -0.02, .roll_rad = 2}}));
  CHECK(ask_rrs3_model({.geometry = geometry, .coordinates = {.pz_m = -0.02}}));
  CHECK_THROWS_AS(ask_rrs3_model({.geometry = {}, .coordinates = {.pz_m = -0.02}}), InputError);
}

TEST_CASE("a geometry is read in its short and long forms and from a device specification") {
  const Rrs3Geometry expected = geometry_of(rrs3_spec());
  const auto same = [&](const Rrs3Geometry& g) {
    return g.a_m == expected.a_m && g.b_m == expected.b_m && g.bh_m == expected.bh_m && g.bd_m == expected.bd_m &&
           g.l1_m == expected.l1_m && g.l2_m == expected.l2_m;
  };
  const std::string lengths = R"("a":0.006,"b":0.01,"bh":0.005,"bd":0.017320508075688773,"l1":0.012,"l2":0.02)";
  const Rrs3Geometry brief = geometry_from("{" + lengths + R"(,"pz0":-0.02})");
  CHECK(same(brief));
  CHECK(brief.rest_z_m == -0.02);
  CHECK(same(geometry_from("{" + lengths + "}")));
  const Rrs3Geometry shipped = load_rrs3_geometry(source_path("devices/specs/rrs3.json"));
  CHECK(same(shipped));
  CHECK(shipped.rest_z_m == expected.rest_z_m);
  std::ifstream file(source_path("devices/specs/rrs3.json"));
  CHECK(same(geometry_from(json::parse(file).at("geometry").dump())));
}

TEST_CASE("mistakes in a geometry are named with their path") {
  CHECK(complaint(R"({"a":6,"b":0.01,"bh":0.005,"bd":0.0173,"l1":0.012,"l2":0.02})").find("$.a") != std::string::npos);
  CHECK(complaint(R"({"a":0.006,"b":0.01,"bh":0.005,"bd":0.0173,"l1":0.012})").find("l2") != std::string::npos);
  const std::string two = complaint(R"({"a":-1,"b":0.01,"bh":0.005,"bd":0.0173,"l1":0.012,"l2":"x","l3":1})");
  CHECK(two.find("$.a") != std::string::npos);
  CHECK(two.find("$.l2") != std::string::npos);
  CHECK(two.find("l3") != std::string::npos);
  CHECK(complaint(R"({"format":1,"geometry":{"a_m":0.006}})").find("$.geometry") != std::string::npos);
  CHECK(complaint(R"({"geometry":5})").find("$.geometry") != std::string::npos);
  CHECK_FALSE(complaint("[]").empty());
  CHECK_THROWS_AS(load_rrs3_geometry("no/such/file.json"), InputError);
}
