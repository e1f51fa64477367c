// What the formulas of the renderer take for granted of the machine's arithmetic, in every thread.
#pragma once

namespace abbe::doctor {

// Products whose rounding error std::fma does not give exactly.
double inexactFusedProducts();
// Sums in single and double precision that are not rounded to nearest, ties to even; asked in every worker.
double wrongRoundings();
// Products that are left denormal in a worker of parallelFor (docs/hard_cases.md, case 59).
double denormalsLeft();

} // namespace abbe::doctor
