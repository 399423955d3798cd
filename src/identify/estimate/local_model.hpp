#pragma once
#include "identify/estimate/residual_rows.hpp"

namespace treacle::identify {

// Value, gradient and square term of each row at the centre [p].
struct LocalModel {
    Vector value;
    Matrix gradient; // [rows][p]
    Vector square;   // second derivative along the first parameter; 0 where the runs do not give it
    std::size_t runs = 0;
};

// Through runs near the centre by weighted least squares (I2), quadratic where there is one parameter. Throws InputError where there are too few.
LocalModel local_model(const std::vector<EvaluatedRun>& runs, const Layout& layout, const Vector& centre);

// (I5a) Takes the model to the resolution of other runs: what these show beyond it is a value and a slope, by least squares in which the slope is
// expected to be none, over distances at which the numerical noise of runs exceeds it.
void correct(LocalModel& model, const std::vector<EvaluatedRun>& runs, const Layout& layout, const Vector& centre);

} // namespace treacle::identify
