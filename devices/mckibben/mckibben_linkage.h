// Kinematics and statics of the McKibben finger's four-bar linkage: where everything is at a rocker angle alpha1, and
// what the tendon's force and the linkage's weight do at the fingertip.
//
// Frame: the finger's sagittal plane, u forward, w down, origin at the rocker's pivot; the finger's joint (MCP) O lies
// at (0, h0), the tendon guide X at (0, -hx). The coupler has the axes e = (cos theta2, sin theta2) and n = (-sin
// theta2, cos theta2). The finger pushes the coupler at P with F along +n; the device pushes the finger with F along
// -n, against flexion.
//
// The paper's misprint, and what stands here instead (checked by virtual work in tests/devices):
//   (7)   the bracket after sin(alpha1) is (l2 cos theta2 - h2 sin theta2); the printed + is wrong at full flexion by
//         27 % in dF/dFx, 28 % in a force of 42 N with the weight.
//
// Thread rule: const after construction. Nothing here allocates or throws but the constructor: an angle that the
// linkage cannot take is an empty optional.
#pragma once

#include <array>
#include <optional>

#include "protocols/rigs/mckibben_parameters.h"

namespace jnd {

struct LinkagePose {
  double theta1_rad = 0, theta2_rad = 0, beta_rad = 0;  // (1)..(3): finger link, coupler, tendon
  double l5_m = 0;                                      // (4): tendon between guide and coupler
  double stroke_m = 0;                                  // (4): CAtt of muscle and spring
  std::array<double, 2> p_m{};                          // fingertip P: u, w
  double kx = 0;                                        // dF/dFx, of (5)..(7)
  double kw = 0;                                        // dF/d(mc g), of (5)..(7)
  // Speed of the coupler at P along n per speed of the rocker, m/rad: F times it is the torque about the rocker's
  // pivot.
  double tip_lever_m = 0;
};

struct AngleRange {
  double min_rad = 0, max_rad = 0;
};

class MckibbenLinkage {
 public:
  // Throws InputError where the lengths do not make a linkage that goes from straight to flexed.
  explicit MckibbenLinkage(const MckibbenParameters& parameters);

  // Empty where the linkage does not assemble at alpha1, where its force is undetermined, or where alpha1 is not a
  // number.
  std::optional<LinkagePose> pose(double alpha1_rad) const noexcept;

  // Where the linkage assembles at all; 7.884 to 172.116 deg with Table 1.
  const AngleRange& assembles() const noexcept { return assembles_; }
  // What a finger uses: from straight (theta2 = 0) to flexed (l5 = l5max); 20.121 to 53.106 deg with Table 1.
  const AngleRange& usable() const noexcept { return usable_; }

 private:
  MckibbenParameters parameters_;
  AngleRange assembles_, usable_;
};

}  // namespace jnd
