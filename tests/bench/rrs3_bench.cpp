// What one control step of the 3RRS device costs (configuration, velocities, torques), against the same equations
// written out by hand as straight-line scalars.
//
//   rrs3_bench     prints ns of both and their ratio, medians of interleaved rounds; the aim is at most 1.3
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "devices/rrs3/rrs3_statics.h"

namespace {

using namespace jnd;

struct Inputs {
  Rrs3Coordinates xi;
  Wrench wrench;
};

// Reference: no library, no early way out but the ones that any control step needs. Returns the joint torques.
struct Leg {
  double cos_azimuth, sin_azimuth, x, y;  // platform joint in its own frame
};

bool straight_line(const Rrs3Geometry& g, const std::array<Leg, 3>& legs, const Rrs3Coordinates& xi, const double* w,
                   double* tau) {
  const double sr = std::sin(xi.roll_rad), cr = std::cos(xi.roll_rad);
  const double sp = std::sin(xi.pitch_rad), cp = std::cos(xi.pitch_rad);
  const double square = g.bd_m * g.bd_m / 4;
  const double rise = square * sp * sr, run = g.bh_m * (g.b_m + g.bh_m) * cp + square * cr;
  if (!(run > 0) || !(cr > 0) || !(cp > 0)) return false;
  const double length = std::sqrt(rise * rise + run * run);
  const double sy = rise / length, cy = run / length;
  const double r00 = cy * cp, r01 = cy * sp * sr - sy * cr, r10 = sy * cp, r11 = sy * sp * sr + cy * cr;
  const double r20 = -sp, r21 = cp * sr;
  const double px = g.bh_m * (r00 - r11), py = -g.b_m * r10;

  double arm[3][3], along[3], rise_z[3], lever[3], dep[3][3], ind[3][2];
  for (int i = 0; i < 3; ++i) {
    const Leg& leg = legs[static_cast<std::size_t>(i)];
    arm[i][0] = r00 * leg.x + r01 * leg.y;
    arm[i][1] = r10 * leg.x + r11 * leg.y;
    arm[i][2] = r20 * leg.x + r21 * leg.y;
    const double x = px + arm[i][0], y = py + arm[i][1], z = xi.pz_m + arm[i][2];
    const double radial = x * leg.cos_azimuth + y * leg.sin_azimuth - g.a_m;
    const double squared = radial * radial + z * z;
    const double a = (g.l1_m * g.l1_m + squared - g.l2_m * g.l2_m) / 2;
    const double across_squared = g.l1_m * g.l1_m * squared - a * a;
    if (!(across_squared >= 0) || !(squared > 0)) return false;
    const double across = std::sqrt(across_squared);
    const double link_r = (a * radial - across * z) / squared, link_z = (a * z + across * radial) / squared;
    along[i] = radial - link_r;
    rise_z[i] = z - link_z;
    lever[i] = z * link_r - radial * link_z;
    const double ux = leg.sin_azimuth, uy = -leg.cos_azimuth;
    dep[i][0] = ux;
    dep[i][1] = uy;
    dep[i][2] = arm[i][0] * uy - arm[i][1] * ux;
    ind[i][0] = -arm[i][2] * uy;
    ind[i][1] = arm[i][2] * ux;
  }
  // Adjoint of dep.
  double adj[3][3];
  for (int r = 0; r < 3; ++r) {
    const int c1 = (r + 1) % 3, c2 = (r + 2) % 3;
    adj[r][0] = dep[1][c1] * dep[2][c2] - dep[2][c1] * dep[1][c2];
    adj[r][1] = dep[2][c1] * dep[0][c2] - dep[0][c1] * dep[2][c2];
    adj[r][2] = dep[0][c1] * dep[1][c2] - dep[1][c1] * dep[0][c2];
  }
  const double det = dep[0][0] * adj[0][0] + dep[1][0] * adj[0][1] + dep[2][0] * adj[0][2];
  if (!(std::abs(det) > 1e-9 * g.b_m)) return false;
  const double scale = -1 / det;
  double h[3][2];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 2; ++c)
      h[r][c] = scale * (adj[r][0] * ind[0][c] + adj[r][1] * ind[1][c] + adj[r][2] * ind[2][c]);

