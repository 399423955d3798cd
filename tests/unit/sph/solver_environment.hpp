#pragma once
#include "solve/rows/runtime.hpp"

#include <gtest/gtest.h>
#include <memory>

namespace treacle::sph {

// The solvers for as long as a test program runs; one of its files adds it.
class SolverEnvironment : public testing::Environment {
    void SetUp() override { runtime_ = std::make_unique<solve::SolveRuntime>(); }
    void TearDown() override { runtime_.reset(); }
    std::unique_ptr<solve::SolveRuntime> runtime_;
};

} // namespace treacle::sph
