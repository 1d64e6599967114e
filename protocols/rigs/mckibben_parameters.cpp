#include "protocols/rigs/mckibben_parameters.h"

#include "protocols/input/json_reader.h"

namespace jnd {

MckibbenParameters read_mckibben_parameters(const JsonNode& node, std::vector<Diagnostic>& diagnostics,
                                            const std::string& file) {
  constexpr NumberLimits kLength{.min = 0, .max = 0.5, .above = true, .unit = "m"};
  constexpr NumberLimits kOffset{.min = -0.5, .max = 0.5, .unit = "m"};
  MckibbenParameters p;
  JsonReader reader(node, diagnostics, file);
  p.l1_m = reader.number("l1_m", kLength);
  p.l2_m = reader.number("l2_m", kLength);
  p.d2_m = reader.number("d2_m", kLength);
  p.g2_m = reader.number("g2_m", kOffset);
  p.h2_m = reader.number("h2_m", kOffset);
  p.l4_m = reader.number("l4_m", kLength);
  p.l5max_m = reader.number("l5max_m", kLength);
  p.h0_m = reader.number("h0_m", kLength);
  p.hx_m = reader.number("hx_m", kOffset);
  p.hx1_m = reader.number("hx1_m", kOffset);
  p.mc_kg = reader.number("mc_kg", {.min = 0, .max = 2, .unit = "kg"});

  p.km_n_per_m = reader.number("km_n_per_m", {.min = 0, .max = 1e5, .unit = "N/m"});
  p.fm0_n = reader.number("fm0_n", {.min = 0, .max = 1000, .unit = "N"});
  p.catt1_m = reader.number("catt1_m", {.min = 0, .max = 0.5, .unit = "m"});

  p.l0_m = reader.number("l0_m", kLength);
  p.li_m = reader.number("li_m", kLength);
  p.ri_m = reader.number("ri_m", {.min = 0, .max = 0.1, .above = true, .unit = "m"});
  p.si_m = reader.number("si_m", {.min = 0, .max = 0.1, .above = true, .unit = "m"});
  p.nt = reader.number("nt", {.min = 0, .max = 100, .above = true, .unit = "turns"});
  p.h_fibre_m = reader.number("h_fibre_m", kLength);
  p.e_pa = reader.number("e_pa", {.min = 0, .max = 1e9, .above = true, .unit = "Pa"});

  p.kv_pa_per_v = reader.number("kv_pa_per_v", {.min = 0, .max = 1e6, .above = true, .unit = "Pa/V"});
  p.zeta = reader.number("zeta", {.min = 0, .max = 10, .above = true});
  p.sigma_n_rad_per_s = reader.number("sigma_n_rad_per_s", {.min = 0, .max = 1000, .above = true, .unit = "rad/s"});
  p.valve_min_v = reader.number("valve_min_v", {.min = 0, .max = 100, .unit = "V"});
  p.valve_max_v = reader.number("valve_max_v", {.min = 0, .max = 100, .above = true, .unit = "V"});
  p.c_m3_per_s_pa = reader.number("c_m3_per_s_pa", {.min = 0, .max = 1e-6, .above = true, .unit = "m3/(s Pa)"});
  p.b = reader.number("b", {.min = 0, .max = 0.9});

  p.rho0_kg_per_m3 = reader.number("rho0_kg_per_m3", {.min = 0, .max = 10, .above = true, .unit = "kg/m3"});
  p.r_j_per_kg_k = reader.number("r_j_per_kg_k", {.min = 0, .max = 5000, .above = true, .unit = "J/(kg K)"});
  p.temperature_k = reader.number("temperature_k", {.min = 200, .max = 400, .unit = "K"});
  p.p_atm_pa = reader.number("p_atm_pa", {.min = 3e4, .max = 1.2e5, .unit = "Pa"});
  p.g_m_per_s2 = reader.number("g_m_per_s2", {.min = 0, .max = 20, .unit = "m/s2"});
  if (p.valve_max_v <= p.valve_min_v && is_sound(diagnostics, node.path))
    reader.error("valve_max_v", "is not above valve_min_v", "swap them");
  if (p.h_fibre_m <= p.l0_m - p.catt1_m && is_sound(diagnostics, node.path))
    reader.error("h_fibre_m", "is not above l0_m - catt1_m, the muscle's greatest length", "check the lengths");
  reader.finish();
  return p;
}

}  // namespace jnd
