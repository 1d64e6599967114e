// The 3RRS model's questions and answers as JSON, for one pose and for many.
#pragma once

#include "devices/rrs3/rrs3_model.h"
#include "runner/terminal/json_output.h"

namespace jnd {

// {yaw, p, b, d, q, j_chi, j_xi, h, tau, kq, cond, det_ux}, legs by rows.
nlohmann::ordered_json rrs3_answer_json(const Rrs3ModelAnswer& answer);

// Throws InputError where a stiffness is negative or a wrench so large that it is a slip of units.
void check_rrs3_query(const Rrs3ModelQuery& query);

}  // namespace jnd