  double j[3][3];
  for (int i = 0; i < 3; ++i) {
    const Leg& leg = legs[static_cast<std::size_t>(i)];
    if (!(std::abs(lever[i]) > 1e-9 * g.l1_m * g.l2_m)) return false;
    const double dx = along[i] * leg.cos_azimuth, dy = along[i] * leg.sin_azimuth, dz = rise_z[i];
    const double tx = arm[i][1] * dz - arm[i][2] * dy, ty = arm[i][2] * dx - arm[i][0] * dz;
    const double tz = arm[i][0] * dy - arm[i][1] * dx;
    const double inverse = 1 / lever[i];
    j[i][0] = dz * inverse;
    j[i][1] = (dx * h[0][0] + dy * h[1][0] + tx + tz * h[2][0]) * inverse;
    j[i][2] = (dx * h[0][1] + dy * h[1][1] + ty + tz * h[2][1]) * inverse;
  }
  const double load0 = w[2];
  const double load1 = h[0][0] * w[0] + h[1][0] * w[1] + w[3] + h[2][0] * w[5];
  const double load2 = h[0][1] * w[0] + h[1][1] * w[1] + w[4] + h[2][1] * w[5];
  const double bc0 = j[1][1] * j[2][2] - j[1][2] * j[2][1], bc1 = j[1][2] * j[2][0] - j[1][0] * j[2][2],
               bc2 = j[1][0] * j[2][1] - j[1][1] * j[2][0];
  const double ca0 = j[2][1] * j[0][2] - j[2][2] * j[0][1], ca1 = j[2][2] * j[0][0] - j[2][0] * j[0][2],
               ca2 = j[2][0] * j[0][1] - j[2][1] * j[0][0];
  const double ab0 = j[0][1] * j[1][2] - j[0][2] * j[1][1], ab1 = j[0][2] * j[1][0] - j[0][0] * j[1][2],
               ab2 = j[0][0] * j[1][1] - j[0][1] * j[1][0];
  const double jdet = j[0][0] * bc0 + j[0][1] * bc1 + j[0][2] * bc2;
  if (!(std::abs(jdet) * g.b_m > 1e-9)) return false;
  tau[0] = (load0 * bc0 + load1 * bc1 + load2 * bc2) / jdet;
  tau[1] = (load0 * ca0 + load1 * ca1 + load2 * ca2) / jdet;
  tau[2] = (load0 * ab0 + load1 * ab1 + load2 * ab2) / jdet;
  return true;
}

constexpr int kPoses = 1024, kRepeats = 2, kRounds = 801;

template <typename Step>
double ns_per_step(const std::vector<Inputs>& inputs, Step step, double& sink) {
  const auto start = std::chrono::steady_clock::now();
  for (int repeat = 0; repeat < kRepeats; ++repeat)
    for (const Inputs& input : inputs) sink += step(input);
  const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - start;
  return taken.count() / (kRepeats * static_cast<double>(inputs.size()));
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace

int main() {
  // The default geometry (devices/specs/rrs3.json).
  const Rrs3Geometry geometry{.a_m = 0.006,
                              .b_m = 0.01,
                              .bh_m = 0.005,
                              .bd_m = 0.017320508075688773,
                              .l1_m = 0.012,
                              .l2_m = 0.02,
                              .rest_z_m = -0.02};
  const Rrs3Kinematics kinematics(geometry);
  const double half = geometry.bd_m / 2, radius = std::hypot(half, geometry.bh_m);
  const double c = -geometry.bh_m / radius, s = half / radius;
  const std::array<Leg, 3> legs{Leg{1, 0, geometry.b_m, 0}, Leg{c, -s, -geometry.bh_m, -half},
                                Leg{c, s, -geometry.bh_m, half}};

  std::vector<Inputs> inputs(kPoses);
  for (int i = 0; i < kPoses; ++i) {
    Inputs& input = inputs[static_cast<std::size_t>(i)];
    input.xi = {.pz_m = -0.02 + 0.003 * std::sin(0.1 * i),
                .roll_rad = 0.4 * std::sin(0.07 * i),
                .pitch_rad = 0.3 * std::cos(0.05 * i)};
    input.wrench << 0.3 * std::sin(0.2 * i), 0.2, 2 + std::cos(0.03 * i), 0.001, -0.002, 0.0005;
  }
  const auto product = [&](const Inputs& input) {
    const auto at = kinematics.configuration(input.xi);
    if (!at) return 0.0;
    const auto rates = kinematics.differential(*at);
    if (!rates) return 0.0;
    return joint_torques(*rates, input.wrench).sum();
  };
  const auto reference = [&](const Inputs& input) {
    double tau[3] = {0, 0, 0};
    return straight_line(geometry, legs, input.xi, input.wrench.data(), tau) ? tau[0] + tau[1] + tau[2] : 0.0;
  };

  double apart = 0;
  for (const Inputs& input : inputs) apart = std::max(apart, std::abs(product(input) - reference(input)));
  std::vector<double> ours, theirs, ratios;
  double sink = 0;
  for (int round = 0; round < kRounds; ++round) {
    ours.push_back(ns_per_step(inputs, product, sink));
    theirs.push_back(ns_per_step(inputs, reference, sink));
    ratios.push_back(ours.back() / theirs.back());
  }
  fmt::print("3RRS control step      {:7.1f} ns\n", median(ours));
  fmt::print("straight-line scalars  {:7.1f} ns\n", median(theirs));
  fmt::print("ratio                  {:7.2f}    (aim: at most 1.3)\n", median(ratios));
  fmt::print("largest difference of the torques' sum {:.1e} N m; checksum {:.6f}\n", apart, sink);
  return apart < 1e-12 ? 0 : 1;
}
