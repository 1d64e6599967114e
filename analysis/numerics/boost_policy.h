// How Boost.Math is called: it never throws and never sets errno (edges are handled before the call), and nothing is
// promoted to long double, so that machines with and without it get the same bits.
#pragma once

#include <boost/math/policies/policy.hpp>

namespace jnd {

using QuietPolicy =
    boost::math::policies::policy<boost::math::policies::promote_double<false>,
                                  boost::math::policies::domain_error<boost::math::policies::ignore_error>,
                                  boost::math::policies::overflow_error<boost::math::policies::ignore_error>,
                                  boost::math::policies::underflow_error<boost::math::policies::ignore_error>,
                                  boost::math::policies::evaluation_error<boost::math::policies::ignore_error>>;

}  // namespace jnd
