// Something small for the mutation tool's own test.
#pragma once

namespace cairn::mutation {

// The length of what two intervals share, m; 0 where they do not meet.
double Shared(double a_low_m, double a_high_m, double b_low_m, double b_high_m);

// The same as a share of the first; no test looks at it, which the tool must say.
double ShareOfFirst(double a_low_m, double a_high_m, double b_low_m, double b_high_m);

}  // namespace cairn::mutation
