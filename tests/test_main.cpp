#include "kokkos/runtime.hpp"
#include "mpi/comm.hpp"

#include <gtest/gtest.h>

// Main of every test that needs MPI or Kokkos: rank 0 prints, any rank's failure fails the run.
int main(int argc, char** argv) {
    treacle::MpiRuntime mpi(argc, argv);
    treacle::KokkosRuntime kokkos(argc, argv);
    testing::InitGoogleTest(&argc, argv);
    const auto world = treacle::Comm::world();
    if (!world.is_root()) {
        auto& listeners = testing::UnitTest::GetInstance()->listeners();
        delete listeners.Release(listeners.default_result_printer());
        delete listeners.Release(listeners.default_xml_generator());
    }
    const int failed = RUN_ALL_TESTS();
    return static_cast<int>(world.max(static_cast<std::int64_t>(failed)));
}
