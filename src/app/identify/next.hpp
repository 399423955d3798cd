#pragma once
#include "app/identify/identify.hpp"

namespace treacle::app {

// Arguments of `treacle next`, beyond those of `treacle identify`.
struct NextRequest : IdentifyRequest {
    double low = 1, high = 30; // [1/s] shear rates over which the flow curve is computed
};

// `treacle next` in a process without MPI: goes on with the study's identification, does a few coarse runs of each of
// its candidates, and prints how narrow the band of the flow curve would be with each of them: a table, the best first,
// and next.csv. Exit code 0, 3 without an answer to start from, 5 when stopped. Throws InputError without candidates,
// or a flow curve.
ExitCode propose_next(const NextRequest& request);

} // namespace treacle::app
