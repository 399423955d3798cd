#pragma once

namespace treacle {

// From here on the process ends where a floating-point operation makes a number that is not finite: an invalid
// operation, a division by zero, an overflow. Standard error then has its kind and the calls that led there; the
// process ends by SIGFPE, and with it all ranks. Throws std::runtime_error where the C library has no such traps.
// Exact only in programs compiled without -fno-trapping-math (preset `trap`): elsewhere a vectorised loop may divide by
// what it does not select.
void trap_non_finite();

} // namespace treacle
